"""Checks of integrators: they render the known radiance of a reference scene."""

import numpy as np

from brdfkit.checks.registry import check_of

SPP = 64


@check_of("integrators")
def reference(subject):
    """The mean of a picture = the radiance that the function `reference` of the file gives.

    `reference` returns (scene, radiance), by a closed form or by another integrator.
    """
    import mitsuba as mi

    if not hasattr(subject.module, "reference"):
        return True, "nothing to check: the file has no function `reference`"

    # the picture, as (pixels, channels)
    scene, expected = subject.module.reference()
    scene["integrator"] = {**scene["integrator"], **subject.entries}
    loaded = mi.load_dict(scene, parallel=False)
    film = loaded.integrator().render(loaded, seed=0, spp=SPP)
    found = np.array(film, float)
    found = found.reshape(-1, found.shape[-1])

    # the expected radiance in the channels of the film, which may have an alpha
    expected = np.asarray(expected, float)
    if found.shape[1] == 1:
        expected = np.atleast_1d(np.array(mi.luminance(mi.Color3f(*expected.tolist()))).ravel())
    found = found[:, : len(expected)]

    error = np.hypot(found.std(axis=0) / np.sqrt(len(found)), 2e-3 * np.abs(expected))
    apart = float(np.max(np.abs(found.mean(axis=0) - expected) / error))
    return apart < 4.5, f"picture and reference {apart:.1f} standard errors apart"
