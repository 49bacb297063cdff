"""`Film`: the frames of a camera that moves once around a volume, and their animation files."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from brdfkit.core.colours import to_srgb
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.files import write_safely
from brdfkit.images.tone_mapping import ToneMapping

if TYPE_CHECKING:
    from PIL.Image import Image as PillowImage

# For each suffix of a film's file, Pillow's name of the format
SUFFIXES = {
    ".gif": "GIF",
    ".png": "PNG",
    ".webp": "WEBP",
}
TURN = 4.0  # duration of a whole film [s]
SHORTEST_FRAME = 20  # shortest duration of a frame [ms]; browsers slow down shorter frames
PALETTE_FRAMES = 16  # approximate number of frames from which the palette of a GIF is chosen


@dataclass(frozen=True, eq=False)
class Film:
    """Pictures from a camera that moves once around a volume, made by `render_orbit`.

    Attributes
    ----------
    frames : list of ndarray, shape (height, width, 3)
        The pictures: float32, linear sRGB; fewer than `requested` after Ctrl-C.
    requested : int
        Number of frames of a whole turn.
    spp : int
        Samples per pixel of each frame.
    seconds : float
        Wall-clock time of the rendering.
    tone_mapping : ToneMapping
        The curve that maps radiance to displayed values, with the exposure of the brightest frame.
    """

    frames: list[NDArray[np.float32]] = field(repr=False)
    requested: int
    spp: int
    seconds: float
    tone_mapping: ToneMapping = field(default_factory=ToneMapping)

    def __str__(self) -> str:
        height, width = self.frames[0].shape[:2]
        count = f"{len(self.frames)} frames of {width}×{height} pixels"
        return f"{count}, {self.spp} spp, {self.seconds:.1f} s"

    def write(self, path: str | Path) -> None:
        """Write the film as an animation that repeats endlessly.

        A GIF has one palette for all frames, with dithering, so that colours neither band nor jump;
        an animated PNG or WebP has all colours.

        Parameters
        ----------
        path : str or Path
            The file, `.gif`, `.png` or `.webp`.

        Raises
        ------
        BrdfkitError
            For another suffix, or a file that cannot be written; no file is half-written.

        Examples
        --------
        >>> render_orbit("smoke", frames=24).write("smoke.gif")    # doctest: +SKIP
        """
        kind = SUFFIXES[find_film_suffix(path)]
        with write_safely(Path(path)) as beside:
            write_animation(beside, kind, self._to_images(), self.requested)

    def _to_images(self) -> list[PillowImage]:
        """Return the frames as 8-bit sRGB images, tone-mapped with one exposure."""
        from PIL import Image

        brightest = max(map(self.tone_mapping.brightest_of, self.frames))
        shown = (np.nan_to_num(self.tone_mapping(f, brightest)) for f in self.frames)
        return [Image.fromarray((255 * to_srgb(s) + 0.5).astype(np.uint8)) for s in shown]


def write_animation(
    file: Path | BinaryIO, kind: str, images: list[PillowImage], requested: int
) -> None:
    """Write images as an animation that repeats endlessly.

    `kind` is a value of `SUFFIXES`, and `requested` the number of images of a whole turn.
    """
    if kind == "GIF":
        images = _reduce_to_one_palette(images)
    options: dict[str, Any] = {"quality": 90} if kind == "WEBP" else {}
    images[0].save(
        file,
        kind,
        save_all=True,
        append_images=images[1:],
        duration=max(SHORTEST_FRAME, 10 * round(100 * TURN / requested)),
        loop=0,
        **options,
    )


def find_film_suffix(path: str | Path) -> str:
    """Return the suffix of a path; raise `BrdfkitError` if films are not written in this format."""
    suffix = Path(path).suffix.lower()
    if suffix not in SUFFIXES:
        raise BrdfkitError(f"{path}: films are written as {', '.join(SUFFIXES)}; choose one.")
    return suffix


def _reduce_to_one_palette(images: list[PillowImage]) -> list[PillowImage]:
    """Reduce images to one common palette of 256 colours; with a palette each, GIFs flicker."""
    from PIL import Image

    chosen = images[:: -(-len(images) // PALETTE_FRAMES)]
    width, height = images[0].size
    sheet = Image.new("RGB", (width, height * len(chosen)))
    for row, image in enumerate(chosen):
        sheet.paste(image, (0, row * height))
    palette = sheet.quantize(256, Image.Quantize.MEDIANCUT)
    return [i.quantize(palette=palette, dither=Image.Dither.FLOYDSTEINBERG) for i in images]
