"""Checks that integrators render the known radiance of a reference scene."""

import numpy as np

from brdfkit.checks.plugin_subject import PluginSubject
from brdfkit.checks.registry import check_of

SPP = 64


@check_of("integrators")
def reference(subject: PluginSubject) -> tuple[bool, str]:
    """Check that the mean of a picture is the radiance that the plugin's file gives.

    The function `reference` of the file returns (scene, radiance), from a closed form or another
    integrator.
    """
    import mitsuba as mi

    if not hasattr(subject.module, "reference"):
        return True, "nothing to check: the file has no function `reference`"

    # The picture, as (pixels, channels)
    scene, expected = subject.module.reference()
    scene["integrator"] = {**scene["integrator"], **subject.entries}
    loaded = mi.load_dict(scene, parallel=False)
    film = loaded.integrator().render(loaded, seed=0, spp=SPP)
    pixels = np.array(film, float)
    pixels = pixels.reshape(-1, pixels.shape[-1])

    # The expected radiance in the channels of the film, which may have an alpha channel
    expected = np.asarray(expected, float)
    if pixels.shape[1] == 1:
        expected = np.atleast_1d(np.array(mi.luminance(mi.Color3f(*expected.tolist()))).ravel())
    pixels = pixels[:, : len(expected)]

    error = np.hypot(pixels.std(axis=0) / np.sqrt(len(pixels)), 2e-3 * np.abs(expected))
    deviation = float(np.max(np.abs(pixels.mean(axis=0) - expected) / error))
    return deviation < 4.5, f"picture and reference {deviation:.1f} standard errors apart"
