"""Checks that an integrator renders its reference scene with the known radiance."""

import numpy as np

from brdfkit.checks.plugin_subject import PluginSubject
from brdfkit.checks.registry import check_of

SPP = 64


@check_of("integrators")
def check_reference(subject: PluginSubject) -> tuple[bool, str]:
    """Check that the picture of the reference scene has the known radiance in the mean.

    The function `reference` in the plugin's file returns the scene and its radiance, which a closed
    form or another integrator gives.
    """
    import mitsuba as mi

    if not hasattr(subject.module, "reference"):
        return True, "nothing to check: the file has no function `reference`"

    # Render the scene to an array (pixels, channels)
    scene, expected = subject.module.reference()
    scene["integrator"] = {**scene["integrator"], **subject.entries}
    loaded = mi.load_dict(scene, parallel=False)
    film = loaded.integrator().render(loaded, seed=0, spp=SPP)
    pixels = np.array(film, float)
    pixels = pixels.reshape(-1, pixels.shape[-1])

    # Convert the expected radiance to the film's channels, of which an alpha channel is left out
    expected = np.asarray(expected, float)
    if pixels.shape[1] == 1:
        expected = np.atleast_1d(np.array(mi.luminance(mi.Color3f(*expected.tolist()))).ravel())
    pixels = pixels[:, : len(expected)]

    error = np.hypot(pixels.std(axis=0) / np.sqrt(len(pixels)), 2e-3 * np.abs(expected))
    deviation = float(np.max(np.abs(pixels.mean(axis=0) - expected) / error))
    return deviation < 4.5, f"picture and reference {deviation:.1f} standard errors apart"
