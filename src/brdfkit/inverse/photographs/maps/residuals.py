"""What maps leave of the photographs, texel by texel, and what one should check then."""

import numpy as np

from brdfkit.core.names import join_words

MISFIT = 3  # times the noise, from which a texel is not explained
SHARE = 0.03  # of the texels, from which it is said
NOISY = 0.04  # a relative noise that cameras hardly have
MOST = 0.5  # of the photographs, left by all texels: some are beside the sample
OUTLIER = 2.5  # times what is left of the photographs in the median
PALE, DARK = 1.05, 0.004  # reflectances that hardly any sample has in the median


def misfits(errors, noise, seen):
    """What texels leave, (n,), in units of the noise, from their errors (n,)."""
    counted = (seen.weights > 0).sum(axis=(0, 2))
    return np.sqrt(errors / np.maximum(counted * noise, 1e-300))


def describe_misfit(misfit, noise, left, diffuse):
    """Sentences on what the maps do not explain.

    misfit : of each texel, in units of the noise; noise : relative, of a value, 0 where there are
    too few lights to tell; left : name of each photograph → RMS relative difference; diffuse : the
    median diffuse reflectance.
    """
    said = []
    total = np.sqrt(np.mean(np.square(list(left.values()))))
    if noise > NOISY or (noise and total > MOST):
        said.append(
            f"What is left of the photographs, {100 * noise:.2g} % in the usual texel and "
            f"{100 * total:.3g} % in all, is more than noise: check the camera, the sample's size, "
            "the places of the lights, and which way is up; or the model or the resolution does "
            "not suit."
        )
    usual = np.median(list(left.values()))
    odd = [name for name, value in left.items() if value > max(OUTLIER * usual, NOISY)]
    if odd:
        said.append(
            f"Worst explained: {join_words(odd)}; check the place and the intensity of "
            "the light there."
        )
    share = (misfit > MISFIT).mean()
    if share > SHARE and noise:
        said.append(
            f"{100 * share:.0f} % of the texels leave more than {MISFIT} times the noise, see the "
            "map misfit: edges sharper than texels, shadows, or a model that does not suit."
        )
    if not DARK < diffuse < PALE:
        said.append(
            f"The diffuse reflectance is {diffuse:.2g} in the median: check the unit of the "
            "intensities."
        )
    return tuple(said)
