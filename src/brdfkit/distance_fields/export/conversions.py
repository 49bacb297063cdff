"""Methods that convert a distance field to JSON, a file, GLSL, a grid or a mesh."""

import re
from os import PathLike
from typing import Any

from brdfkit.core.errors import BrdfkitError
from brdfkit.distance_fields import symbols
from brdfkit.distance_fields.functions import Point
from brdfkit.distance_fields.symbols import Program, Symbol

TEXTURE = "uniform sampler3D grid_{number};  // values {shape} of x, y, z, not filtered"


class Conversions:
    """The methods of `Node` that convert a distance field to other representations."""

    def to_json(self) -> str:
        """Return the field as JSON, which `from_json` reads."""
        from brdfkit.distance_fields.export.json_files import to_json

        return to_json(self)

    def save(self, path: str | PathLike[str]) -> None:
        """Write the field to a JSON file, which `load` reads; user-defined nodes are an error."""
        from brdfkit.distance_fields.export.json_files import save

        save(self, path)

    def to_glsl(self, name: str = "field") -> str:
        """Return the field as the GLSL function ``float NAME(vec3 p)``, one operation per line.

        It needs GLSL 1.30 or ES 3.00. Values of grids are read from textures ``grid_0``,
        ``grid_1``, ...
        """
        if not re.fullmatch(r"(?!gl_)[A-Za-z]\w*", name):
            raise BrdfkitError(f"name = {name!r} should be a word of letters and digits, for GLSL.")
        program = Program()
        p = Point(*(Symbol(program, f"p.{axis}") for axis in "xyz"))
        result = self.distance(p)  # type: ignore[attr-defined]  # its subclass `Node` has it
        textures = [
            TEXTURE.format(number=n, shape="×".join(map(str, grid.counts)))
            for n, grid in enumerate(program.grids)
        ]
        lines = (*program.lines, f"return {symbols.to_glsl(result)};")
        body = [f"    {line}" for line in lines]
        return "\n".join([*textures, f"float {name}(vec3 p) {{", *body, "}", ""])

    def to_grid(self, resolution: int = 64, bounds: Any = None) -> Any:
        """Return the field sampled on cubic cells, `resolution` of them along the longest edge.

        The box is `bounds`, (low, high), or the surface's own box with a margin. The grid differs
        from the field by at most ``field.lipschitz * grid.half_diagonal``.
        """
        from brdfkit.distance_fields.export.sampling import to_grid

        return to_grid(self, resolution, bounds)

    def to_mesh(self, resolution: int = 64, bounds: Any = None) -> Any:
        """Return the surface as triangles; see `brdfkit.distance_fields.to_mesh`."""
        from brdfkit.distance_fields.export.mesh import to_mesh

        return to_mesh(self, resolution, bounds)
