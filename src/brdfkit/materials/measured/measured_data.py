"""`MeasuredData`: the samples or the table of a measurement; `Measured` adds the lookup."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from math import pi
from typing import Self, TypeAlias, TypeVar

import numpy as np
from numpy.typing import NDArray

from brdfkit.core.array_types import AnyArray, ArrayLike, FloatArray
from brdfkit.core.colours import RGB
from brdfkit.materials.measured.validation import (
    check_errors,
    check_table,
    default_channels,
    make_printable,
)
from brdfkit.model.samples import Samples, Table

MOST_NAMED_CHANNELS = 8  # in the summary; of more, the first and the last are named

Floats: TypeAlias = NDArray[np.float64]
# A function from directions (wi, wo), both (n, 3), to values (n, channels)
Lookup: TypeAlias = Callable[[FloatArray, FloatArray], FloatArray]
Data = TypeVar("Data", bound="MeasuredData")


@dataclass(frozen=True, eq=False)
class MeasuredData:
    """The checked data of a `Measured`, without values between them.

    Either `_samples` or `_table` is given, and the other is None. `_lookup` is the interpolation
    between the samples that a format itself defines, or None. `Measured` describes the other
    attributes.
    """

    name: str
    channels: tuple[str, ...]
    info: dict[str, str] = field(default_factory=dict)
    anisotropic: bool = False
    standard_error: Floats | None = field(default=None, repr=False)
    _samples: Samples | None = field(default=None, repr=False)
    _table: Table | None = field(default=None, repr=False)
    _lookup: Lookup | None = field(default=None, repr=False)

    @classmethod
    def from_samples(
        cls,
        wi: ArrayLike,
        wo: ArrayLike,
        values: ArrayLike,
        *,
        valid: ArrayLike | None = None,
        channels: Sequence[str] | None = None,
        name: str = "samples",
        info: Mapping[str, str] | None = None,
        anisotropic: bool = False,
        standard_error: ArrayLike | None = None,
        lookup: Lookup | None = None,
    ) -> Self:
        """Make a measured BRDF from samples: pairs of directions with the values measured there.

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
            Names of the columns of `values`: ``("R", "G", "B")``, linear sRGB, by default for
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
            A function that returns the values (m, channels) between the samples for (wi, wo), both
            (m, 3); by default they are interpolated. A lookup with `scene_dict()` and
            `mix_channels(weights)` is rendered itself, any other as a table of its values.

        Returns
        -------
        Measured
            The material.

        Raises
        ------
        BrdfkitError
            For arrays whose shapes do not fit each other, and where no sample is valid.

        Examples
        --------
        >>> up = [[0, 0, 1]]
        >>> print(Measured.from_samples(up, up, [0.2], name="grey"))
        grey: samples, 1 of 1 valid, channels Y
        """
        if channels is None:
            channels = default_channels(values, len(np.atleast_2d(wi)), name)
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
        *,
        phi_d_period: float = pi,
        channels: Sequence[str] = RGB,
        name: str = "table",
        info: Mapping[str, str] | None = None,
        standard_error: ArrayLike | None = None,
    ) -> Self:
        """Make a measured BRDF from a table over half and difference angles, as MERL's.

        The axes are theta_h, square-root spaced from 0° to 90°; theta_d, even from 0° to 90°; and
        phi_d, even over `phi_d_period`. An anisotropic table has phi_h before them, even over 360°.
        A value belongs to the centre of its cell.

        Parameters
        ----------
        values : array_like, shape ([n_phi_h,] n_theta_h, n_theta_d, n_phi_d, channels)
            BRDF [sr⁻¹], without a cosine; NaN where nothing was measured.
        phi_d_period : float, default pi
            π for a reciprocal table, 2π for any other [rad].
        channels : sequence of str, default RGB
            Names of the last axis of `values`, as in `from_samples`.
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
        """Whether the measurement is a table; otherwise it is scattered samples."""
        return self._table is not None

    @property
    def has_lookup(self) -> bool:
        """Whether the file format itself defines the values between the samples."""
        return self._lookup is not None

    @cached_property
    def samples(self) -> Samples:
        """The direction pairs and their values; for a table, at the centres of its cells."""
        if self._table is None:
            assert self._samples is not None
            return self._samples
        return Samples.from_table(self._table)

    @property
    def values(self) -> Floats:
        """The measured BRDF [sr⁻¹] (n, channels) at `samples`."""
        return self.samples.values

    @cached_property
    def extents_by_angle(self) -> dict[float, Floats]:
        """A cache of `selection.py`: the extents of the samples by the largest angle [degrees]."""
        return {}

    @cached_property
    def checksum(self) -> str:
        """The SHA-256 of the channels' names, directions and values, in hexadecimal.

        Equal data have the same checksum, whichever file and format they came from. Numbers are
        hashed as 64 bits each, in C order; a table's directions follow from its shape.
        """
        digest = hashlib.sha256(repr(self.channels).encode())
        if self._table is not None:
            digest.update(repr((self._table.shape, float(self._table.phi_d_period))).encode())
            arrays: list[AnyArray] = [self._table.values]
        else:
            samples = self.samples
            arrays = [samples.wi, samples.wo, samples.values, samples.valid]
        for array in arrays:
            digest.update(np.ascontiguousarray(array, "<f8").data)
        return digest.hexdigest()

    @property
    def kind(self) -> str:
        """The kind in words: "90×90×180 table", "samples" or "anisotropic samples"."""
        if self._table is not None:
            return "×".join(map(str, self._table.shape)) + " table"
        return "anisotropic samples" if self.anisotropic else "samples"

    @property
    def summary(self) -> str:
        """The name, the kind, the number of samples and the channels, in one line."""
        valid = self.samples.valid
        channels = " ".join(self.channels)
        if len(self.channels) > MOST_NAMED_CHANNELS:
            channels = f"{self.channels[0]} to {self.channels[-1]}, {len(self.channels)} of them"
        counts = f"{valid.sum():,} of {len(valid):,} valid"
        return f"{self.name}: {self.kind}, {counts}, channels {channels}"
