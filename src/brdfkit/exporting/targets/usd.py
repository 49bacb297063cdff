"""USD: a ball with a material, whose MaterialX network is that of the target `materialx`.

Renderers that do not know MaterialX draw a UsdPreviewSurface instead: the diffuse term and the
brightest highlight, made isotropic, in colours to 1. For all others holds what `materialx` says.
x is the primvar `tangents`, which follows u.
"""

from pathlib import Path
from typing import Any

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.exporting.ball_mesh import make_ball
from brdfkit.exporting.filling import to_identifier, write_template
from brdfkit.exporting.ggx_sum import BLACK, GgxLobe, GgxSum
from brdfkit.exporting.network import NOTE, VERSION, Node, make_network
from brdfkit.exporting.target import Held, Target, hold_ggx_sum

# Types of inputs, and forms of their values, by MaterialX's types
TYPES = {"color3": "color3f", "vector2": "float2", "BSDF": "token"}
FORMS = {"color3": " = ({})", "vector2": " = ({})", "string": ' = "{}"'}


def write(held: Held, path: Path, comment: list[str]) -> list[Path]:
    """Write the ball and its material."""
    ball, name = make_ball(), to_identifier(path.stem)
    material = f"/{name}/Material"
    write_template(
        "material.usda.jinja",
        path,
        name=name,
        material=material,
        version=VERSION,
        shaders=[_to_shader(node, material) for node in make_network(held.content)],
        preview=_make_preview(held.content),
        points=_write_rows(ball.points),
        tangents=_write_rows(ball.tangents),
        uv=_write_rows(ball.uv),
        triangles=", ".join(map(str, ball.triangles.ravel())),
        triangle_count=len(ball.triangles),
        comment=[*comment, *NOTE],
    )
    return [path]


def _to_shader(node: Node, material: str) -> dict[str, Any]:
    """Return the name, the identifier and the lines of inputs of a node in a `material`."""
    lines = []
    for entry in node.inputs:
        connection = f".connect = <{material}/{entry.text}.outputs:out>"
        form = connection if entry.is_node else FORMS.get(entry.type, " = {}").format(entry.text)
        lines.append(f"{TYPES.get(entry.type, entry.type)} inputs:{entry.name}{form}")
    kind = "add_bsdf" if node.kind == "add" else node.kind
    return {"name": node.name, "id": f"ND_{kind}", "inputs": lines}


def _make_preview(content: GgxSum) -> dict[str, Any]:
    """Return the values of the preview surface."""
    brightest = max(content.lobes, key=lambda j: sum(j.f0), default=GgxLobe(1, 1, BLACK, BLACK))
    return {
        "diffuse": np.minimum(content.diffuse, 1),
        "specular": np.minimum(brightest.f0, 1),
        "roughness": min((brightest.alpha_u * brightest.alpha_v) ** 0.25, 1),
    }


def _write_rows(values: FloatArray) -> str:
    """Return vectors as an array of USD."""
    rounded = np.round(values, 6) + 0.0  # + 0: never -0
    rows = (", ".join(f"{x:.6g}" for x in row) for row in rounded.tolist())
    return f"[{', '.join(f'({row})' for row in rows)}]"


TARGET = Target(
    name="usd",
    title="USD: a ball, with MaterialX's nodes and a preview",
    suffix=".usda",
    holds={
        "diffuse": "Lambert",
        "highlights": "GGX, any number, any colour",
        "anisotropy": "yes",
        "else": "nothing",
    },
    hold=hold_ggx_sum,
    write=write,
)
