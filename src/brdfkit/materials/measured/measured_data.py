"""`MeasuredData`: the samples or the table of a measurement; `Measured` adds the lookup."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from math import pi
from typing import Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from brdfkit.core.colours import RGB
from brdfkit.materials.measured.checksum import checksum
from brdfkit.materials.measured.validation import (
    check_errors,
    check_table,
    make_printable,
    usual_channels,
)
from brdfkit.model.samples import Samples, Table

MOST = 8  # channels that are named


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
    standard_error: NDArray[np.float64] | None = field(default=None, repr=False)
    _samples: Samples | None = field(default=None, repr=False)
    _table: Table | None = field(default=None, repr=False)
    _lookup: Callable | None = field(default=None, repr=False)

    @classmethod
    def from_samples(
        cls,
        wi: ArrayLike,
        wo: ArrayLike,
        values: ArrayLike,
        valid: ArrayLike | None = None,
        channels: Sequence[str] | None = None,
        name: str = "samples",
        info: Mapping[str, str] | None = None,
        anisotropic: bool = False,
        standard_error: ArrayLike | None = None,
        lookup: Callable[[NDArray[np.float64], NDArray[np.float64]], NDArray[np.float64]]
        | None = None,
    ) -> Self:
        """A measured BRDF from samples: pairs of directions with the values measured there.

        Parameters
        ----------
        wi, wo : array_like, shape (n, 3)
            Directions in the local frame, z along the normal; they need not be normalised.
        values : array_like, shape (n, channels) or, of one channel, (n,)
            BRDF [sr⁻¹], without a cosine.
        valid : array_like of bool, shape (n,), optional
            False where nothing was measured. Samples with a value that is not finite or with a
            direction below the surface never count.
        channels : sequence of str, optional
            What the columns of `values` are: ``("R", "G", "B")``, linear sRGB, by default for
            three; ``("Y",)``, achromatic, for one; or wavelengths, as ``("400nm", "410nm")``.
        name : str, default "samples"
            Name in pictures and tables.
        info : dict of str to str, optional
            Notes, as ``{"instrument": "gonioreflectometer"}``.
        anisotropic : bool, default False
            Whether the BRDF changes as the surface turns about its normal.
        standard_error : array_like, the shape of `values`, optional
            Standard errors of the values [sr⁻¹].
        lookup : callable, optional
            Gives the values (m, channels) between the samples for (wi, wo), both (m, 3); by default
            they are interpolated. A lookup with `scene_dict()` and `mixed(weights)` is rendered
            itself, any other as a table of its values.

        Returns
        -------
        Measured
            The material.

        Raises
        ------
        BrdfkitError
            For shapes that do not fit, and where no sample is valid.

        Examples
        --------
        >>> up = [[0, 0, 1]]
        >>> print(Measured.from_samples(up, up, [0.2], name="grey"))
        grey: samples, 1 of 1 valid, channels Y
        """
        if channels is None:
            channels = usual_channels(values, len(np.atleast_2d(wi)), name)
        words = make_printable(name, channels, info)
        name = words[0]
        samples = Samples.from_arrays(wi, wo, values, valid, channels, name)
        valid_values = np.where(samples.valid[:, None], samples.values, np.nan)
        errors = check_errors(standard_error, valid_values, name)
        return cls(*words, anisotropic, errors, _samples=samples, _lookup=lookup)

    @classmethod
    def from_table(
        cls,
        values: ArrayLike,
        phi_d_period: float = pi,
        channels: Sequence[str] = RGB,
        name: str = "table",
        info: Mapping[str, str] | None = None,
        standard_error: ArrayLike | None = None,
    ) -> Self:
        """A measured BRDF from a table over half/difference angles, as MERL's.

        Axes: theta_h, square-root spaced from 0° to 90°; theta_d, even from 0° to 90°; phi_d, even
        over `phi_d_period`; before them, in an anisotropic table, phi_h, even over 360°. A value
        belongs to the centre of its cell.

        Parameters
        ----------
        values : array_like, shape ([n_phi_h,] n_theta_h, n_theta_d, n_phi_d, channels)
            BRDF [sr⁻¹], without a cosine; NaN where nothing was measured.
        phi_d_period : float, default pi
            π for a reciprocal table, 2π for another one [rad].
        channels : sequence of str, default RGB
            What the last axis is: ``("R", "G", "B")``, linear sRGB; ``("Y",)``, achromatic; or
            wavelengths, as ``("400nm", "410nm")``.
        name : str, default "table"
            Name in pictures and tables.
        info : dict of str to str, optional
            Notes, as ``{"instrument": "gonioreflectometer"}``.
        standard_error : array_like, the shape of `values`, optional
            Standard errors of the values [sr⁻¹].

        Returns
        -------
        Measured
            The material.

        Raises
        ------
        BrdfkitError
            For another shape or period, and where no cell is measured.

        Examples
        --------
        >>> print(Measured.from_table(np.full((9, 9, 18, 3), 0.1), name="grey"))
        grey: 9×9×18 table, 966 of 1,458 valid, channels R G B
        """
        words = make_printable(name, channels, info)
        name = words[0]
        table = Table(check_table(values, phi_d_period, channels, name), phi_d_period)
        errors = check_errors(standard_error, table.values, name)
        return cls(*words, table.anisotropic, errors, _table=table)

    @property
    def is_table(self) -> bool:
        """True when the measurement came as a table, False when as scattered samples."""
        return self._table is not None

    @property
    def has_lookup(self) -> bool:
        """True where the format itself defines the values between the samples."""
        return self._lookup is not None

    @cached_property
    def samples(self) -> Samples:
        """The direction pairs and values; those of a table are its cell centres."""
        if self._samples is not None:
            return self._samples
        return Samples.from_table(self._table)

    @property
    def values(self) -> NDArray[np.float64]:
        """Measured BRDF (n, channels) in sr⁻¹ at `samples`."""
        return self.samples.values

    @cached_property
    def extents_by_angle(self) -> dict[float, NDArray[np.float64]]:
        """The extents of the samples below an angle, kept; see `selection.py`."""
        return {}

    @cached_property
    def checksum(self) -> str:
        """The SHA-256 of the directions and values: equal data have it, whatever their file."""
        return checksum(self)

    @property
    def summary(self) -> str:
        """What there is, in one line."""
        valid = self.samples.valid
        size = "×".join(map(str, self._table.shape)) + " table" if self._table else "samples"
        if self.anisotropic and not self._table:
            size = "anisotropic samples"
        channels = " ".join(self.channels)
        if len(self.channels) > MOST:
            channels = f"{self.channels[0]} to {self.channels[-1]}, {len(self.channels)} of them"
        counts = f"{valid.sum():,} of {len(valid):,} valid"
        return f"{self.name}: {size}, {counts}, channels {channels}"
