"""`Film`: the frames of a camera that goes once around, and the files that show them."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from brdfkit.core.colours import to_srgb
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.files import write_safely
from brdfkit.images.tone_mapping import ToneMapping

if TYPE_CHECKING:
    from PIL.Image import Image as PillowImage

SUFFIXES = {".gif": "GIF", ".png": "PNG", ".webp": "WEBP"}  # and the formats' names in Pillow
TURN = 4.0  # duration of a whole film [s]
SHORTEST_FRAME = 20  # [ms]; browsers slow down films with shorter frames
PALETTE_FRAMES = 16  # about the number of frames that choose the palette of a GIF


@dataclass(frozen=True, eq=False)
class Film:
    """The pictures of a camera that goes once around a volume, made by `render_orbit`.

    Attributes
    ----------
    frames : list of ndarray, shape (height, width, 3)
        The pictures: float32, linear sRGB; fewer than `requested` after Ctrl-C.
    requested : int
        Frames of a whole turn.
    spp : int
        Samples per pixel of each frame.
    seconds : float
        Wall-clock time.
    tone_mapping : ToneMapping
        The curve that shows the pictures, with the exposure of the brightest frame for all.
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
        kind = SUFFIXES[film_suffix(path)]
        images = self._to_images()
        if kind == "GIF":
            images = _with_one_palette(images)
        duration = max(SHORTEST_FRAME, 10 * round(100 * TURN / self.requested))
        options: dict[str, Any] = {"quality": 90} if kind == "WEBP" else {}
        with write_safely(Path(path)) as beside:
            images[0].save(
                beside,
                kind,
                save_all=True,
                append_images=images[1:],
                duration=duration,
                loop=0,
                **options,
            )

    def _to_images(self) -> list[PillowImage]:
        """Return the frames as 8-bit sRGB images, tone-mapped with one exposure."""
        from PIL import Image

        brightest = max(map(self.tone_mapping.brightest_of, self.frames))
        shown = (np.nan_to_num(self.tone_mapping(f, brightest)) for f in self.frames)
        return [Image.fromarray((255 * to_srgb(s) + 0.5).astype(np.uint8)) for s in shown]


def film_suffix(path: str | Path) -> str:
    """Return the suffix of a film's path; raise `BrdfkitError` for one that no film has."""
    suffix = Path(path).suffix.lower()
    if suffix not in SUFFIXES:
        raise BrdfkitError(f"{path}: films are written as {', '.join(SUFFIXES)}; choose one.")
    return suffix


def _with_one_palette(images: list[PillowImage]) -> list[PillowImage]:
    """Reduce the images to the 256 colours that suit all of them best."""
    from PIL import Image

    chosen = images[:: -(-len(images) // PALETTE_FRAMES)]
    width, height = images[0].size
    sheet = Image.new("RGB", (width, height * len(chosen)))
    for row, image in enumerate(chosen):
        sheet.paste(image, (0, row * height))
    palette = sheet.quantize(256, Image.Quantize.MEDIANCUT)
    return [i.quantize(palette=palette, dither=Image.Dither.FLOYDSTEINBERG) for i in images]
