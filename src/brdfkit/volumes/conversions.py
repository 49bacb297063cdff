"""What a transfer function is made of, and files of it: colour maps, opacities, JSON, presets."""

from os import PathLike
from typing import Any, Self

from numpy.typing import ArrayLike

from brdfkit.volumes import colour_maps, stored
from brdfkit.volumes import opacity as opacities


class Conversions:
    """The methods of `TransferFunction` that make it of something else, or a file of it."""

    @classmethod
    def from_colormap(
        cls,
        colormap: str | Any,
        values: tuple[float, float] = (0.0, 1.0),
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
        >>> half = TransferFunction.from_opacity([0, 1], [[1, 1, 1, 0.5], [1, 1, 1, 0.5]], 2)
        >>> half.extinction    # a layer of 2 lets half of the light through
        0.34657359027997264
        """
        return opacities.function(cls, values, rgba, unit_distance, colour)

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
        return stored.load(cls, path)

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
        stored.save(self, path)

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
        return stored.to_json(self)
