"""Materials of fields by name, and the part of a field to which a surface point belongs.

A point of the surface belongs to the part whose growth would move the surface there. So where two
parts are blended smoothly, a point belongs to both, each with a share. The surface of a cut belongs
to the solid that was cut away.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import drjit as dr

from brdfkit.core.array_types import JitFloat, JitVector
from brdfkit.core.errors import BrdfkitError
from brdfkit.distance_fields.boxes import Box, to_floats
from brdfkit.distance_fields.node import Node
from brdfkit.distance_fields.shapes.motions import Motion
from brdfkit.distance_fields.shapes.offsets import dilate


def _check_material_name(what: str, value: Any, rules: Mapping[str, Any]) -> str:
    """Return the name of a material; raise `BrdfkitError` unless it is an identifier.

    what : name of the parameter, for the error message.
    """
    if not isinstance(value, str) or not value.isidentifier():
        raise BrdfkitError(f"{what} = {value!r} should be a name, such as gold or wood_2.")
    return value


@dataclass(frozen=True, eq=False, repr=False)
class made_of(Motion):
    """A solid with the name of its material, by which a renderer finds the BSDF.

    Parameters
    ----------
    child : distance field
        The solid, which must not contain parts with names already.
    material : str
        The name of the material: letters, digits and _.
    """

    child: Node
    material: str = field(metadata={"check": _check_material_name, "fixed": True})

    def __post_init__(self) -> None:
        super().__post_init__()
        for name in list_material_names(self.child):
            raise BrdfkitError(
                f"made_of: the solid made of {self.material!r} has a part made of {name!r} "
                "already; name each part once."
            )

    def distance(self, p: JitVector) -> JitFloat:
        return self.child.distance(p)

    def bounds(self, level: float = 0.0) -> Box:
        return self.child.bounds(level)


def list_material_names(node: Node) -> list[str]:
    """Return the names of all materials in a field, sorted."""
    if isinstance(node, made_of):
        return [node.material]
    return sorted({name for child in node.children for name in list_material_names(child)})


def grow_material(node: Any, material: str, growth: float) -> Any:
    """Return the field with all parts of a `material` grown by the small length `growth`."""
    if node.kind == "made_of":
        return dilate(node.child, growth) if node.material == material else node
    if node.kind == "scale":
        growth = growth / to_floats(node.factor)
    if hasattr(node, "child"):
        return replace(node, child=grow_material(node.child, material, growth))
    if node.children:
        children = tuple(grow_material(child, material, growth) for child in node.children)
        return replace(node, children=children)
    return node


def material_share(node: Node, larger: Node, p: JitVector, growth: float) -> JitFloat:
    """Return the share, 0 to 1, of the surface at `p` that belongs to a material.

    larger : the field with the parts of that material grown by `growth`, see `grow_material`.
    """
    return dr.abs(larger.distance(p) - node.distance(p)) / growth
