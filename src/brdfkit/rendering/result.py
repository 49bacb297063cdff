"""`Rendering`, what `render` returns: the pictures, their differences, and how to write them."""

import io
from dataclasses import dataclass, field
from math import inf
from pathlib import Path

import numpy as np

from brdfkit.files import write_safely
from brdfkit.rendering.montage import montage, picture_suffix, write_exr


@dataclass(frozen=True, eq=False)
class Rendering:
    """Pictures of one scene with several materials; the first is the reference. Made by `render`.

    Attributes
    ----------
    pictures : dict of str to ndarray, shape (height, width, 3)
        The pictures by name: float32, linear sRGB.
    spp : int
        Samples per pixel that every picture has; fewer than `asked` after Ctrl-C.
    seconds : float
        Wall-clock time.
    seed : int
        Seed of the samples.
    parameters : dict of str to dict
        The material's parameters by the picture's name, where it has any.
    mask : ndarray of bool, shape (height, width), or None
        Where the material shows; None for everywhere.
    asked : int or None
        Samples per pixel that were asked for.
    """

    pictures: dict[str, np.ndarray] = field(repr=False)
    spp: int
    seconds: float
    seed: int = 0
    parameters: dict[str, dict] = field(default_factory=dict)
    mask: np.ndarray | None = field(default=None, repr=False)
    asked: int | None = None

    @property
    def reference(self) -> str:
        """Name of the picture that the others are compared to."""
        return next(iter(self.pictures))

    @property
    def differences(self) -> dict[str, np.ndarray]:
        """Picture minus reference, (height, width, 3), by the name of every other picture."""
        first = self.pictures[self.reference]
        return {n: p - first for n, p in self.pictures.items() if n != self.reference}

    def psnr(self) -> dict[str, float]:
        """Peak signal-to-noise ratio [dB] to the reference, by the name of every other picture.

        10·log10(peak² / mean squared difference), linear values, all channels, over the pixels
        that show the ball; peak is the 99.9th percentile of the reference there. inf for
        equal pictures.

        Examples
        --------
        >>> render(["car_paint", "ward"], spp=16, size=128).psnr()    # doctest: +SKIP
        {'ward': 24.6}
        """
        mask = slice(None) if self.mask is None else self.mask
        peak = np.percentile(self.pictures[self.reference][mask], 99.9)
        errors = {n: np.square(d[mask], dtype=float).mean() for n, d in self.differences.items()}
        with np.errstate(divide="ignore"):  # a black reference: -inf
            return {n: float(10 * np.log10(peak**2 / e)) if e else inf for n, e in errors.items()}

    def write(self, path: str | Path) -> None:
        """Write the pictures to a file.

        The EXR has one named part a picture and one a difference ("difference: NAME"), each
        with R, G, B float32 and, in its header, spp, seed, brdfkit (the version) and parameters
        (JSON). A difference is picture minus reference, linear. The PNG shows the pictures side
        by side, captioned, over their differences in colour (CIEDE2000).

        Parameters
        ----------
        path : str or Path
            `.exr` for everything, with a `.png` of the same stem beside it, or `.png` alone.

        Raises
        ------
        BrdfkitError
            For another suffix, or where it cannot write; no file is half-write_safely.

        Examples
        --------
        >>> render(["car_paint", "ward"]).write("paint.exr")    # doctest: +SKIP
        """
        path = Path(path)
        suffix = picture_suffix(path)
        png = self._repr_png_()
        if suffix == ".exr":
            with write_safely(path) as beside:
                write_exr(self, beside)
        with write_safely(path.with_suffix(".png") if suffix == ".exr" else path) as beside:
            beside.write_bytes(png)

    def _repr_png_(self) -> bytes:
        """The montage, which notebooks show."""
        stream = io.BytesIO()
        montage(self).save(stream, "PNG")
        return stream.getvalue()

    @property
    def captions(self) -> dict[str, str]:
        """A word or two on each picture, by its name."""
        figures = {name: f"PSNR {value:.1f} dB" for name, value in self.psnr().items()}
        return {self.reference: "reference" if figures else f"{self.spp} spp", **figures}

    def __str__(self) -> str:
        height, width = self.pictures[self.reference].shape[:2]
        head = f"{width}×{height} pixels, {self.spp} spp, {self.seconds:.1f} s"
        return "\n".join([head, *(f"  {name}: {said}" for name, said in self.captions.items())])
