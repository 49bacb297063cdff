"""`Measured`: a BRDF given by samples or by a table, looked up anywhere and rendered."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

import brdfkit  # for `audit`, of a higher layer, which is imported when it is called
from brdfkit.core import documents
from brdfkit.core.colours import RGB
from brdfkit.core.documents import Document, Shown
from brdfkit.core.jit.threads import cached_in_turn, in_turn
from brdfkit.images.thumbnails import thumbnails
from brdfkit.materials.measured.albedos import MeasuredAlbedo, measured_albedo
from brdfkit.materials.measured.arithmetic import mix, subtract
from brdfkit.materials.measured.from_angles import FromAngles
from brdfkit.materials.measured.interpolation import Interpolant
from brdfkit.materials.measured.mending import mend
from brdfkit.materials.measured.spectrum_to_rgb import rgb_or_mean, to_rgb, wavelengths
from brdfkit.materials.measured.tabulation import (
    bounded,
    reciprocal,
    table_shape,
    tabulate,
    tabulate_lookup,
)
from brdfkit.materials.measured.validation import check_shape
from brdfkit.model.samples import Table


@dataclass(frozen=True, eq=False, repr=False)
class Measured(Shown, FromAngles):
    """A measured BRDF. Made by `brdfkit.load`, or by one of the methods `from_...`.

    Attributes
    ----------
    name : str
        Name in pictures and tables.
    channels : tuple of str
        What the columns of `values` are: ``("R", "G", "B")``, linear sRGB; ``("Y",)``, achromatic;
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
        """The material as a table: its own, or one of the values interpolated between samples."""
        if self._table is not None:
            return self._table
        if isinstance(self._lookup, Table):
            return self._lookup
        if self._lookup is not None:
            return tabulate_lookup(self._lookup, len(self.channels), self.anisotropic)
        return self.resampled(table_shape(self.anisotropic))

    def resampled(self, shape: tuple[int, ...]) -> Table:
        """The BRDF in a reciprocal table of another size.

        Its values are those of `eval`. Where the format itself defines the values between the
        samples, it is asked with the more grazing direction as wi, and directions nearer than 2°
        to the horizon have the values at 2°.

        Parameters
        ----------
        shape : tuple of int
            Cells ([n_phi_h,] n_theta_h, n_theta_d, n_phi_d) of the table.

        Returns
        -------
        Table
            The table; its `values` [sr⁻¹] are of `shape`, with a last axis of channels.

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
        brdf = self.eval
        if self.has_lookup and not isinstance(self._lookup, Table):
            brdf = reciprocal(bounded(self._lookup, self.anisotropic))
        return tabulate(brdf, len(self.channels), shape)

    @cached_in_turn
    def _interpolant(self):
        """The BRDF (wi, wo) → (n, channels) between the samples: the format's own or ours."""
        return self._lookup or Interpolant(self.samples, self.anisotropic)

    def eval(self, wi: ArrayLike, wo: ArrayLike) -> NDArray[np.float64]:
        """BRDF (n, channels) in sr⁻¹ of direction pairs (n, 3), interpolated, never negative."""
        wi, wo = np.asarray(wi, float), np.asarray(wo, float)
        if self._table is not None:
            return np.maximum(self._table.eval(wi, wo), 0)
        above = (wi[:, 2] > 0) & (wo[:, 2] > 0)
        values = np.zeros((len(wi), len(self.channels)))
        values[above] = np.maximum(self._interpolant(wi[above], wo[above]), 0)
        return values

    @property
    def rgb(self) -> "Measured":
        """The same material in linear sRGB, or itself where it is RGB or achromatic already."""
        # Itself is not cached in itself: such a circle would keep its memory for long
        return self if self.channels == RGB or len(self.channels) == 1 else self._in_rgb

    @cached_property
    def _in_rgb(self):
        return to_rgb(self)

    def mixed(
        self, weights: NDArray[np.float64], channels: Sequence[str], **info: str
    ) -> "Measured":
        """The same material in other channels, the old ones mixed by `weights` (old, new)."""
        return mix(self, weights, channels, {**self.info, **info})

    def minus(self, brdf: Any, max_angle: float = 90.0) -> "Measured":
        """The measured values less those of another BRDF: signed residuals, as a measurement.

        Parameters
        ----------
        brdf : Measured, Fit or Model
            What is subtracted, with the same channels or with one.
        max_angle : float, default 90
            Samples with an angle to the normal at or beyond it [degrees, above 0 to 90] are left
            out.

        Returns
        -------
        Measured
            The differences [sr⁻¹] of the samples, or of the cells of a table. `eval`, plots and
            pictures show those below 0 as 0.

        Raises
        ------
        BrdfkitError
            For an angle out of range, other channels, and where no sample is left.

        Examples
        --------
        >>> load("car_paint").minus(models()["ward"]()).values.min() < 0    # doctest: +SKIP
        True
        """
        return subtract(self, brdf, max_angle)

    def mend(self, mirror_azimuth: bool = False, divide_by_cos: bool = False) -> "Measured":
        """The same samples in brdfkit's convention, where a file or an instrument has another.

        What `load` does with the same arguments. The notes in `info` say what was done.

        Parameters
        ----------
        mirror_azimuth : bool, default False
            Whether 180° is added to every phi_o: of an instrument whose mirror direction is at
            phi_o = phi_i.
        divide_by_cos : bool, default False
            Whether the values, and their standard errors, are divided by cos theta_o: of values
            that are the BRDF times this cosine. Samples with a smaller cosine than 0.001 are
            masked.

        Returns
        -------
        Measured
            The mended samples; this material itself where nothing is to be mended.

        Raises
        ------
        BrdfkitError
            For a table, and a format that has values between its samples: they state what they
            hold; and for what was mended, or read as BRDF times cosine, before.

        Examples
        --------
        >>> wi, wo = [[0.6, 0, 0.8]], [[0.6, 0, 0.8]]
        >>> Measured.from_samples(wi, wo, [0.4]).mend(divide_by_cos=True).values
        array([[0.5]])
        """
        return mend(self, mirror_azimuth, divide_by_cos)

    def audit(self) -> "brdfkit.Audit":
        """How far the measurement reaches, how noisy it is and what is doubtful.

        `brdfkit.audit` of this material.

        >>> print(load("copper.astm").audit())    # doctest: +SKIP
        """
        return brdfkit.audit(self)

    @cached_in_turn
    def albedo(self) -> MeasuredAlbedo:
        """The light that the material reflects at 5°, 45° and 75°, where the samples tell it."""
        return measured_albedo(self)

    def document(self) -> Document:
        """What the measurement tells of itself: its size, its look, and the notes of its file."""
        notes = tuple((key.replace("_", " "), str(value)) for key, value in self.info.items())
        pictures = thumbnails(self.name, lambda wi, wo: rgb_or_mean(self).rendered.eval(wi, wo))
        return Document(self.summary, (*pictures, documents.Table(notes)))

    @cached_in_turn
    def tabulated(self) -> "Measured":
        """The same material given by its `table`."""
        if self.is_table:
            return self
        table, info = self.table, self.info
        return self.from_table(table.values, table.phi_d_period, self.channels, self.name, info)

    @property
    def rendered(self) -> "Measured":
        """The material as the renderer shows it: itself, or its table for most lookups."""
        own = self.is_table or hasattr(self._lookup, "scene_dict")
        return self if own else self.tabulated

    @in_turn
    def scene_dict(self) -> dict[str, Any]:
        """The dictionary of `rendered` for `mitsuba.load_dict`, for the current variant."""
        import mitsuba as mi

        spectral = mi.is_spectral and len(self.channels) > 1 and self.channels != RGB
        material = (self if spectral else self.rgb).rendered
        shown: Any = material._table or material._lookup
        entries: dict[str, Any] = shown.scene_dict()
        if spectral:
            entries["wavelengths"] = mi.TensorXf(wavelengths(material).astype(np.float32))
        return entries
