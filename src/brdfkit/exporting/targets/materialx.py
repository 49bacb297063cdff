"""MaterialX: nodes of its standard library, added up, or OpenPBR's surface.

A sum is exact by the standard's formula, which MaterialX's OSL has. Viewers that draw with the GLSL
that MaterialX generates differ in two ways: each highlight is multiplied by 1 + F (1 - E) / E, E
being its albedo for F = 1, and G is the isotropic one of √(α_u α_v). In the median over pairs of
directions, a metal of α = 0.2 is 6 % brighter, and a brushed one of 0.12 and 0.45 by 9 %, where
single pairs are from 7 % darker to 50 % brighter; balls of both differ by a mean ΔE of 1.8, and one
of a plastic by 0.04.

Of `openpbr`: renderers darken what lies below a layer by the direction of the viewer alone, where
the model takes both: the mean ΔE of a plastic's ball is 0.3, of a coated one's 0.7. The loss tells
that, and MaterialX's GLSL draws what was told, to 0.3 % of both for nine in ten pairs. x is the
mesh's tangent.
"""

from pathlib import Path

from brdfkit.exporting.filling import to_identifier, write_template
from brdfkit.exporting.network import HOLDS, VERSION, describe_viewers, hold, make_network
from brdfkit.exporting.target import Held, Target


def write(held: Held, path: Path, comment: list[str]) -> list[Path]:
    """Write the material, whose name is the file's."""
    write_template(
        "materialx.mtlx.jinja",
        path,
        name=to_identifier(path.stem),
        version=VERSION,
        nodes=make_network(held.content),
        comment=[*comment, *describe_viewers(held.content)],
    )
    return [path]


TARGET = Target(
    name="materialx",
    title=f"MaterialX {VERSION}, for many programs",
    suffix=".mtlx",
    holds=HOLDS,
    hold=hold,
    write=write,
)
