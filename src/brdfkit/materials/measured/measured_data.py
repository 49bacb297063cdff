"""`MeasuredData`: the base class of `Measured`, which checks and holds the measured values."""

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
    check_standard_errors,
    check_table_values,
    choose_default_channels,
    make_printable,
)
from brdfkit.model.samples import Samples, Table

MOST_NAMED_CHANNELS = 8  # with more channels, the summary names only the first and the last

Floats: TypeAlias = NDArray[np.float64]
# A function that returns BRDF values (n, channels) for the directions wi and wo, both (n, 3)
Lookup: TypeAlias = Callable[[FloatArray, FloatArray], FloatArray]
Data = TypeVar("Data", bound="MeasuredData")


@dataclass(frozen=True, eq=False)
class MeasuredData:
    """The base class of `Measured`: it checks, holds and describes the measured values.

    The derived class interpolates them, and describes the public attributes. Either `_samples`,
    which are scattered, or `_table` holds the values, and the other one is None. `_lookup` is a
    function that replaces brdfkit's interpolation, such as that of a file format, or None.
    """

    name: str
    channels: tuple[str, ...]
    info: dict[str, str] = field(default_factory=dict)
    anisotropic: bool = False
    standard_error: Floats | None = field(default=None, repr=False)
    evidence: NDArray[np.uint8] | None = field(default=None, repr=False, kw_only=True)
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
            Directions to the light and to the viewer in the local frame, z along the normal; they
            need not be normalised.
        values : array_like, shape (n, channels), or (n,) for one channel
            BRDF [sr⁻¹], without a cosine.
        valid : array_like of bool, shape (n,), optional
            False for samples to ignore. Samples with a value that is not finite, or with a
            direction below the surface, are always ignored.
        channels : sequence of str, optional
            Names of the columns of `values`: ``("R", "G", "B")`` for linear sRGB, the default of
            three columns; ``("Y",)`` for achromatic values, the default of one; or wavelengths such
            as ``("400nm", "410nm")``.
        name : str, default "samples"
            Name of the material in pictures and tables.
        info : dict of str to str, optional
            Notes by topic, such as ``{"instrument": "gonioreflectometer"}``.
        anisotropic : bool, default False
            Whether the BRDF changes as the surface turns about its normal.
        standard_error : array_like, the shape of `values`, optional
            Standard errors of the values [sr⁻¹].
        lookup : callable, optional
            A function that returns the BRDF (m, channels) for wi and wo, both (m, 3), in place of
            brdfkit's interpolation of the samples. If it has methods `scene_dict()` and
            `mix_channels(weights)`, Mitsuba renders it itself, otherwise a table of its values.

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
            channels = choose_default_channels(values, len(np.atleast_2d(wi)), name)
        words = make_printable(name, channels, info)
        name = words[0]
        samples = Samples.from_arrays(wi, wo, values, valid, channels, name)
        valid_values = np.where(samples.valid[:, None], samples.values, np.nan)
        errors = check_standard_errors(standard_error, valid_values, name)
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
        """Make a measured BRDF from a table over half and difference angles, as MERL's files have.

        The first axis is theta_h from 0° to 90°, whose square root has even steps. The next ones,
        with even steps, are theta_d from 0° to 90° and phi_d over `phi_d_period`. An anisotropic
        table has phi_h before them, with even steps over 360°. A value belongs to the centre of its
        cell.

        Parameters
        ----------
        values : array_like, shape ([n_phi_h,] n_theta_h, n_theta_d, n_phi_d, channels)
            BRDF [sr⁻¹], without a cosine; NaN where nothing was measured.
        phi_d_period : float, default pi
            The range of phi_d [rad]: π for a reciprocal table, 2π for any other.
        channels : sequence of str, default RGB
            Names of the channels on the last axis of `values`, as in `from_samples`.
        name : str, default "table"
            Name of the material in pictures and tables.
        info : dict of str to str, optional
            Notes by topic, such as ``{"instrument": "gonioreflectometer"}``.
        standard_error : array_like, the shape of `values`, optional
            Standard errors of the values [sr⁻¹].

        Returns
        -------
        Measured
            The material.

        Raises
        ------
        BrdfkitError
            For values of another shape, for an impossible period, and where all cells are NaN.

        Examples
        --------
        >>> print(Measured.from_table(np.full((9, 9, 18, 3), 0.1), name="grey"))
        grey: 9×9×18 table, 966 of 1,458 valid, channels R G B
        """
        words = make_printable(name, channels, info)
        name = words[0]
        table = Table(check_table_values(values, phi_d_period, channels, name), phi_d_period)
        errors = check_standard_errors(standard_error, table.values, name)
        return cls(*words, table.anisotropic, errors, _table=table)

    @property
    def is_table(self) -> bool:
        """Whether the BRDF is given by a table; otherwise it is given by scattered samples."""
        return self._table is not None

    @property
    def has_lookup(self) -> bool:
        """Whether the file format itself defines the values between the samples."""
        return self._lookup is not None

    @cached_property
    def samples(self) -> Samples:
        """The measured pairs of directions and their values, for a table at its cells' centres."""
        if self._table is None:
            assert self._samples is not None
            return self._samples
        return Samples.from_table(self._table)

    @property
    def values(self) -> Floats:
        """The measured BRDF [sr⁻¹] (n, channels), with one row for each of the `samples`."""
        return self.samples.values

    @cached_property
    def extents_by_angle(self) -> dict[float, Floats]:
        """Cache in which `selection.py` keeps extents of the samples by `max_angle` [degrees].

        A sample's extent is the region of directions that it stands for, by which fits weight it.
        """
        return {}

    @cached_property
    def share_beyond_by_angle(self) -> dict[float, float]:
        """Cache in which `extrapolation.py` keeps shares by `max_angle` [degrees]."""
        return {}

    @cached_property
    def checksum(self) -> str:
        """The SHA-256 of the channels' names, the directions and the values, in hexadecimal.

        Equal data have the same checksum, whatever file and format they come from. Numbers are
        hashed as 64 bits each, in C order. Of a table the shape is hashed, which determines the
        directions.
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
        """The kind of data in words: "90×90×180 table", "samples" or "anisotropic samples"."""
        if self._table is not None:
            return "×".join(map(str, self._table.shape)) + " table"
        return "anisotropic samples" if self.anisotropic else "samples"

    @property
    def summary(self) -> str:
        """One line with the material's name, kind of data, number of samples and channels."""
        valid = self.samples.valid
        channels = " ".join(self.channels)
        if len(self.channels) > MOST_NAMED_CHANNELS:
            channels = f"{self.channels[0]} to {self.channels[-1]}, {len(self.channels)} of them"
        counts = f"{valid.sum():,} of {len(valid):,} valid"
        return f"{self.name}: {self.kind}, {counts}, channels {channels}"
