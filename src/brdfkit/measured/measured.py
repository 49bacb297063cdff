"""`Measured`: a BRDF given by samples or by a table, looked up anywhere and rendered."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

import brdfkit  # for `audit`, which lies in a higher layer
from brdfkit.colours import RGB
from brdfkit.measured.data import MeasuredData
from brdfkit.measured.interpolation import Interpolant
from brdfkit.measured.mixing import mix
from brdfkit.measured.spectra import to_rgb, wavelengths
from brdfkit.measured.tabulation import (
    bounded,
    reciprocal,
    table_shape,
    tabulate,
    tabulate_lookup,
)
from brdfkit.samples import Table
from brdfkit.threads import cached_in_turn, in_turn


@dataclass(frozen=True, eq=False)
class Measured(MeasuredData):
    """A measured BRDF. Make one with `brdfkit.load`, `from_samples` or `from_table`.

    `name`: for people; `channels`: what the columns of the values are: ``("R", "G", "B")``,
    ``("Y",)`` (one, achromatic) or wavelengths as ``("400nm", ...)``; `info`: notes of the
    file and of its reader; `anisotropic`: whether the surface's azimuth counts;
    `standard_error`: (n, channels) of `values`, where the measurement states it.

    >>> wi = wo = np.array([[0, 0, 1.0]])
    >>> Measured.from_samples(wi, wo, [[0.2]], channels=("Y",), name="grey").values
    array([[0.2]])
    """

    @cached_in_turn
    def table(self):
        """The table to look up in; that of samples has what lies between them."""
        if self._table is not None:
            return self._table
        if isinstance(self._lookup, Table):
            return self._lookup
        if self._lookup is not None:
            return tabulate_lookup(self._lookup, len(self.channels), self.anisotropic)
        return self.resampled(table_shape(self.anisotropic))

    def resampled(self, shape):
        """The BRDF in a reciprocal `Table` of `shape` ([n_phi_h,] n_theta_h, n_theta_d, n_phi_d).

        Of a table or of samples it is what `eval` gives; of a format's own interpolation, what
        `table` has where the lower direction is wi.

        >>> load("paint.bsdf").resampled((90, 90, 180)).shape    # doctest: +SKIP
        (90, 90, 180)
        """
        brdf = self.eval
        if self.has_lookup and not isinstance(self._lookup, Table):
            brdf = reciprocal(bounded(self._lookup, self.anisotropic))
        return tabulate(brdf, len(self.channels), shape)

    @cached_in_turn
    def _interpolant(self):
        """The BRDF (wi, wo) → (n, channels) between the samples: the format's own or ours."""
        return self._lookup or Interpolant(self.samples, self.anisotropic)

    def eval(self, wi, wo):
        """BRDF (n, channels) in sr⁻¹ of direction pairs (n, 3), interpolated, never negative."""
        wi, wo = np.asarray(wi, float), np.asarray(wo, float)
        if self._table is not None:
            return np.maximum(self._table.eval(wi, wo), 0)
        above = (wi[:, 2] > 0) & (wo[:, 2] > 0)
        values = np.zeros((len(wi), len(self.channels)))
        values[above] = np.maximum(self._interpolant(wi[above], wo[above]), 0)
        return values

    @cached_property
    def rgb(self):
        """The same material in linear sRGB, or itself where it is RGB or achromatic already."""
        if self.channels == RGB or len(self.channels) == 1:
            return self
        return to_rgb(self)

    def mixed(self, weights, channels, **info):
        """The same material in other channels, the old ones mixed by `weights` (old, new)."""
        return mix(self, weights, channels, {**self.info, **info})

    def audit(self):
        """How far the measurement reaches, how noisy it is and what is doubtful.

        `brdfkit.audit` of this material.

        >>> print(load("copper.astm").audit())    # doctest: +SKIP
        """
        return brdfkit.audit(self)

    @cached_in_turn
    def tabulated(self):
        """The same material given by its `table`."""
        if self.is_table:
            return self
        table, info = self.table, self.info
        return self.from_table(table.values, table.phi_d_period, self.channels, self.name, info)

    @property
    def rendered(self):
        """What the renderer computes: this material, or its table where it can only that."""
        own = self.is_table or hasattr(self._lookup, "scene_dict")
        return self if own else self.tabulated

    @in_turn
    def scene_dict(self):
        """The dictionary for `mitsuba.load_dict`, in the current variant: of what is `rendered`."""
        import mitsuba as mi

        spectral = mi.is_spectral and len(self.channels) > 1 and self.channels != RGB
        material = (self if spectral else self.rgb).rendered
        entries = (material._table or material._lookup).scene_dict()
        if spectral:
            entries["wavelengths"] = mi.TensorXf(wavelengths(material).astype(np.float32))
        return entries
