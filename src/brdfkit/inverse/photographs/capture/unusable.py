"""Leaves out photographs of a flat sample that show no usable value of it."""

import numpy as np

from brdfkit.core.errors import BrdfkitError
from brdfkit.core.names import join_words
from brdfkit.inverse.photographs.capture.capture import Capture
from brdfkit.inverse.photographs.capture.observations import Observations

REASONS = "black, clipped, lost, within a pixel of the edge, or under a grazing light"


def leave_out_unusable(
    capture: Capture, shape: tuple[int, int]
) -> tuple[Capture, Observations, tuple[str, ...]]:
    """Return a capture without its unusable photographs, and notes on those that are left out.

    In between is what the other photographs show of the texels of maps of `shape`. Raises
    `BrdfkitError` if no photograph is usable.
    """
    observed = Observations.collect(capture, shape)
    usable = observed.find_usable_photographs()
    if usable.all():
        return capture, observed, ()
    if not usable.any():
        raise BrdfkitError(
            f"{join_words(list(capture.names))}: no picture has a usable value of the sample, as "
            f"all is {REASONS}; check the exposure, and where the camera and the lights are."
        )
    chosen = np.flatnonzero(usable)
    names = [name for name, is_usable in zip(capture.names, usable, strict=True) if not is_usable]
    rest = capture.select_lights(chosen)
    note = f"Left out: {join_words(names)}, where all of the sample is {REASONS}."
    return rest, Observations.collect(rest, shape), (note,)
