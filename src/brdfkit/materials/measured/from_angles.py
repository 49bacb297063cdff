"""`MeasuredData` made of angles, or of a table of named columns."""

from collections.abc import Mapping, Sequence
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike

from brdfkit.materials.measured.angles import require_unit
from brdfkit.materials.measured.columns import columns_of, to_numbers, to_samples
from brdfkit.materials.measured.coordinates import to_directions, turns
from brdfkit.materials.measured.measured_data import MeasuredData
from brdfkit.materials.measured.origin import Origin
from brdfkit.materials.measured.validation import to_notes


class FromAngles(MeasuredData):
    """Constructors for people whose samples are angles or a table, rather than vectors."""

    @classmethod
    def from_angles(
        cls,
        theta_i: ArrayLike,
        phi_i: ArrayLike,
        theta_o: ArrayLike,
        phi_o: ArrayLike,
        values: ArrayLike,
        unit: str | None = None,
        channels: Sequence[str] | None = None,
        name: str = "samples",
        info: Mapping[str, str] | None = None,
        anisotropic: bool | None = None,
        standard_error: ArrayLike | None = None,
    ) -> Self:
        """A measured BRDF from samples at angles, as a goniometer has them.

        Theta is the angle to the normal, phi the azimuth; i is the direction to the light, o the
        one to the viewer. The mirror direction is at phi_o = phi_i + 180°. A theta below 0 lies on
        the other side of the normal: in the plane of incidence, with phi_i = 0 and phi_o = 180°,
        theta_o = theta_i is the mirror direction, and theta_o = -theta_i that to the light. Where
        an instrument states phi_o - phi_i alone, phi_i is 0.

        Parameters
        ----------
        theta_i, phi_i, theta_o, phi_o : array_like or float
            Angles, theta from -90° to 90° and phi from -360° to 360°. Numbers and arrays go
            together as NumPy broadcasts them: ``theta_i[:, None]`` and ``theta_o`` are a grid.
        values : array_like, the shape of the angles together, or that and channels
            BRDF [sr⁻¹], without a cosine; NaN where nothing was measured.
        unit : {"degrees", "radians"}, optional
            Unit of the angles: by default degrees, but it has to be said where none of the angles
            is so large that it could not be in radians.
        channels : sequence of str, optional
            What the last axis of `values` is: ``("R", "G", "B")``, linear sRGB, by default for
            three; ``("Y",)``, achromatic, for one; or wavelengths, as ``("400nm", "410nm")``.
        name : str, default "samples"
            Name in pictures and tables.
        info : dict of str to str, optional
            Notes, as ``{"instrument": "gonioreflectometer"}``.
        anisotropic : bool, optional
            Whether the BRDF changes as the surface turns about its normal; by default whether
            phi_i varies, but for full turns.
        standard_error : array_like, the shape of `values`, optional
            Standard errors of the values [sr⁻¹].

        Returns
        -------
        Measured
            The material.

        Raises
        ------
        BrdfkitError
            For angles that are not finite or below the horizon, a unit that has to be said, and
            shapes that do not fit. Rows are counted from 0, through all axes.

        Examples
        --------
        >>> theta_o = np.arange(-80, 81, 5)  # degrees, in the plane of incidence
        >>> values = 0.1 + np.exp(-(((theta_o - 30) / 5) ** 2))
        >>> print(Measured.from_angles(30, 0, theta_o, 180, values, name="mine"))
        mine: samples, 33 of 33 valid, channels Y
        """
        origin = Origin(name)
        require_unit(unit)
        given = {"theta_i": theta_i, "phi_i": phi_i, "theta_o": theta_o, "phi_o": phi_o}
        angles, shape = _broadcast(given, origin)
        units = dict.fromkeys(angles, unit)
        wi, wo = to_directions(angles, units, origin)
        values = _flatten("values", values, shape, origin)
        if standard_error is not None:
            standard_error = _flatten("standard_error", standard_error, shape, origin)
        return cls.from_samples(
            wi,
            wo,
            values,
            channels=channels,
            name=name,
            info=info,
            anisotropic=turns(angles, units) if anisotropic is None else anisotropic,
            standard_error=standard_error,
        )

    @classmethod
    def from_frame(
        cls,
        frame: Any,
        unit: str | None = None,
        name: str = "samples",
        info: Mapping[str, str] | None = None,
        anisotropic: bool | None = None,
    ) -> Self:
        """A measured BRDF from a DataFrame, or from any table of named columns.

        The names say what the columns are, as in the files that `load` reads as CSV. Directions:

        - theta_i, phi_i, theta_o, phi_o: as in `from_angles`;
        - theta_i, theta_o, delta_phi: delta_phi is phi_o - phi_i, so 180° in the mirror direction;
        - theta_h, [phi_h,] theta_d, phi_d: half and difference angles of Rusinkiewicz, as MERL's;
        - wi_x, wi_y, wi_z, wo_x, wo_y, wo_z: unit vectors, z along the normal.

        Values: R, G, B (linear sRGB), or wavelengths such as 550nm, or one column BRDF; CCBRDF,
        CCBRDF_R or CCBRDF_550nm where they are the BRDF times cos theta_o, which is divided out.
        Standard errors: R_error, 550nm_error, BRDF_error or standard_error. A unit may stand behind
        a name, as in ``theta_i [rad]``. With a column wavelength [nm], or channel of R, G and B,
        each row has the value BRDF of one.

        Parameters
        ----------
        frame : DataFrame or dict of str to array_like
            The columns, of equal lengths; a number in a dictionary is that of all rows.
        unit : {"degrees", "radians"}, optional
            Unit of angles whose names state none: by default degrees, but it has to be said where
            none of the angles is so large that it could not be in radians.
        name : str, default "samples"
            Name in pictures and tables.
        info : dict of str to str, optional
            Notes, as ``{"instrument": "gonioreflectometer"}``.
        anisotropic : bool, optional
            Whether the BRDF changes as the surface turns about its normal; by default whether the
            azimuth of the light, or of the half vector, varies.

        Returns
        -------
        Measured
            The material. Rows with a value that is not finite count as not measured.

        Raises
        ------
        BrdfkitError
            For columns that are unknown, missing or of other lengths, and for what is wrong in a
            row; rows are counted from 0.

        Examples
        --------
        >>> frame = {"theta_i": 30, "theta_o": [10, 30, 50], "delta_phi": 180, "BRDF": [1, 9, 2]}
        >>> print(Measured.from_frame(frame, name="mine"))
        mine: samples, 3 of 3 valid, channels Y
        """
        origin = Origin(name)
        names, columns = columns_of(frame, origin)
        found = to_samples(names, columns, unit, origin)
        found["info"] |= to_notes(info, name)
        if anisotropic is not None:
            found["anisotropic"] = anisotropic
        return cls.from_samples(**found, name=name)


def _broadcast(given, origin):
    """The angles `given` by name, broadcast, as arrays (n,), and their shape together before."""
    arrays = [to_numbers(name, angle, origin) for name, angle in given.items()]
    try:
        arrays = np.broadcast_arrays(*arrays)
    except ValueError:
        shapes = ", ".join(f"{n} {a.shape}" for n, a in zip(given, arrays, strict=True))
        raise origin.error(
            f"the shapes {shapes} do not go together; give numbers and arrays of one length"
        ) from None
    return dict(zip(given, map(np.ravel, arrays), strict=True)), arrays[0].shape


def _flatten(what, given, shape, origin):
    """The values `given` (*shape) as (n,), or (*shape, channels) as (n, channels)."""
    values, axes = to_numbers(what, given, origin), len(shape)
    if values.shape[:axes] != shape or values.ndim > axes + 1:
        raise origin.error(
            f"{what} {values.shape} should have the shape of the angles, {shape}, or that and "
            "channels"
        )
    return values.reshape(-1, *values.shape[axes:])
