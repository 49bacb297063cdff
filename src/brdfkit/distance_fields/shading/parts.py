"""The BSDF of each part of a field, by the name of its material."""

import warnings

import drjit as dr
import numpy as np

from brdfkit.core.errors import BrdfkitError
from brdfkit.core.jit.padding import pad
from brdfkit.distance_fields.materials import grown, material_names, share


def exposed(node):
    """Name → array of every parameter of a field: `mi.Float`, `mi.Vector3f` or `mi.TensorXf`.

    They are opaque: a kernel holds for all of their values. A combination that is sharp stays so:
    its `blend` is left out.
    """
    import drjit as dr
    import mitsuba as mi

    found = {}
    for name, value in node.parameters().items():
        if name.endswith(".blend") and value == 0:
            continue
        if isinstance(value, tuple):
            found[name] = mi.Vector3f(*(float(v) for v in value))
        elif np.ndim(value) == 3:
            flat = pad(np.ravel(value).astype(np.float32))
            found[name] = mi.TensorXf(mi.Float(flat), np.shape(value))
        else:
            found[name] = mi.Float(float(value))
    dr.make_opaque(found)
    return found


class Parts:
    """The BSDFs of a field: `named`, name → BSDF, and `other`, that of all else.

    growth : less than all details [unit], and more than what single precision rounds.
    """

    def __init__(self, named, other, growth):
        self.named, self.other, self.growth = named, other, growth

    def larger(self, field):
        """Name → the field with the parts of this name grown, which `bsdf` needs."""
        return {name: grown(field, name, self.growth) for name in self.named}

    def bsdf(self, field, larger, p):
        """The `mi.BSDFPtr` at points of the surface: of the part with the largest share."""
        import mitsuba as mi

        with dr.suspend_grad():
            shares = {n: share(field, each, p, self.growth) for n, each in larger.items()}
            found, most = mi.BSDFPtr(self.other), 1 - sum(shares.values(), mi.Float(0))
            for name, here in shares.items():
                found = dr.select(here > most, mi.BSDFPtr(self.named[name]), found)
                most = dr.maximum(here, most)
        return found


def parts_of(field, bsdfs, growth):
    """The `Parts` of a field, of the BSDFs that a scene gives: name → BSDF.

    One whose name is that of no part is for all parts without a name; where there is none, they are
    Mitsuba's `diffuse`. Raises `BrdfkitError` for a name without a BSDF, and for too many BSDFs;
    warns of those that let light through.
    """
    import mitsuba as mi

    names = material_names(field)
    for name, thing in bsdfs.items():
        if not isinstance(thing, mi.BSDF):
            raise BrdfkitError(f"distance_field: {name} is no bsdf; only bsdfs belong here.")
        if mi.has_flag(thing.flags(), mi.BSDFFlags.Transmission):
            warnings.warn(
                f"distance_field: the bsdf {name} lets light through, but only what it reflects is "
                "shown, the rest is dark; give one that is opaque, as plastic or roughconductor, "
                "and cut holes into the field itself, a - b.",
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
