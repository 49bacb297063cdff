"""`MeasuredData`: the samples or the table of a measurement; `Measured` adds the lookup."""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from brdfkit.colours import RGB
from brdfkit.measured.validation import check_errors, check_table, make_printable
from brdfkit.samples import Samples, Table


@dataclass(frozen=True, eq=False)
class MeasuredData:
    """The data of a `Measured`, checked, without values between them.

    Either `_samples` or `_table` is given, the other is None; `_lookup`: the format's own
    interpolation between the samples, or None. The other attributes: see `Measured`.
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
        name, channels, info = make_printable(name, channels, info)
        samples = Samples.from_arrays(wi, wo, values, valid, channels, name)
        return cls(
            name,
            channels,
            info,
            anisotropic,
            check_errors(standard_error, samples.values, name),
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
        name, channels, info = make_printable(name, channels, info)
        values = check_table(values, phi_d_period, channels, name)
        table = Table(values, phi_d_period)
        errors = check_errors(standard_error, values, name)
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

    @property
    def values(self):
        """Measured BRDF (n, channels) in sr⁻¹ at `samples`."""
        return self.samples.values

    def __str__(self):
        valid = self.samples.valid
        size = "×".join(map(str, self._table.shape)) + " table" if self.is_table else "samples"
        return (
            f"{self.name}: {size}, {valid.sum():,} of {len(valid):,} valid, "
            f"channels {' '.join(self.channels)}"
        )
