"""The material of a solid, by a name, and which part of a field the surface at a point belongs to.

It belongs to the part that would move it there if it grew. So a point where two parts are blended
smoothly belongs to both, with shares; a cut belongs to what was cut off.
"""

from dataclasses import dataclass, field, replace

import drjit as dr

from brdfkit.core.errors import BrdfkitError
from brdfkit.distance_fields.boxes import plain
from brdfkit.distance_fields.node import Node
from brdfkit.distance_fields.shapes.motions import Motion
from brdfkit.distance_fields.shapes.offsets import dilate


def _name(what, value, rules):
    if not isinstance(value, str) or not value.isidentifier():
        raise BrdfkitError(f"{what} = {value!r} should be a name, such as gold or wood_2.")
    return value


@dataclass(frozen=True, eq=False, repr=False)
class made_of(Motion):
    """A solid with the name of its material, by which a renderer finds its BSDF.

    Parameters
    ----------
    child : distance field
        The solid, with no named parts within.
    material : str
        The name: letters, digits and _.
    """

    child: Node
    material: str = field(metadata={"check": _name, "fixed": True})

    def __post_init__(self):
        super().__post_init__()
        for name in material_names(self.child):
            raise BrdfkitError(
                f"made_of: the solid made of {self.material!r} has a part made of {name!r} "
                "already; name each part once."
            )

    def distance(self, p):
        return self.child.distance(p)

    def bounds(self, level=0.0):
        return self.child.bounds(level)


def material_names(node):
    """The names of all materials in a field, sorted."""
    if node.kind == "made_of":
        return [node.material]
    return sorted({name for child in node.children for name in material_names(child)})


def grown(node, material, growth):
    """The field with all parts of a `material` grown by a little, `growth`."""
    if node.kind == "made_of":
        return dilate(node.child, growth) if node.material == material else node
    if node.kind == "scale":
        growth = growth / plain(node.factor)
    if hasattr(node, "child"):
        return replace(node, child=grown(node.child, material, growth))
    if node.children:
        children = tuple(grown(child, material, growth) for child in node.children)
        return replace(node, children=children)
    return node


def share(node, larger, p, growth):
    """How much of the surface at p, 0 to 1, belongs to what is `grown` in the field `larger`."""
    return dr.abs(larger.distance(p) - node.distance(p)) / growth
