"""`Measured`: a BRDF given by samples or by a table, looked up anywhere and rendered."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from brdfkit.core import documents
from brdfkit.core.array_types import ArrayLike
from brdfkit.core.colours import RGB
from brdfkit.core.documents import Document, Shown
from brdfkit.core.jit.threads import cached_in_turn, in_turn
from brdfkit.images.thumbnails import make_thumbnails
from brdfkit.materials.measured.albedos import MeasuredAlbedo, compute_measured_albedo
from brdfkit.materials.measured.arithmetic import mix_channels, subtract
from brdfkit.materials.measured.conventions import mend
from brdfkit.materials.measured.from_angles import FromAngles
from brdfkit.materials.measured.interpolation import Interpolant
from brdfkit.materials.measured.measured_data import Lookup
from brdfkit.materials.measured.spectrum_to_rgb import to_rgb, to_rgb_or_mean, wavelengths
from brdfkit.materials.measured.tabulation import (
    bound_lookup,
    choose_table_shape,
    make_reciprocal,
    tabulate,
    tabulate_lookup,
)
from brdfkit.materials.measured.validation import check_shape
from brdfkit.model.samples import Table


@dataclass(frozen=True, eq=False, repr=False)
class Measured(Shown, FromAngles):
    """A measured BRDF, made by `brdfkit.load` or by one of the methods `from_...`.

    Attributes
    ----------
    name : str
        Name in pictures and tables.
    channels : tuple of str
        Names of the columns of `values`: ``("R", "G", "B")``, linear sRGB; ``("Y",)``, achromatic;
        or wavelengths, as ``("400nm", "410nm")``.
    info : dict of str to str
        Notes of the file and of its reader.
    anisotropic : bool
        Whether the BRDF changes as the surface turns about its normal.
    standard_error : ndarray, shape (n, channels), or None
        Standard errors of `values` [sr⁻¹], where the measurement states them.

    Examples
    --------
    >>> wi = wo = np.array([[0, 0, 1.0]])
    >>> Measured.from_samples(wi, wo, [[0.2]], channels=("Y",), name="grey").values
    array([[0.2]])
    """

    @cached_in_turn
    def table(self) -> Table:
        """The material as a table: its own, or a table interpolated between the samples."""
        if self._table is not None:
            return self._table
        if isinstance(self._lookup, Table):
            return self._lookup
        if self._lookup is not None:
            return tabulate_lookup(self._lookup, len(self.channels), self.anisotropic)
        return self.resampled(choose_table_shape(self.anisotropic))

    def resampled(self, shape: tuple[int, ...]) -> Table:
        """Tabulate the BRDF in a reciprocal table of another size.

        The table has the values of `eval`. Where the format itself defines the values between the
        samples, it is evaluated with the more grazing direction as wi, and directions less than 2°
        above the horizon get the values at 2°.

        Parameters
        ----------
        shape : tuple of int
            Cells ([n_phi_h,] n_theta_h, n_theta_d, n_phi_d) of the table.

        Returns
        -------
        Table
            The table; its `values` [sr⁻¹] have this `shape` and a last axis of channels.

        Raises
        ------
        BrdfkitError
            For a shape that is not three or four whole numbers of at least 1.

        Examples
        --------
        >>> load("paint.bsdf").resampled((90, 90, 180)).shape    # doctest: +SKIP
        (90, 90, 180)
        """
        check_shape(shape, self.name)
        brdf: Lookup = self.eval
        if self._lookup is not None and not isinstance(self._lookup, Table):
            brdf = make_reciprocal(bound_lookup(self._lookup, self.anisotropic))
        return tabulate(brdf, len(self.channels), shape)

    @cached_in_turn
    def _interpolant(self) -> Lookup:
        """The BRDF between the samples, by the format's own interpolation or by ours."""
        return self._lookup or Interpolant(self.samples, self.anisotropic)

    def eval(self, wi: ArrayLike, wo: ArrayLike) -> NDArray[np.float64]:
        """Return the BRDF [sr⁻¹] (n, channels) of direction pairs (n, 3).

        It is interpolated between the samples or cells, and never negative.
        """
        wi, wo = np.asarray(wi, float), np.asarray(wo, float)
        if self._table is not None:
            return np.maximum(self._table.eval(wi, wo), 0)
        above = (wi[:, 2] > 0) & (wo[:, 2] > 0)
        values = np.zeros((len(wi), len(self.channels)))
        values[above] = np.maximum(self._interpolant(wi[above], wo[above]), 0)
        return values

    @property
    def rgb(self) -> Measured:
        """The material in linear sRGB, or itself where it is RGB or achromatic already."""
        # Not cached where it is the material itself: such a circle would keep its memory for long
        return self if self.channels == RGB or len(self.channels) == 1 else self._in_rgb

    @cached_property
    def _in_rgb(self) -> Measured:
        return to_rgb(self)

    def mix_channels(
        self, weights: NDArray[np.float64], channels: Sequence[str], **info: str
    ) -> Measured:
        """Return the material in other `channels`, mixed from its own by `weights` (old, new).

        `info` are notes to add.
        """
        return mix_channels(self, weights, channels, {**self.info, **info})

    def subtract(self, material: Any, max_angle: float = 90.0) -> Measured:
        """Subtract another BRDF from the measured values: signed residuals, as a measurement.

        Parameters
        ----------
        material : Measured, Fit or Model
            The material to subtract, with the same channels or with one.
        max_angle : float, default 90
            Samples with an angle to the normal at or beyond this one [degrees, above 0 to 90] are
            left out.

        Returns
        -------
        Measured
            The differences [sr⁻¹] at the samples, or in the cells of a table. `eval`, plots and
            pictures show negative differences as 0.

        Raises
        ------
        BrdfkitError
            For an angle out of range, other channels, and where no sample is left.

        Examples
        --------
        >>> load("car_paint").subtract(models()["ward"]()).values.min() < 0    # doctest: +SKIP
        True
        """
        return subtract(self, material, max_angle)

    def mend(self, mirror_azimuth: bool = False, divide_by_cos: bool = False) -> Measured:
        """Convert samples from another convention of a file or an instrument to brdfkit's.

        `load` does this with the same arguments. The notes in `info` say what was done.

        Parameters
        ----------
        mirror_azimuth : bool, default False
            Whether 180° is added to every phi_o, for an instrument whose mirror direction is at
            phi_o = phi_i.
        divide_by_cos : bool, default False
            Whether the values, and their standard errors, are divided by cos theta_o, for values
            that are the BRDF times this cosine. Samples with a cosine below 0.001 are masked.

        Returns
        -------
        Measured
            The mended samples; this material itself where both arguments are False.

        Raises
        ------
        BrdfkitError
            For a table, and for a format with values between its samples, because they state what
            they hold; and for samples that were mended, or read as BRDF times cosine, before.

        Examples
        --------
        >>> wi, wo = [[0.6, 0, 0.8]], [[0.6, 0, 0.8]]
        >>> Measured.from_samples(wi, wo, [0.4]).mend(divide_by_cos=True).values
        array([[0.5]])
        """
        return mend(self, mirror_azimuth, divide_by_cos)

    @cached_in_turn
    def albedo(self) -> MeasuredAlbedo:
        """The albedo at 5°, 45° and 75° of incidence, known where samples are near."""
        return compute_measured_albedo(self)

    def document(self) -> Document:
        """Return the measurement as a document: its size, its look and the notes of its file."""
        notes = tuple((key.replace("_", " "), str(value)) for key, value in self.info.items())
        pictures = make_thumbnails(
            self.name, lambda wi, wo: to_rgb_or_mean(self).rendered.eval(wi, wo)
        )
        return Document(self.summary, (*pictures, documents.Table(notes)))

    @cached_in_turn
    def tabulated(self) -> Measured:
        """The material with its `table` in place of the samples."""
        if self.is_table:
            return self
        return self.from_table(
            self.table.values,
            phi_d_period=self.table.phi_d_period,
            channels=self.channels,
            name=self.name,
            info=self.info,
        )

    @property
    def rendered(self) -> Measured:
        """The material that Mitsuba renders: itself, or its table where Mitsuba has no plugin."""
        has_plugin = self.is_table or hasattr(self._lookup, "scene_dict")
        return self if has_plugin else self.tabulated

    @in_turn
    def scene_dict(self) -> dict[str, Any]:
        """Return the dictionary of `rendered` for `mitsuba.load_dict`, in the current variant."""
        import mitsuba as mi

        spectral = mi.is_spectral and len(self.channels) > 1 and self.channels != RGB
        material = (self if spectral else self.rgb).rendered
        table_or_lookup: Any = material._table or material._lookup
        entries: dict[str, Any] = table_or_lookup.scene_dict()
        if spectral:
            entries["wavelengths"] = mi.TensorXf(wavelengths(material).astype(np.float32))
        return entries
