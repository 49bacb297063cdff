"""`render_orbit`: a film from a camera that moves once around a volume."""

from __future__ import annotations

import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from brdfkit import volumes
from brdfkit.core.arguments import to_number, to_positive_number, to_whole_number
from brdfkit.core.progress_bar import Progress
from brdfkit.rendering.film import Film
from brdfkit.rendering.volumes.render_volume import (
    BACKGROUND,
    Radiance,
    VolumeLike,
    render_volume,
)
from brdfkit.volumes import Volume
from brdfkit.volumes.transfer.transfer_function import TransferLike

FRAMES, SIZE = 48, 320


def render_orbit(
    volume: VolumeLike,
    transfer: TransferLike | None = None,
    *,
    frames: int = FRAMES,
    renderer: str = "single_scattering",
    settings: Mapping[str, Any] | None = None,
    spp: int | None = None,
    size: int | tuple[int, int] = SIZE,
    environment: str | Path = "studio",
    background: Radiance | None = BACKGROUND,
    azimuth: float = 30.0,
    elevation: float = 20.0,
    density: float = 1.0,
    noise_floor: float | None = None,
    seconds: float | None = None,
    seed: int = 0,
    progress: Progress | None = None,
) -> Film:
    """Render a film from a camera that moves once around a volume, to the camera's right.

    The distance of the camera is the same for all frames, and nothing is cut off in any of them.
    All have the same seed, so that the noise does not flicker. Ctrl-C keeps the finished frames.

    Parameters
    ----------
    volume : Volume, str or Path
        The volume; or the file, folder or name that `brdfkit.volumes.load` takes.
    transfer : TransferFunction, str or Path, optional
        As in `render_volume`.
    frames : int, default 48
        Number of pictures of a whole turn, 2 or more.
    renderer : str, default "single_scattering"
        As in `render_volume`.
    settings : dict of str to object, optional
        As in `render_volume`.
    spp : int, optional
        As in `render_volume`.
    size : int or (int, int), default 320
        Side, or width and height, of a frame [pixels].
    environment : str or Path, default "studio"
        As in `render_volume`.
    background : float or (float, float, float), optional
        As in `render_volume`; by default 0.02.
    azimuth : float, default 30
        Azimuth of the camera in the first frame [degrees].
    elevation : float, default 20
        As in `render_volume`.
    density : float, default 1
        As in `render_volume`.
    noise_floor : float, optional
        As in `render_volume`, for each frame.
    seconds : float, optional
        Time for which samples are added [s, above 0], for all frames together.
    seed : int, default 0
        Seed of the samples of every frame.
    progress : callable, optional
        Called with (done, total) after each pass.

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
    frame_seconds = None if seconds is None else to_positive_number("seconds", seconds) / frames
    volume = volume if isinstance(volume, Volume) else volumes.load(volume)
    start, frame_spp = time.perf_counter(), 0
    pictures: list[NDArray[np.float32]] = []
    reporter = _FrameProgress(progress, frames)
    options: dict[str, Any] = {"renderer": renderer, "settings": settings, "density": density}
    options |= {"environment": environment, "background": background, "elevation": elevation}
    options |= {"spp": spp, "size": size, "seed": seed, "all_around": True}
    options |= {"noise_floor": noise_floor, "seconds": frame_seconds}
    while len(pictures) < frames and not reporter.stopped:
        frame_azimuth = azimuth + 360 * len(pictures) / frames
        try:
            rendering = render_volume(
                volume, transfer, azimuth=frame_azimuth, progress=reporter, **options
            )
        except KeyboardInterrupt:
            if not pictures:
                raise
            break
        unfinished = rendering.spp < (rendering.requested or 0)
        reporter.stopped |= unfinished
        if not (unfinished and pictures):
            pictures.append(rendering.pictures[rendering.reference])
            frame_spp, reporter.frame = rendering.spp, len(pictures)
    return Film(pictures, frames, frame_spp, time.perf_counter() - start)


class _FrameProgress:
    """Converts the progress of single frames to the progress of the whole film, and reports it.

    `frame` is the number of finished frames; `stopped` becomes True if the user presses Ctrl-C.
    """

    def __init__(self, progress: Progress | None, frames: int) -> None:
        self.progress, self.frames, self.frame, self.stopped = progress, frames, 0, False

    def __call__(self, done: int, total: int) -> None:
        """Report that `done` of `total` passes of the current frame are finished."""
        try:
            if self.progress:
                self.progress(self.frame * total + done, self.frames * total)
        except KeyboardInterrupt:
            self.stopped = True
            raise
