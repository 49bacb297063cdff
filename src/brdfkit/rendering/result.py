"""`Rendering`, the result of `render`: pictures, differences, and the files that show them."""

from __future__ import annotations

import io
from dataclasses import dataclass, field, replace
from functools import cached_property
from math import inf, isfinite, isnan, nan
from pathlib import Path

import numpy as np

from brdfkit.core.documents import Document, Paragraph, Picture, Shown, Table
from brdfkit.core.documents.parts import BAD
from brdfkit.core.files import write_safely
from brdfkit.images.errors import ImageErrors, compare_pictures
from brdfkit.images.errors.noise import estimate_samples
from brdfkit.images.errors.psnr import psnr
from brdfkit.images.tone_mapping import ToneMapping
from brdfkit.rendering.montage import (
    COLUMNS,
    TILE,
    draw_montage,
    draw_picture,
    find_picture_suffix,
    write_exr,
)

BILLION = 1e9  # number of samples per pixel above which texts say "more than a billion"
WIDEST = 1100  # largest width of the montage in a notebook [pixels]


@dataclass(frozen=True, eq=False, repr=False)
class Rendering(Shown):
    """Pictures of one scene with several materials, made by `render` and `preview`.

    The first picture is the reference, to which the others are compared.

    Attributes
    ----------
    pictures : dict of str to ndarray, shape (height, width, 3)
        The pictures by name: float32, linear sRGB.
    spp : int
        Samples per pixel that every picture has; fewer than `requested` after Ctrl-C.
    seconds : float
        Wall-clock time of the rendering.
    seed : int
        Seed of the samples.
    parameters : dict of str to dict
        Parameters of the materials that have any, by the picture's name.
    mask : ndarray of bool, shape (height, width), or None
        True in the pixels that show the material; None if all pixels count.
    requested : int or None
        Samples per pixel that were requested; with a noise floor, an estimate of the number that
        is needed to reach it.
    other_seed : ndarray, shape (height, width, 3), or None
        An estimate of the reference picture as another seed would give it, which shows the noise.
        None with one sample per pixel.
    requested_noise_floor : float or None
        The noise floor that was requested [dB].
    standard_error : ndarray, shape (height, width, 3), or None
        The standard error of the reference picture, estimated from its passes; inaccurate for few
        passes, and None for one.
    shadows : str
        A text on the shadows in pictures of `preview`, such as "no shadows"; "" for path-traced
        pictures, which contain all shadows.
    tone_mapping : ToneMapping
        The curve with which PNG files and notebooks show the pictures; by default radiance 1 is
        white. The values of the pictures do not change.
    evidence : dict of str to ndarray of int, shape (height, width)
        For each picture of a completed material, by name: where its values were measured, 0,
        inferred, 1, or guessed, 2.
    bare : bool
        Whether PNG files contain the first picture alone, without a caption, as those of
        `viewing.render_view`.
    """

    pictures: dict[str, np.ndarray] = field(repr=False)
    spp: int
    seconds: float
    seed: int = 0
    parameters: dict[str, dict] = field(default_factory=dict)
    mask: np.ndarray | None = field(default=None, repr=False)
    requested: int | None = None
    other_seed: np.ndarray | None = field(default=None, repr=False)
    requested_noise_floor: float | None = None
    shadows: str = ""
    tone_mapping: ToneMapping = field(default_factory=ToneMapping)
    standard_error: np.ndarray | None = field(default=None, repr=False)
    evidence: dict[str, np.ndarray] = field(default_factory=dict, repr=False)
    bare: bool = False

    @property
    def reference(self) -> str:
        """Name of the reference picture, to which the others are compared."""
        return next(iter(self.pictures))

    @property
    def differences(self) -> dict[str, np.ndarray]:
        """Difference of every other picture from the reference, (height, width, 3), by name."""
        first = self.pictures[self.reference]
        return {n: p - first for n, p in self.pictures.items() if n != self.reference}

    def psnr(self) -> dict[str, float]:
        """Return the PSNR [dB], peak signal-to-noise ratio, of each other picture to the reference.

        It is 10·log10(peak² / mean squared difference) of the linear values in the pixels that show
        the material; the peak is the 99.9th percentile of the reference there. It is inf for equal
        pictures.

        Examples
        --------
        >>> render(["car_paint", "ward"], spp=16, size=128).psnr()    # doctest: +SKIP
        {'ward': 24.6}
        """
        return {name: self._compute_psnr(self.pictures[name]) for name in self.differences}

    @cached_property
    def noise_floor(self) -> float:
        """PSNR [dB] of the reference to itself with another seed; nan with one sample per pixel.

        The PSNR of other pictures may exceed it, because they have the same seed as the reference.
        """
        return nan if self.other_seed is None else self._compute_psnr(self.other_seed)

    def _compute_psnr(self, picture: np.ndarray) -> float:
        """Return the PSNR [dB] of a picture to the reference, in the pixels of the mask."""
        return psnr(self.pictures[self.reference], picture, self.mask)

    def errors(self) -> ImageErrors:
        """Compare every other picture with the reference by several metrics.

        Returns
        -------
        ImageErrors
            PSNR, ΔE2000, ΔE ITP and, with brdfkit[metrics] installed, HDR-FLIP and SSIM, over the
            pixels that show the material, and the noise floor of PSNR; prints as a table.

        Examples
        --------
        >>> print(render(["car_paint", "ward"]).errors())    # doctest: +SKIP
        """
        return compare_pictures(self.pictures, self.other_seed, self.mask)

    def write(self, path: str | Path) -> None:
        """Write the pictures to a file.

        The EXR has a part for each picture, with the picture's name, a part "difference: NAME" for
        each linear difference from the reference, and a part "standard error: NAME" for the
        reference. Each part has R, G and B as float32 and, in its header, spp, seed, brdfkit (the
        version), parameters (JSON) and noise_floor [dB]. The PNG shows the pictures side by side
        with captions and, below them, their differences in colour (CIEDE2000). A completed material
        is shown again, hatched where it was not measured.

        Parameters
        ----------
        path : str or Path
            `.exr` for everything, with a `.png` of the same stem beside it, or `.png` alone.

        Raises
        ------
        BrdfkitError
            For another suffix, or a file that cannot be written; no file is half-written.

        Examples
        --------
        >>> render(["car_paint", "ward"]).write("paint.exr")    # doctest: +SKIP
        """
        path = Path(path)
        suffix = find_picture_suffix(path)
        png = io.BytesIO()
        draw = draw_picture if self.bare else draw_montage
        draw(self).save(png, "PNG")
        if suffix == ".exr":
            with write_safely(path) as beside:
                write_exr(self, beside)
        with write_safely(path.with_suffix(".png") if suffix == ".exr" else path) as beside:
            beside.write_bytes(png.getvalue())

    def tone_mapped(self, tone_mapping: ToneMapping | str) -> Rendering:
        """Return a copy that PNG files and notebooks show with another tone-mapping curve.

        EXR files, errors and differences do not change: they are computed from radiance.

        Parameters
        ----------
        tone_mapping : ToneMapping or str
            The curve, or its name: "range", "reinhard", "logarithmic", "filmic".

        Returns
        -------
        Rendering
            A copy with this curve, which shares the pictures.

        Raises
        ------
        BrdfkitError
            For an unknown name of a curve.

        Examples
        --------
        >>> shown = ToneMapping("reinhard", exposure=2)
        >>> render("car_paint").tone_mapped(shown).write("paint.png")    # doctest: +SKIP
        """
        if not isinstance(tone_mapping, ToneMapping):
            tone_mapping = ToneMapping(tone_mapping)
        return replace(self, tone_mapping=tone_mapping)

    @property
    def captions(self) -> dict[str, str]:
        """A short text on each picture, by name: PSNR, noise, shadows and tone-mapping curve."""
        floor = self.noise_floor
        noise = "" if isnan(floor) else "no noise" if floor == inf else f"noise {floor:.1f} dB"
        beside = f", {noise}" if noise else ""
        shadows = f", {self.shadows}" if self.shadows else ""
        first = "reference" if self.differences else f"{self.spp} spp"
        shown = f", {self.tone_mapping}" if str(self.tone_mapping) else ""
        found = {self.reference: first + beside + shadows + shown}
        for name, value in self.psnr().items():
            near = f" ≈ {noise}" if value >= floor < inf else beside
            found[name] = "PSNR unknown" if isnan(value) else f"PSNR {value:.1f} dB{near}"
        return found

    @property
    def head(self) -> str:
        """A line with the size, the samples per pixel and the time of the rendering."""
        height, width = self.pictures[self.reference].shape[:2]
        shadows = f", {self.shadows}" if self.shadows else ""
        return f"{width}×{height} pixels, {self.spp} spp, {self.seconds:.1f} s{shadows}"

    @property
    def shortfall(self) -> str:
        """A sentence on a requested noise floor that was not reached; otherwise ""."""
        floor, requested = self.noise_floor, self.requested_noise_floor
        if requested is None or not isfinite(floor) or floor >= requested:
            return ""
        needed = float(f"{estimate_samples(requested, floor, self.spp):.2g}")
        many = f"about {needed:,.0f}" if needed < BILLION else "more than a billion"
        return f"The noise floor is {floor:.1f} dB; {requested:g} dB take {many} samples per pixel."

    def document(self) -> Document:
        """Return the montage of the pictures, the captions and a line on the rendering."""
        names = ", ".join(self.pictures)
        width = max(self.pictures[self.reference].shape[1], TILE)
        shown = min(len(self.pictures), COLUMNS) * width
        short = (Paragraph(self.shortfall, BAD),) if self.shortfall else ()
        picture = Picture(
            self.drawn,
            f"{'previews' if self.shadows else 'path-traced pictures'} of {names}",
            min(shown, WIDEST),
        )
        return Document(self.head, (picture, Table(tuple(self.captions.items())), *short))

    def drawn(self) -> bytes:
        """Draw the montage as the bytes of a WebP file for notebooks, on a transparent ground."""
        stream, page = io.BytesIO(), draw_montage(self, on_any_ground=True)
        page.thumbnail((WIDEST, 4 * WIDEST))
        page.save(stream, "WEBP", quality=90)
        return stream.getvalue()
