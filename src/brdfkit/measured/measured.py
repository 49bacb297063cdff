"""`Measured`: a BRDF given by samples or by a table, with what is known of it."""

import functools
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

import brdfkit  # the public face, for what sees more than a measurement does
from brdfkit.colours import RGB
from brdfkit.errors import BrdfkitError
from brdfkit.measured.interpolation import Scattered
from brdfkit.measured.spectra import to_rgb, wavelengths
from brdfkit.measured.tabulation import looked_up, reciprocal, sampled, steady, table_shape
from brdfkit.names import printable
from brdfkit.samples import Samples, Table
from brdfkit.samples.samples import require_some
from brdfkit.threads import cached_in_turn, in_turn


@dataclass(frozen=True, eq=False)
class Measured:
    """A measured BRDF. Make one with `brdfkit.load`, `from_samples` or `from_table`.

    `name`: for people; `channels`: what the columns of the values are: ``("R", "G", "B")``,
    ``("Y",)`` (one, achromatic) or wavelengths as ``("400nm", ...)``; `info`: notes of the
    file and of its reader; `anisotropic`: whether the surface's azimuth counts;
    `standard_error`: (n, channels) of `values`, where the measurement states it.

    >>> wi = wo = np.array([[0, 0, 1.0]])
    >>> Measured.from_samples(wi, wo, [[0.2]], channels=("Y",), name="grey").values
    array([[0.2]])
    """

    name: str
    channels: tuple[str, ...]
    info: dict[str, str] = field(default_factory=dict)
    anisotropic: bool = False
    standard_error: np.ndarray | None = field(default=None, repr=False)
    _samples: Samples | None = field(default=None, repr=False)
    _table: Table | None = field(default=None, repr=False)
    _lookup: Callable | None = field(default=None, repr=False)

    @classmethod
    def from_samples(
        cls,
        wi,
        wo,
        values,
        valid=None,
        channels=RGB,
        name="samples",
        info=None,
        anisotropic=False,
        standard_error=None,
        lookup=None,
    ):
        """From direction pairs `wi`, `wo` (n, 3) and BRDF `values` (n, channels) in sr⁻¹.

        Directions need not be normalised. `valid` (n,) marks what was measured; without it
        everything finite above the surface is. `standard_error`: of the values, likewise
        (n, channels). `lookup(wi, wo)`: values between the samples, where the format defines them;
        without it `interpolation.py` interpolates. One that has, as a `Table`, `scene_dict()` and
        `mixed(weights)`, is rendered as it is; another one through the table that it gives.
        """
        name, channels, info = _words(name, channels, info)
        samples = Samples.from_arrays(wi, wo, values, valid, channels, name)
        return cls(
            name,
            channels,
            info,
            anisotropic,
            _errors(standard_error, samples.values, name),
            _samples=samples,
            _lookup=lookup,
        )

    @classmethod
    def from_table(
        cls,
        values,
        phi_d_period=np.pi,
        channels=RGB,
        name="table",
        info=None,
        standard_error=None,
    ):
        """From a table (n_theta_h, n_theta_d, n_phi_d, channels) in sr⁻¹, NaN = not measured.

        Its axes are those of `brdfkit.samples.Table`; an anisotropic one has n_phi_h before them.
        An infinite value was not measured, either.
        `standard_error`: of the values, in the same shape.
        """
        name, channels, info = _words(name, channels, info)
        values = np.asarray(values, float)
        if values.ndim not in (4, 5) or values.shape[-1] != len(channels) or 0 in values.shape:
            raise BrdfkitError(
                f"{name}: a table of shape {values.shape} was given; it should be "
                f"([n_phi_h,] n_theta_h, n_theta_d, n_phi_d, {len(channels)})."
            )
        if not 0 < phi_d_period < 7:
            raise BrdfkitError(
                f"{name}: phi_d_period is {phi_d_period:g}; give π or, for a table that is not "
                "reciprocal, 2π."
            )
        require_some(np.isfinite(values).all(axis=-1), name)
        if np.isinf(values).any():
            values = np.where(np.isinf(values), np.nan, values)
        table = Table(values, phi_d_period)
        errors = _errors(standard_error, values, name)
        return cls(name, channels, info, table.anisotropic, errors, _table=table)

    @property
    def is_table(self):
        """True when the measurement came as a table, False when as scattered samples."""
        return self._table is not None

    @property
    def has_lookup(self):
        """True where the format itself defines the values between the samples."""
        return self._lookup is not None

    @cached_property
    def samples(self):
        """The direction pairs and values; those of a table are its cell centres."""
        if self._samples is not None:
            return self._samples
        return Samples.from_table(self._table)

    @cached_in_turn
    def table(self):
        """The table to look up in; that of samples has what lies between them."""
        if self._table is not None:
            return self._table
        if isinstance(self._lookup, Table):
            return self._lookup
        if self._lookup is not None:
            return looked_up(self._lookup, len(self.channels), self.anisotropic)
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
            brdf = reciprocal(steady(self._lookup, self.anisotropic))
        return sampled(brdf, len(self.channels), shape)

    @cached_in_turn
    def _between(self):
        """The BRDF (wi, wo) → (n, channels) between the samples."""
        return self._lookup or Scattered(self.samples, self.anisotropic)

    @property
    def values(self):
        """Measured BRDF (n, channels) in sr⁻¹ at `samples`."""
        return self.samples.values

    def eval(self, wi, wo):
        """BRDF (n, channels) in sr⁻¹ of direction pairs (n, 3), interpolated, never negative."""
        wi, wo = np.asarray(wi, float), np.asarray(wo, float)
        if self._table is not None:
            return np.maximum(self._table.eval(wi, wo), 0)
        above = (wi[:, 2] > 0) & (wo[:, 2] > 0)
        values = np.zeros((len(wi), len(self.channels)))
        values[above] = np.maximum(self._between(wi[above], wo[above]), 0)
        return values

    @cached_property
    def rgb(self):
        """The same material in linear sRGB, or itself where it is RGB or achromatic already."""
        if self.channels == RGB or len(self.channels) == 1:
            return self
        return to_rgb(self)

    def mixed(self, weights, channels, **info):
        """The same material in other channels, the old ones mixed by `weights` (old, new)."""
        info = {**self.info, **info}
        changed = {"channels": tuple(channels), "info": info}
        if self.standard_error is not None:
            changed["standard_error"] = np.sqrt(self.standard_error**2 @ weights**2)
        if self._table is not None:
            changed["_table"] = self._table.mixed(weights)
        if self._samples is not None:
            changed["_samples"] = replace(self._samples, values=self.values @ weights)
        if self._lookup is not None:
            mixed = getattr(self._lookup, "mixed", functools.partial(_Mixed, self._lookup))
            changed["_lookup"] = mixed(weights)
        return replace(self, **changed)

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

    def __str__(self):
        valid = self.samples.valid
        size = "×".join(map(str, self._table.shape)) + " table" if self.is_table else "samples"
        return (
            f"{self.name}: {size}, {valid.sum():,} of {len(valid):,} valid, "
            f"channels {' '.join(self.channels)}"
        )


@dataclass(frozen=True, eq=False)
class _Mixed:
    """A lookup in mixed channels."""

    lookup: Callable
    weights: np.ndarray

    def __call__(self, wi, wo):
        return self.lookup(wi, wo) @ self.weights


def _words(name, channels, info):
    """A name, channels and notes as text that may be printed, whatever file it comes from."""
    notes = {printable(key): printable(note, keep="\n\t") for key, note in (info or {}).items()}
    return printable(name), tuple(map(printable, channels)), notes


def _errors(standard_error, values, name):
    """Standard errors (n, channels) that belong to `values`, or None."""
    if standard_error is None:
        return None
    errors = given = np.asarray(standard_error, float)
    if given.ndim == 1 and values.shape[1:] == (1,):
        errors = given[:, None]
    if errors.shape != values.shape:
        raise BrdfkitError(
            f"{name}: standard errors {given.shape} should have the shape {values.shape} of "
            "the values."
        )
    return errors.reshape(-1, values.shape[-1])
