"""USD: a ball with a material, whose MaterialX network is that of the target `materialx`.

Renderers that do not know MaterialX draw a UsdPreviewSurface instead: the diffuse term and the
brightest highlight of a sum, made isotropic, in colours to 1, and what it has of `openpbr`. For all
others holds what `materialx` says. x is the primvar `tangents`, which follows u.
"""

from pathlib import Path
from typing import Any

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.exporting.ball_mesh import make_ball
from brdfkit.exporting.filling import to_identifier, write_template
from brdfkit.exporting.ggx_sum import BLACK, GgxLobe, GgxSum
from brdfkit.exporting.network import HOLDS, VERSION, Node, describe_viewers, hold, make_network
from brdfkit.exporting.openpbr import to_inputs
from brdfkit.exporting.target import Held, Target
from brdfkit.model import Model

# Types of inputs, and forms of their values, by MaterialX's types
TYPES = {"color3": "color3f", "vector2": "float2", "vector3": "float3", "BSDF": "token"}
SUFFIXED = {  # names of nodes' definitions, where they are more than the category
    "add": "add_bsdf",
    "bitangent": "bitangent_vector3",
    "open_pbr_surface": "open_pbr_surface_surfaceshader",
}
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
        comment=[*comment, *describe_viewers(held.content)],
    )
    return [path]


def _to_shader(node: Node, material: str) -> dict[str, Any]:
    """Return the name, the identifier and the lines of inputs of a node in a `material`."""
    lines = []
    for entry in node.inputs:
        connection = f".connect = <{material}/{entry.text}.outputs:out>"
        form = connection if entry.is_node else FORMS.get(entry.type, " = {}").format(entry.text)
        lines.append(f"{TYPES.get(entry.type, entry.type)} inputs:{entry.name}{form}")
    return {
        "name": node.name,
        "id": f"ND_{SUFFIXED.get(node.kind, node.kind)}",
        "type": TYPES.get(node.type, "token"),
        "inputs": lines,
    }


def _make_preview(content: GgxSum | Model) -> dict[str, Any]:
    """Return the values of the preview surface, by the declarations of its inputs."""
    if isinstance(content, Model):
        values = to_inputs(content)
        return {
            "color3f inputs:diffuseColor": values["base_color"],
            "float inputs:metallic": values["base_metalness"],
            "float inputs:roughness": values["specular_roughness"],
            "float inputs:ior": values["specular_ior"],
            "float inputs:clearcoat": values["coat_weight"],
            "float inputs:clearcoatRoughness": values["coat_roughness"],
        }
    brightest = max(content.lobes, key=lambda j: sum(j.f0), default=GgxLobe(1, 1, BLACK, BLACK))
    return {
        "color3f inputs:diffuseColor": np.minimum(content.diffuse, 1).tolist(),
        "float inputs:roughness": min((brightest.alpha_u * brightest.alpha_v) ** 0.25, 1),
        "color3f inputs:specularColor": np.minimum(brightest.f0, 1).tolist(),
        "int inputs:useSpecularWorkflow": 1,
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
    holds=HOLDS,
    hold=hold,
    write=write,
)
