"""`Conversions`: the methods of `TransferFunction` that make it from other data or a file."""

from __future__ import annotations

from os import PathLike
from typing import Any, Self

from brdfkit.core.array_types import ArrayLike
from brdfkit.volumes.transfer import files
from brdfkit.volumes.transfer.boundaries import convert_boundaries
from brdfkit.volumes.transfer.colour_maps import convert_colormap
from brdfkit.volumes.transfer.opacity import convert_opacities


class Conversions:
    """Base class of `TransferFunction`: makes it from colour maps and the like, saves, loads."""

    @classmethod
    def from_colormap(
        cls,
        colormap: str | Any,
        values: tuple[float, float] = (0.0, 1.0),
        *,
        opacity: ArrayLike = ((0.0, 0.0), (1.0, 1.0)),
        extinction: float = 1.0,
        colour: str = "emission",
    ) -> Self:
        """Make a transfer function with the colours of a Matplotlib colour map.

        Parameters
        ----------
        colormap : str or Colormap
            The map or its name, such as "viridis". Its sRGB colours are made linear.
        values : (float, float), default (0.0, 1.0)
            The values that have the map's first and last colour.
        opacity : array (k, 2), default ((0.0, 0.0), (1.0, 1.0))
            Points (share, A): the share of the way from the first to the last value, and A there.
        extinction : float, default 1.0
            The extinction where A is 1 [1/unit of length].
        colour : str, default "emission"
            The meaning of RGB, "albedo" or "emission".

        Returns
        -------
        TransferFunction
            The function, with a point for each of the map's colours.

        Raises
        ------
        BrdfkitError
            If Matplotlib has no such map, or numbers are out of order or out of range.

        Examples
        --------
        >>> TransferFunction.from_colormap("magma", (0, 255), extinction=0.1).range
        (0.0, 255.0)
        """
        return convert_colormap(cls, colormap, values, opacity, extinction, colour)

    @classmethod
    def from_opacity(
        cls,
        values: ArrayLike,
        rgba: ArrayLike,
        *,
        unit_distance: float = 1.0,
        colour: str = "emission",
    ) -> Self:
        """Make a transfer function from opacities of a layer, as in VTK, Slicer and ParaView.

        A layer of thickness d with the opacity a has the extinction σ_t = -ln(1 - a) / d. Between
        the points the opacity is linear, and σ_t is not.

        Parameters
        ----------
        values : array (n,)
            The values of the control points, rising, in the data's own unit.
        rgba : array (n, 4)
            Linear R, G, B, and the opacity of a layer. An opacity above 0.9999 counts as 0.9999,
            since that of 1 would have an infinite extinction.
        unit_distance : float, default 1.0
            The thickness d of the layer [unit of length], VTK's ScalarOpacityUnitDistance.
        colour : str, default "emission"
            The meaning of RGB, "albedo" or "emission".

        Returns
        -------
        TransferFunction
            The function, with additional points that reproduce σ_t to 1e-5 of its largest value.

        Raises
        ------
        BrdfkitError
            If points are out of order, an opacity is not 0 to 1, or the distance is not positive.

        Examples
        --------
        >>> rgba = [[1, 1, 1, 0.5], [1, 1, 1, 0.5]]
        >>> half = TransferFunction.from_opacity([0, 1], rgba, unit_distance=2)
        >>> half.extinction    # a layer of thickness 2 transmits half of the light
        0.34657359027997264
        """
        return convert_opacities(cls, values, rgba, unit_distance, colour)

    @classmethod
    def from_boundaries(
        cls,
        boundaries: ArrayLike,
        thickness: float,
        *,
        values: tuple[float, float],
        extinction: float = 1.0,
        colour: str = "albedo",
    ) -> Self:
        """Make a transfer function that shows the boundaries between materials as thin shells.

        Each boundary is a triangle in the plane of values and gradient magnitudes, so that steeper
        boundaries through the same values, such as from skin to air, do not show.

        Parameters
        ----------
        boundaries : array (k, 6)
            Rows (value, steepest gradient magnitude, R, G, B, A). The value is the mean of the
            values on both sides; R, G, B (linear sRGB) and A are 0 to 1.
        thickness : float
            Thickness to either side of the surface [unit of length], above 0.
        values : (float, float)
            The values between which the function changes.
        extinction : float, default 1.0
            The extinction where A is 1 [1/unit of length]; 3 / thickness hides what is behind.
        colour : str, default "albedo"
            The meaning of RGB, "albedo" or "emission".

        Returns
        -------
        TransferFunction
            A function of values and gradient magnitudes.

        Raises
        ------
        BrdfkitError
            If a row does not have six numbers, or a number is out of range.

        Examples
        --------
        >>> white_matter = [[190, 40, 0.97, 0.93, 0.85, 1]]
        >>> edges = TransferFunction.from_boundaries(white_matter, 1, values=(0, 255))
        >>> edges.gradient_range
        (0.0, 50.0)
        """
        return convert_boundaries(cls, boundaries, thickness, values, extinction, colour)

    @classmethod
    def load(cls, path: str | PathLike[str]) -> Self:
        """Load the transfer function in a file, or a preset by its name.

        Parameters
        ----------
        path : str or Path
            A .json file that `save` wrote; a preset of Slicer's, ``presets.xml#CT-Bone``; or the
            name of a shipped preset, such as "ct_bone".

        Returns
        -------
        TransferFunction
            The function.

        Raises
        ------
        BrdfkitError
            If the file cannot be read, or the name is unknown.

        Examples
        --------
        >>> TransferFunction.load("ct_bone").value_unit
        'HU'
        """
        return files.load_transfer_function(cls, path)

    def save(self, path: str | PathLike[str]) -> None:
        """Write the function to a .json file, which `load` reads.

        Parameters
        ----------
        path : str or Path
            The file.

        Raises
        ------
        BrdfkitError
            If the file cannot be written.

        Examples
        --------
        >>> TransferFunction.load("ct_bone").save("bone.json")    # doctest: +SKIP
        """
        files.save_transfer_function(self, path)

    def to_json(self) -> str:
        """Return the text that `save` writes, for the parameter `transfer` of Mitsuba's plugins.

        Returns
        -------
        str
            The JSON text.

        Examples
        --------
        >>> volume = {"type": "transfer_function", "transfer": glass.to_json()}    # doctest: +SKIP
        """
        return files.format_json(self)
