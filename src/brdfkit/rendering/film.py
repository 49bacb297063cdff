"""`Film`: pictures one after the other that end where they begin, as a file to look at."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from brdfkit.core.colours import to_srgb
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.files import write_safely
from brdfkit.images.tone_mapping import ToneMapping

SUFFIXES = {".gif": "GIF", ".png": "PNG", ".webp": "WEBP"}  # and what Pillow calls them
TURN = 4.0  # seconds of a whole film
SHORTEST = 20  # ms a frame: browsers slow down what is faster
TILES = 16  # frames from which the palette of a GIF is made


@dataclass(frozen=True, eq=False)
class Film:
    """Pictures of a camera that goes around, made by `render_orbit`.

    Attributes
    ----------
    frames : list of ndarray, shape (height, width, 3)
        The pictures: float32, linear sRGB; fewer than `requested` after Ctrl-C.
    requested : int
        Frames of a whole turn.
    spp : int
        Samples per pixel of each.
    seconds : float
        Wall-clock time.
    tone_mapping : ToneMapping
        How they are shown: by one exposure, that of the brightest of them all.
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
        """Write the film, which repeats without an end.

        A GIF has one palette for all frames, with dithering, so that colours neither band nor jump;
        an animated PNG or WebP has all colours.

        Parameters
        ----------
        path : str or Path
            `.gif`, `.png` or `.webp`.

        Raises
        ------
        BrdfkitError
            For another suffix, or where it cannot write; no file is half-written.

        Examples
        --------
        >>> render_orbit("smoke", frames=24).write("smoke.gif")    # doctest: +SKIP
        """
        kind = SUFFIXES[film_suffix(path)]
        images = self._images()
        if kind == "GIF":
            images = _with_one_palette(images)
        duration = max(SHORTEST, 10 * round(100 * TURN / self.requested))
        more = {"quality": 90} if kind == "WEBP" else {}
        with write_safely(Path(path)) as beside:
            images[0].save(
                beside,
                kind,
                save_all=True,
                append_images=images[1:],
                duration=duration,
                loop=0,
                **more,
            )

    def _images(self):
        from PIL import Image

        brightest = max(map(self.tone_mapping.brightest_of, self.frames))
        shown = (np.nan_to_num(self.tone_mapping(f, brightest)) for f in self.frames)
        return [Image.fromarray((255 * to_srgb(s) + 0.5).astype(np.uint8)) for s in shown]


def film_suffix(path: str | Path) -> str:
    """The suffix of a film; `BrdfkitError` for any other."""
    suffix = Path(path).suffix.lower()
    if suffix not in SUFFIXES:
        raise BrdfkitError(f"{path}: films are written as {', '.join(SUFFIXES)}; choose one.")
    return suffix


def _with_one_palette(images):
    """The images in the 256 colours that are best for all of them."""
    from PIL import Image

    chosen = images[:: -(-len(images) // TILES)]
    width, height = images[0].size
    sheet = Image.new("RGB", (width, height * len(chosen)))
    for row, image in enumerate(chosen):
        sheet.paste(image, (0, row * height))
    palette = sheet.quantize(256, Image.Quantize.MEDIANCUT)
    return [i.quantize(palette=palette, dither=Image.Dither.FLOYDSTEINBERG) for i in images]
