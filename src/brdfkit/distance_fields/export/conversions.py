"""What a distance field becomes: JSON, a file, GLSL, a grid, a mesh."""

from os import PathLike
from typing import Any


class Conversions:
    """The methods of fields that make something else of them."""

    def to_json(self) -> str:
        """The field as JSON, of which `from_json` makes it again."""
        from brdfkit.distance_fields.export.json_files import to_json

        return to_json(self)

    def save(self, path: str | PathLike[str]) -> None:
        """Write the field to a file as JSON, which `load` reads; not nodes of the user's own."""
        from brdfkit.distance_fields.export.json_files import save

        save(self, path)

    def to_glsl(self, name: str = "field") -> str:
        """The field as ``float NAME(vec3 p)`` of GLSL."""
        from brdfkit.distance_fields.export.glsl import to_glsl

        return to_glsl(self, name)

    def to_grid(self, resolution: int = 64, bounds: Any = None) -> Any:
        """The field sampled on cubic cells, `resolution` of them along the longest edge of its box.

        The box is that of the surface and a margin, or `bounds`, (low, high). The grid differs
        from the field by at most ``field.lipschitz * grid.half_diagonal``.
        """
        from brdfkit.distance_fields.export.sampling import to_grid

        return to_grid(self, resolution, bounds)

    def to_mesh(self, resolution: int = 64, bounds: Any = None) -> Any:
        """The surface as triangles: `brdfkit.distance_fields.to_mesh`."""
        from brdfkit.distance_fields.export.mesh import to_mesh

        return to_mesh(self, resolution, bounds)
