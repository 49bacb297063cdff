"""A distance field as a function of GLSL, written by its own formulas given symbols for numbers."""

import re

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
