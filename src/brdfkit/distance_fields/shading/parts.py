"""The BSDF of each part of a field, found by the name of the part's material."""

import warnings
from collections.abc import Mapping

import drjit as dr
import numpy as np

from brdfkit.core.array_types import JitVector, MitsubaObject
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.jit.padding import pad
from brdfkit.distance_fields.materials import grow_material, list_material_names, material_share
from brdfkit.distance_fields.node import Node


def make_differentiable_parameters(node: Node) -> dict[str, MitsubaObject]:
    """Return all parameters of a field by name, as `mi.Float`, `mi.Vector3f` or `mi.TensorXf`.

    They are opaque, so that one kernel serves all values. The `blend` of a sharp combination is
    left out, so that it stays sharp.
    """
    import mitsuba as mi

    parameters: dict[str, MitsubaObject] = {}
    for name, value in node.parameters().items():
        if name.endswith(".blend") and value == 0:
            continue
        if isinstance(value, tuple):
            parameters[name] = mi.Vector3f(*(float(v) for v in value))
        elif np.ndim(value) == 3:
            flat = pad(np.ravel(value).astype(np.float32))
            parameters[name] = mi.TensorXf(mi.Float(flat), np.shape(value))
        else:
            parameters[name] = mi.Float(float(value))
    dr.make_opaque(parameters)
    return parameters


class Parts:
    """The BSDFs of the parts of a field.

    named : name of a material → BSDF of the parts with this name.
    other : the BSDF of all parts without a name.
    growth : length by which parts are grown to find the one that a point belongs to: less than all
        details, but more than the rounding errors of single precision [unit of length].
    """

    def __init__(
        self, named: Mapping[str, MitsubaObject], other: MitsubaObject, growth: float
    ) -> None:
        self.named, self.other, self.growth = named, other, growth

    def grow_each_material(self, field: Node) -> dict[str, Node]:
        """Return, for each material by name, the field with its parts grown by `growth`."""
        return {name: grow_material(field, name, self.growth) for name in self.named}

    def find_bsdf(self, field: Node, larger: Mapping[str, Node], p: JitVector) -> MitsubaObject:
        """Return the `mi.BSDFPtr` of the part with the largest share of each surface point `p`.

        larger : the result of `grow_each_material` for this field.
        """
        import mitsuba as mi

        with dr.suspend_grad():
            shares = {
                name: material_share(field, each, p, self.growth) for name, each in larger.items()
            }
            bsdf, most = mi.BSDFPtr(self.other), 1 - sum(shares.values(), mi.Float(0))
            for name, here in shares.items():
                bsdf = dr.select(here > most, mi.BSDFPtr(self.named[name]), bsdf)
                most = dr.maximum(here, most)
        return bsdf


def match_bsdfs(field: Node, bsdfs: Mapping[str, MitsubaObject], growth: float) -> Parts:
    """Return the `Parts` of a field with the BSDFs of a scene, matched by name.

    A BSDF whose name belongs to no part is for all unnamed parts; without it they are Mitsuba's
    `diffuse`. A name without a BSDF and a superfluous BSDF raise `BrdfkitError`; a BSDF that
    transmits light causes a warning.
    """
    import mitsuba as mi

    names = list_material_names(field)
    for name, bsdf in bsdfs.items():
        if not isinstance(bsdf, mi.BSDF):
            raise BrdfkitError(f"distance_field: {name} is not a bsdf; remove it.")
        if mi.has_flag(bsdf.flags(), mi.BSDFFlags.Transmission):
            warnings.warn(
                f"distance_field: the bsdf {name} lets light through, but only the light that it "
                "reflects is shown; give an opaque one, such as plastic or roughconductor, and cut "
                "holes into the field itself, a - b.",
                stacklevel=2,
            )
    for name in names:
        if name not in bsdfs:
            raise BrdfkitError(
                f"distance_field: a part of the field is made of {name!r}; give a bsdf of this "
                "name."
            )
    others = [name for name in bsdfs if name not in names]
    if len(others) > 1:
        raise BrdfkitError(
            f"distance_field: the bsdfs {', '.join(others)} belong to no part of the field; name "
            "parts by field.made_of(NAME), and give one bsdf at most for all others."
        )
    other = bsdfs[others[0]] if others else mi.load_dict({"type": "diffuse"})
    return Parts({name: bsdfs[name] for name in names}, other, growth)
