"""The class `Measured`: a BRDF given by samples or by a table, to evaluate, convert and render."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, partial
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
from brdfkit.materials.measured.evidence import describe_evidence, find_evidence
from brdfkit.materials.measured.from_angles import FromAngles
from brdfkit.materials.measured.interpolation import Interpolant
from brdfkit.materials.measured.measured_data import Lookup
from brdfkit.materials.measured.spectrum_to_rgb import to_rgb, to_rgb_or_mean, wavelengths
from brdfkit.materials.measured.tabulation import (
    choose_table_shape,
    limit_lookup_values,
    make_reciprocal,
    tabulate,
    tabulate_lookup,
)
from brdfkit.materials.measured.validation import check_table_shape
from brdfkit.model.samples import Table


@dataclass(frozen=True, eq=False, repr=False)
class Measured(Shown, FromAngles):
    """A measured BRDF, given by scattered samples or by a table, which can be evaluated anywhere.

    `brdfkit.load` and the class methods `from_...` make it.

    Attributes
    ----------
    name : str
        Name of the material in pictures and tables.
    channels : tuple of str
        Names of the columns of `values`: ``("R", "G", "B")`` for linear sRGB, ``("Y",)`` for
        achromatic values, or wavelengths such as ``("400nm", "410nm")``.
    info : dict of str to str
        Notes by topic, from the file and from its reader.
    anisotropic : bool
        Whether the BRDF changes as the surface turns about its normal.
    standard_error : ndarray, shape (n, channels), or None
        Standard errors of `values` [sr⁻¹], or None where the measurement does not state them.
    evidence : ndarray of uint8, shape (n,), or None
        Of a material from `complete`: 0 where the value was measured, 1 where it was inferred from
        measured ones, 2 where it is a guess. None for other materials.

    Examples
    --------
    >>> wi = wo = np.array([[0, 0, 1.0]])
    >>> Measured.from_samples(wi, wo, [[0.2]], channels=("Y",), name="grey").values
    array([[0.2]])
    """

    @cached_in_turn
    def table(self) -> Table:
        """The BRDF as a `Table` over half and difference angles, to which samples are resampled."""
        if self._table is not None:
            return self._table
        if isinstance(self._lookup, Table):
            return self._lookup
        if self._lookup is not None:
            return tabulate_lookup(self._lookup, len(self.channels), self.anisotropic)
        return self.resampled(choose_table_shape(self.anisotropic))

    def resampled(self, shape: tuple[int, ...]) -> Table:
        """Tabulate the BRDF in a reciprocal table with this number of cells.

        The cells hold the values of `eval`, except where the file format has its own interpolation.
        That one is evaluated with the direction nearer to the horizon as wi, so that the table is
        reciprocal, and directions less than 2° above the horizon get the values at 2°.

        Parameters
        ----------
        shape : tuple of int
            Numbers of cells ([n_phi_h,] n_theta_h, n_theta_d, n_phi_d) of the table.

        Returns
        -------
        Table
            The table; its `values` [sr⁻¹] have this `shape`, and the channels as their last axis.

        Raises
        ------
        BrdfkitError
            For a shape that is not three or four whole numbers of at least 1.

        Examples
        --------
        >>> load("paint.bsdf").resampled((90, 90, 180)).shape    # doctest: +SKIP
        (90, 90, 180)
        """
        check_table_shape(shape, self.name)
        brdf: Lookup = self.eval
        if self._lookup is not None and not isinstance(self._lookup, Table):
            brdf = make_reciprocal(limit_lookup_values(self._lookup, self.anisotropic))
        return tabulate(brdf, len(self.channels), shape)

    @cached_in_turn
    def _interpolant(self) -> Lookup:
        """A function that interpolates the samples: the file format's own one, or brdfkit's."""
        return self._lookup or Interpolant(self.samples, self.anisotropic)

    def eval(self, wi: ArrayLike, wo: ArrayLike) -> NDArray[np.float64]:
        """Return the BRDF [sr⁻¹] (n, channels) for directions to light and viewer, (n, 3) each.

        Values are interpolated between the samples or cells, and negative ones become 0.
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
        """The material in linear sRGB, or the same object where it is RGB or achromatic already."""
        # Cache a converted object only: one that caches itself is a cycle of references, which
        # Python frees late
        return self if self.channels == RGB or len(self.channels) == 1 else self._in_rgb

    @cached_property
    def _in_rgb(self) -> Measured:
        return to_rgb(self)

    def mix_channels(
        self, weights: NDArray[np.float64], channels: Sequence[str], **info: str
    ) -> Measured:
        """Return the material in new `channels`, which are linear combinations of its own.

        `weights` (old, new) are the coefficients, and `info` are notes to add.
        """
        return mix_channels(self, weights, channels, {**self.info, **info})

    def subtract(self, material: Any, max_angle: float = 90.0) -> Measured:
        """Subtract another BRDF from the measured values, as for the residuals of a fit.

        Parameters
        ----------
        material : Measured, Fit or Model
            The material to subtract, with the same number of channels or with one.
        max_angle : float, default 90
            Largest angle to the normal [degrees], above 0 and at most 90; samples at or beyond it
            are left out.

        Returns
        -------
        Measured
            The signed differences [sr⁻¹] at the samples, or in the cells of the table. `eval`,
            plots and pictures show negative differences as 0.

        Raises
        ------
        BrdfkitError
            For an angle out of range, for channels that do not fit, and where no sample is left.

        Examples
        --------
        >>> load("car_paint").subtract(models()["ward"]()).values.min() < 0    # doctest: +SKIP
        True
        """
        return subtract(self, material, max_angle)

    def mend(self, mirror_azimuth: bool = False, divide_by_cos: bool = False) -> Measured:
        """Convert samples from the convention of a file or an instrument to brdfkit's.

        `load` has the same arguments. Notes in `info` say what was done.

        Parameters
        ----------
        mirror_azimuth : bool, default False
            Whether to add 180° to the azimuth phi_o of every view, for an instrument that has the
            mirror direction at phi_o = phi_i.
        divide_by_cos : bool, default False
            Whether to divide the values, and their standard errors, by cos theta_o, for values that
            are the BRDF times this cosine. Samples with a cosine below 0.001 are masked.

        Returns
        -------
        Measured
            The converted samples; the same object where both arguments are False.

        Raises
        ------
        BrdfkitError
            For a table, and for a file format with its own interpolation, because their conventions
            are known; and for samples that were converted before.

        Examples
        --------
        >>> wi, wo = [[0.6, 0, 0.8]], [[0.6, 0, 0.8]]
        >>> Measured.from_samples(wi, wo, [0.4]).mend(divide_by_cos=True).values
        array([[0.5]])
        """
        return mend(self, mirror_azimuth, divide_by_cos)

    @cached_in_turn
    def albedo(self) -> MeasuredAlbedo:
        """The directional albedo at incidences of 5°, 45° and 75°, and whether it is measured."""
        return compute_measured_albedo(self)

    def document(self) -> Document:
        """Return a document that describes the material: a summary, pictures, and its notes."""
        notes = {**describe_evidence(self), **self.info}
        rows = tuple((key.replace("_", " "), str(value)) for key, value in notes.items())
        pictures = make_thumbnails(
            self.name,
            lambda wi, wo: to_rgb_or_mean(self).rendered.eval(wi, wo),
            None if self.evidence is None else partial(find_evidence, self),
        )
        return Document(self.summary, (*pictures, documents.Table(rows)))

    @cached_in_turn
    def tabulated(self) -> Measured:
        """The material as a `Measured` that holds its `table` in place of the samples."""
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
        """The form that Mitsuba renders: the same object if a plugin takes it, else `tabulated`."""
        has_plugin = self.is_table or hasattr(self._lookup, "scene_dict")
        return self if has_plugin else self.tabulated

    @in_turn
    def scene_dict(self) -> dict[str, Any]:
        """Return the dictionary from which `mitsuba.load_dict` makes the BSDF.

        In a spectral variant it has the measured wavelengths, otherwise linear sRGB.
        """
        import mitsuba as mi

        spectral = mi.is_spectral and len(self.channels) > 1 and self.channels != RGB
        material = (self if spectral else self.rgb).rendered
        table_or_lookup: Any = material._table or material._lookup
        entries: dict[str, Any] = table_or_lookup.scene_dict()
        if spectral:
            entries["wavelengths"] = mi.TensorXf(wavelengths(material).astype(np.float32))
        return entries
