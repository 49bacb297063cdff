"""`render_orbit`: a film of a camera that goes once around a volume."""

import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from brdfkit.arguments import to_number, to_positive, to_whole_number
from brdfkit.rendering.film import Film
from brdfkit.rendering.volumes.render_volume import render_volume
from brdfkit.volumes import TransferFunction, Volume, load_volume

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
        The volume; or the file, folder or name that `load_volume` takes.
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
    **how
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
    volume = volume if isinstance(volume, Volume) else load_volume(volume)
    start, found, spp = time.perf_counter(), [], 0
    for number in range(frames):

        def show(done, total, before=number):
            progress(before * total + done, frames * total)

        try:
            shown = render_volume(
                volume,
                transfer,
                size=size,
                azimuth=azimuth + 360 * number / frames,
                seconds=each,
                progress=progress and show,
                all_around=True,
                **how,
            )
        except KeyboardInterrupt:
            if not found:
                raise
            break
        if shown.spp < shown.asked and found:  # Ctrl-C within the frame
            break
        found.append(shown.pictures[shown.reference])
        spp = shown.spp
        if shown.spp < shown.asked:
            break
    return Film(found, frames, spp, time.perf_counter() - start)
