"""What a distance field becomes: JSON, a file, GLSL, a grid, a mesh."""

import re
from os import PathLike
from typing import Any

from brdfkit.core.errors import BrdfkitError
from brdfkit.distance_fields.functions import Point
from brdfkit.distance_fields.symbols import Program, Symbol, text

HEAD = "uniform sampler3D grid_{number};  // values {shape} of x, y, z, not filtered"


def to_glsl(node, name="field"):
    """The text of ``float NAME(vec3 p)``, of GLSL 1.30 or ES 3.00 on, one operation a line.

    Values of grids are read from textures ``grid_0``, ``grid_1``, ...
    """
    if not re.fullmatch(r"(?!gl_)[A-Za-z]\w*", name):
        raise BrdfkitError(f"name = {name!r} should be a word of letters and digits, for GLSL.")
    program = Program()
    result = node.distance(Point(*(Symbol(program, f"p.{axis}") for axis in "xyz")))
    heads = [
        HEAD.format(number=n, shape="×".join(map(str, grid.counts)))
        for n, grid in enumerate(program.grids)
    ]
    body = [f"    {line}" for line in (*program.lines, f"return {text(result)};")]
    return "\n".join([*heads, f"float {name}(vec3 p) {{", *body, "}", ""])


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
