"""What a transfer function is made of, and files of it: colour maps, opacities, JSON, presets."""

from __future__ import annotations

from os import PathLike
from typing import Any, Self

from numpy.typing import ArrayLike

from brdfkit.volumes.transfer import boundaries as boundaries_of_values
from brdfkit.volumes.transfer import colour_maps, files
from brdfkit.volumes.transfer import opacity as opacities


class Conversions:
    """The methods of `TransferFunction` that make it of something else, or a file of it."""

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
        """A transfer function with the colours of a Matplotlib colour map.

        Parameters
        ----------
        colormap : str or Colormap
            Its name, such as "viridis", or the object. Its colours, of screens, are made linear.
        values : (float, float), default (0.0, 1.0)
            The values that have its first and its last colour.
        opacity : array (k, 2), default ((0.0, 0.0), (1.0, 1.0))
            Points (share of the way from the first value to the last, A).
        extinction : float, default 1.0
            σ_t where A is 1 [1/unit of length].
        colour : str, default "emission"
            What RGB means: "albedo" or "emission".

        Returns
        -------
        TransferFunction
            With a point for each of the map's colours.

        Raises
        ------
        BrdfkitError
            For a name that Matplotlib does not know.

        Examples
        --------
        >>> TransferFunction.from_colormap("magma", (0, 255), extinction=0.1).range
        (0.0, 255.0)
        """
        return colour_maps.function(cls, colormap, values, opacity, extinction, colour)

    @classmethod
    def from_opacity(
        cls,
        values: ArrayLike,
        rgba: ArrayLike,
        *,
        unit_distance: float = 1.0,
        colour: str = "emission",
    ) -> Self:
        """A transfer function whose A are opacities `a` of a layer, as in VTK, Slicer and ParaView.

        σ_t = -ln(1 - a) / d; between the points the opacity is linear, and σ_t is not.

        Parameters
        ----------
        values : array (n,)
            Of the control points, rising, in the data's own unit.
        rgba : array (n, 4)
            Linear R, G, B, and the opacity of a layer. More than 0.9999, through which nothing
            would be seen at all, counts as that.
        unit_distance : float, default 1.0
            d: the thickness of the layer [unit of length], VTK's ScalarOpacityUnitDistance.
        colour : str, default "emission"
            What RGB means: "albedo" or "emission".

        Returns
        -------
        TransferFunction
            With more points than were given, by which σ_t is met to 1e-5 of its largest value.

        Raises
        ------
        BrdfkitError
            For points out of order, opacities beyond 0 to 1, and a distance that is not positive.

        Examples
        --------
        >>> rgba = [[1, 1, 1, 0.5], [1, 1, 1, 0.5]]
        >>> half = TransferFunction.from_opacity([0, 1], rgba, unit_distance=2)
        >>> half.extinction    # a layer of 2 lets half of the light through
        0.34657359027997264
        """
        return opacities.function(cls, values, rgba, unit_distance, colour)

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
        """A transfer function that shows the boundaries between materials as thin shells.

        Each is a triangle over values and gradient magnitudes, and no product of two ramps: it
        shows a boundary, and not a steeper one, such as skin to air, through the same values.

        Parameters
        ----------
        boundaries : array (k, 6)
            Rows (value, steepest gradient magnitude, R, G, B, A): the value is the mean of those on
            both sides; R, G, B, linear sRGB, and A are 0 to 1.
        thickness : float
            To either side of the surface [unit of length], above 0.
        values : (float, float)
            Between which the function changes.
        extinction : float, default 1.0
            σ_t where A is 1 [1/unit of length]; 3 / thickness hides what is behind.
        colour : str, default "albedo"
            What RGB means: "albedo" or "emission".

        Returns
        -------
        TransferFunction
            Of values and gradient magnitudes.

        Raises
        ------
        BrdfkitError
            For rows of other than six numbers, and numbers out of range.

        Examples
        --------
        >>> white_matter = [[190, 40, 0.97, 0.93, 0.85, 1]]
        >>> edges = TransferFunction.from_boundaries(white_matter, 1, values=(0, 255))
        >>> edges.gradient_range
        (0.0, 50.0)
        """
        return boundaries_of_values.function(cls, boundaries, thickness, values, extinction, colour)

    @classmethod
    def load(cls, path: str | PathLike[str]) -> Self:
        """The transfer function in a file, or a preset by its name.

        Parameters
        ----------
        path : str or Path
            A .json that `save` wrote; a preset of Slicer's, ``presets.xml#CT-Bone``; or the name of
            one that comes with brdfkit, such as "ct_bone".

        Returns
        -------
        TransferFunction
            What the file holds.

        Raises
        ------
        BrdfkitError
            For what cannot be read, and for an unknown name.

        Examples
        --------
        >>> TransferFunction.load("ct_bone").value_unit
        'HU'
        """
        return files.load(cls, path)

    def save(self, path: str | PathLike[str]) -> None:
        """Write the function to a .json, which `load` reads; its docstring says what is in it.

        Parameters
        ----------
        path : str or Path
            The file.

        Raises
        ------
        BrdfkitError
            Where it cannot be written.

        Examples
        --------
        >>> TransferFunction.load("ct_bone").save("bone.json")    # doctest: +SKIP
        """
        files.save(self, path)

    def to_json(self) -> str:
        """The text that `save` writes, for the parameter `transfer` of Mitsuba's plugins.

        Returns
        -------
        str
            JSON.

        Examples
        --------
        >>> volume = {"type": "transfer_function", "transfer": glass.to_json()}    # doctest: +SKIP
        """
        return files.to_json(self)
