"""`render_orbit`: a film of a camera that goes once around a volume."""

import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from brdfkit import volumes
from brdfkit.core.arguments import to_number, to_positive, to_whole_number
from brdfkit.rendering.film import Film
from brdfkit.rendering.volumes.render_volume import render_volume
from brdfkit.volumes import TransferFunction, Volume

FRAMES, SIZE = 48, 320


def render_orbit(
    volume: Volume | str | Path,
    transfer: TransferFunction | str | Path | None = None,
    frames: int = FRAMES,
    *,
    size: int | tuple[int, int] = SIZE,
    azimuth: float = 30.0,
    seconds: float | None = None,
    progress: Callable[[int, int], object] | None = None,
    **how: Any,
) -> Film:
    """Render a film of a camera that goes once around a volume, to the camera's right.

    All frames are seen from one distance, from which none is cut, and in the samples of one seed,
    so that the noise does not flicker. Ctrl-C keeps the frames that are finished.

    Parameters
    ----------
    volume : Volume, str or Path
        The volume; or the file, folder or name that `volumes.load` takes.
    transfer : TransferFunction, str or Path, optional
        As in `render_volume`.
    frames : int, default 48
        Pictures of a whole turn, 2 or more.
    size : int or (int, int), default 320
        Side, or width and height, of a frame [pixels].
    azimuth : float, default 30
        Where the camera begins [degrees].
    seconds : float, optional
        Adds samples for so long [s, above 0], all frames together.
    progress : callable, optional
        Called with (done, total) after each pass.
    **how : any
        What `render_volume` takes besides, such as ``renderer="maximum_intensity"``, ``spp=16``.

    Returns
    -------
    Film
        The frames; ``write`` makes a GIF, an animated PNG or a WebP.

    Raises
    ------
    BrdfkitError
        As `render_volume` does.

    Examples
    --------
    >>> render_orbit("brain.nii.gz", frames=24).write("turn.gif")    # doctest: +SKIP
    """
    frames = to_whole_number("frames", frames, least=2)
    azimuth = to_number("azimuth", azimuth)
    each = None if seconds is None else to_positive("seconds", seconds) / frames
    volume = volume if isinstance(volume, Volume) else volumes.load(volume)
    start, spp = time.perf_counter(), 0
    found: list[NDArray[np.float32]] = []
    told = _Told(progress, frames)
    how |= {"size": size, "seconds": each, "progress": told, "all_around": True}
    while len(found) < frames and not told.stopped:
        turned = azimuth + 360 * len(found) / frames
        try:
            shown = render_volume(volume, transfer, azimuth=turned, **how)
        except KeyboardInterrupt:
            if not found:
                raise
            break
        unfinished = shown.spp < (shown.asked or 0)
        told.stopped |= unfinished
        if not (unfinished and found):
            found.append(shown.pictures[shown.reference])
            spp, told.frame = shown.spp, len(found)
    return Film(found, frames, spp, time.perf_counter() - start)


class _Told:
    """A callback for one frame after the other, which remembers that it was interrupted."""

    def __init__(self, progress, frames):
        self.progress, self.frames, self.frame, self.stopped = progress, frames, 0, False

    def __call__(self, done, total):
        try:
            if self.progress:
                self.progress(self.frame * total + done, self.frames * total)
        except KeyboardInterrupt:
            self.stopped = True
            raise
