"""Makes a `Measured` from a user's samples, given by angles or by a table of named columns."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Self

import numpy as np

from brdfkit.core.array_types import ArrayLike, FloatArray
from brdfkit.materials.measured.angles import require_known_unit
from brdfkit.materials.measured.columns import extract_columns, to_float_array, to_sample_arguments
from brdfkit.materials.measured.coordinates import is_surface_turned, to_directions
from brdfkit.materials.measured.measured_data import MeasuredData
from brdfkit.materials.measured.validation import Origin, check_notes


class FromAngles(MeasuredData):
    """A base class of `Measured` that adds the constructors `from_angles` and `from_frame`."""

    @classmethod
    def from_angles(
        cls,
        theta_i: ArrayLike,
        phi_i: ArrayLike,
        theta_o: ArrayLike,
        phi_o: ArrayLike,
        values: ArrayLike,
        *,
        unit: str | None = None,
        channels: Sequence[str] | None = None,
        name: str = "samples",
        info: Mapping[str, str] | None = None,
        anisotropic: bool | None = None,
        standard_error: ArrayLike | None = None,
    ) -> Self:
        """Make a measured BRDF from samples at angles, as a goniometer measures them.

        Theta is the angle to the normal and phi the azimuth; i stands for the direction to the
        light and o for the direction to the viewer. The mirror direction is at phi_o = phi_i + 180°
        and theta_o = theta_i. A negative theta points to the other side of the normal, as a turn of
        phi by 180° does: with phi_i = 0 and phi_o = 180°, theta_o = -theta_i points to the light.
        Where an instrument only states the difference phi_o - phi_i, give it as phi_o, and 0 as
        phi_i.

        Parameters
        ----------
        theta_i, phi_i, theta_o, phi_o : array_like or float
            Angles, theta from -90° to 90° and phi from -360° to 360°. NumPy broadcasts numbers and
            arrays: ``theta_i[:, None]`` and ``theta_o`` make a grid.
        values : array_like, with the broadcast shape of the angles
            BRDF [sr⁻¹], without a cosine; NaN where nothing was measured. More than one channel is
            a last axis.
        unit : {"degrees", "radians"}, optional
            Unit of the angles, by default degrees. It must be given where all angles are so small
            that they might be in radians.
        channels : sequence of str, optional
            Names of the channels on the last axis of `values`, as in `from_samples`.
        name : str, default "samples"
            Name of the material in pictures and tables.
        info : dict of str to str, optional
            Notes by topic, such as ``{"instrument": "gonioreflectometer"}``.
        anisotropic : bool, optional
            Whether the BRDF changes as the surface turns about its normal. By default it is True
            where phi_i varies, other than by full turns.
        standard_error : array_like, the shape of `values`, optional
            Standard errors of the values [sr⁻¹].

        Returns
        -------
        Measured
            The material.

        Raises
        ------
        BrdfkitError
            For angles that are not finite or below the horizon, for a missing unit, and for shapes
            that do not fit each other. The errors number the samples from 0.

        Examples
        --------
        >>> theta_o = np.arange(-80, 81, 5)  # degrees, in the plane of incidence
        >>> values = 0.1 + np.exp(-(((theta_o - 30) / 5) ** 2))
        >>> print(Measured.from_angles(30, 0, theta_o, 180, values, name="mine"))
        mine: samples, 33 of 33 valid, channels Y
        """
        origin = Origin(name)
        require_known_unit(unit)
        named = {"theta_i": theta_i, "phi_i": phi_i, "theta_o": theta_o, "phi_o": phi_o}
        angles, shape = _broadcast_angles(named, origin)
        units = dict.fromkeys(angles, unit)
        wi, wo = to_directions(angles, units, origin)
        values = _flatten_values("values", values, shape, origin)
        if standard_error is not None:
            standard_error = _flatten_values("standard_error", standard_error, shape, origin)
        return cls.from_samples(
            wi,
            wo,
            values,
            channels=channels,
            name=name,
            info=info,
            anisotropic=is_surface_turned(angles, units) if anisotropic is None else anisotropic,
            standard_error=standard_error,
        )

    @classmethod
    def from_frame(
        cls,
        frame: Any,
        *,
        unit: str | None = None,
        name: str = "samples",
        info: Mapping[str, str] | None = None,
        anisotropic: bool | None = None,
    ) -> Self:
        """Make a measured BRDF from a DataFrame, or from any table of named columns.

        The names say what the columns contain, as in the CSV files that `load` reads. Directions
        are given by one of these sets of columns:

        - theta_i, phi_i, theta_o, phi_o: as in `from_angles`;
        - theta_i, theta_o, delta_phi: delta_phi is phi_o - phi_i, 180° in the mirror direction;
        - theta_h, [phi_h,] theta_d, phi_d: half and difference angles of Rusinkiewicz, as MERL's;
        - wi_x, wi_y, wi_z, wo_x, wo_y, wo_z: unit vectors, z along the normal.

        Values are columns R, G, B in linear sRGB, or wavelengths such as 550nm, or one column BRDF.
        Columns CCBRDF, CCBRDF_R or CCBRDF_550nm contain the BRDF times cos theta_o, and are divided
        by this cosine. Standard errors are columns such as R_error, 550nm_error, BRDF_error or
        standard_error. A unit may follow a name, as in ``theta_i [rad]``. If a column wavelength
        [nm] or channel (R, G or B) stands beside BRDF, each row has the value of one channel.

        Parameters
        ----------
        frame : DataFrame or dict of str to array_like
            The columns, with equal lengths; a single number in a dictionary counts for all rows.
        unit : {"degrees", "radians"}, optional
            Unit of the angles whose names state none, by default degrees. It must be given where
            all angles are so small that they might be in radians.
        name : str, default "samples"
            Name of the material in pictures and tables.
        info : dict of str to str, optional
            Notes by topic, such as ``{"instrument": "gonioreflectometer"}``.
        anisotropic : bool, optional
            Whether the BRDF changes as the surface turns about its normal. By default it is True
            where the azimuth of the light, or of the half vector, varies.

        Returns
        -------
        Measured
            The material. Rows with a value that is not finite count as not measured.

        Raises
        ------
        BrdfkitError
            For columns that are unknown, missing or of different lengths, and for impossible
            numbers. The errors number the rows from 0.

        Examples
        --------
        >>> frame = {"theta_i": 30, "theta_o": [10, 30, 50], "delta_phi": 180, "BRDF": [1, 9, 2]}
        >>> print(Measured.from_frame(frame, name="mine"))
        mine: samples, 3 of 3 valid, channels Y
        """
        origin = Origin(name)
        names, columns = extract_columns(frame, origin)
        arguments = to_sample_arguments(names, columns, unit, origin)
        arguments["info"] |= check_notes(info, name)
        if anisotropic is not None:
            arguments["anisotropic"] = anisotropic
        return cls.from_samples(**arguments, name=name)


def _broadcast_angles(
    angles: Mapping[str, ArrayLike], origin: Origin
) -> tuple[dict[str, FloatArray], tuple[int, ...]]:
    """Broadcast the `angles` to one shape; return them flattened to (n,) by name, and the shape."""
    arrays = [to_float_array(name, angle, origin) for name, angle in angles.items()]
    try:
        broadcast = np.broadcast_arrays(*arrays)
    except ValueError:
        shapes = ", ".join(f"{n} {a.shape}" for n, a in zip(angles, arrays, strict=True))
        raise origin.error(
            f"the shapes {shapes} do not go together; give numbers and arrays of one length"
        ) from None
    return dict(zip(angles, map(np.ravel, broadcast), strict=True)), broadcast[0].shape


def _flatten_values(
    what: str, numbers: ArrayLike, shape: tuple[int, ...], origin: Origin
) -> FloatArray:
    """Flatten `numbers` that have the angles' `shape` to (n,); an axis of channels is kept.

    `what` is their name in the error for another shape.
    """
    values, axes = to_float_array(what, numbers, origin), len(shape)
    if values.shape[:axes] != shape or values.ndim > axes + 1:
        raise origin.error(
            f"{what} {values.shape} should have the shape of the angles, {shape}, or that and "
            "channels"
        )
    return values.reshape(-1, *values.shape[axes:])
