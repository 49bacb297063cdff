"""Measures how far the maps' radiances are from the photographs, and describes likely causes."""

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.core.names import join_words
from brdfkit.inverse.photographs.capture.observations import Observations

# A texel is unexplained by the maps if its residual is more than this multiple of the noise
UNEXPLAINED = 3
UNEXPLAINED_SHARE = 0.03  # Share of unexplained texels above which the result's notes mention them
LARGEST_NOISE = 0.04  # largest noise that cameras usually have, relative to the radiance
# RMS residual, relative to the radiance, above which some texels probably lie beside the sample
LARGEST_RESIDUAL = 0.5
# A photograph is named in the notes if its residual is more than this multiple of the median
OUTLIER = 2.5
PALEST, DARKEST = 1.05, 0.004  # usual limits of a sample's median diffuse reflectance


def compute_misfit(errors: FloatArray, noise: float, observed: Observations) -> FloatArray:
    """Return the RMS residual (n,) of each texel in units of the photographs' noise.

    `errors` (n,) are sums of weighted squared residuals, and `noise` is the variance of relative
    radiances.
    """
    counted = (observed.weights > 0).sum(axis=(0, 2))
    return np.sqrt(errors / np.maximum(counted * noise, 1e-300))


def describe_misfit(
    misfit: FloatArray, noise: float, differences: dict[str, float], diffuse: float
) -> tuple[str, ...]:
    """Return sentences for the user on residuals of the maps that are larger than noise.

    `misfit` (texels,) is from `compute_misfit`. `noise` is the relative standard deviation of a
    value, or 0 if there are too few lights to estimate it. `differences` maps the name of each
    photograph to the RMS relative difference of its rendering, and `diffuse` is the median diffuse
    reflectance.
    """
    sentences = []
    values = list(differences.values())
    total = np.sqrt(np.mean(np.square(values)))
    if noise > LARGEST_NOISE or (noise and total > LARGEST_RESIDUAL):
        sentences.append(
            f"The residuals, {100 * noise:.2g} % in the median texel and {100 * total:.3g} % in "
            "all, are more than noise: check the camera, the sample's size, the places of the "
            "lights, and which way is up; or the model or the resolution does not suit."
        )
    limit = max(OUTLIER * np.median(values), LARGEST_NOISE)
    outliers = [name for name, value in differences.items() if value > limit]
    if outliers:
        sentences.append(
            f"Worst explained: {join_words(outliers)}; check the place and the intensity of the "
            "light there."
        )
    share = (misfit > UNEXPLAINED).mean()
    if share > UNEXPLAINED_SHARE and noise:
        sentences.append(
            f"{100 * share:.0f} % of the texels have residuals above {UNEXPLAINED} times the "
            "noise, see the map misfit: edges sharper than texels, shadows, or a model that does "
            "not suit."
        )
    if not DARKEST < diffuse < PALEST:
        sentences.append(
            f"The diffuse reflectance is {diffuse:.2g} in the median: check the unit of the "
            "intensities."
        )
    return tuple(sentences)
