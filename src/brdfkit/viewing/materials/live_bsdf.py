"""`LiveBsdf`: the BSDF of a material, whose parameters change without a new kernel.

A kernel depends on the types of a BSDF's textures, and on numbers that are written into it. So the
BSDF of a model has a colour for every weight and a number for every other parameter, also for one
that equals another one, and new values are inputs of the kernel.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from brdfkit.core.array_types import MitsubaObject
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.jit.llvm import use_variant
from brdfkit.materials.resolve import Material
from brdfkit.model import Model
from brdfkit.rendering.scene_input.material import load_material


class LiveBsdf:
    """A material's BSDF in Mitsuba.

    Attributes
    ----------
    material : Measured, Model or another material
        The material as it is shown now.
    front : mitsuba.BSDF
        The BSDF, which reflects at the front of surfaces.
    """

    def __init__(self, material: Material) -> None:
        import mitsuba as mi

        use_variant()
        self.material = material
        self.parameters: Any = None
        if isinstance(material, Model):
            self.material = shown = material.rgb
            self.front = load_material(describe_model(shown), shown.name)
            self.parameters = mi.traverse(self.front)
            for name in shown.parameters:
                self._assign(name, getattr(shown, name))
            self.parameters.update()
        else:
            # Not from the cache of previews, because a path tracer's kernel has the code of every
            # kind of BSDF that is alive, and a new set of them would be compiled for seconds
            self.front = load_material(material.scene_dict(), material.name)
        self._both: MitsubaObject = None

    @property
    def both_sides(self) -> MitsubaObject:
        """The BSDF for meshes, which reflects at both sides of surfaces."""
        import mitsuba as mi

        if self._both is None:
            transmits = mi.has_flag(self.front.flags(), mi.BSDFFlags.Transmission)
            two = {"type": "twosided", "bsdf": self.front}
            self._both = self.front if transmits else mi.load_dict(two, parallel=False)
        return self._both

    def show(self, material: Material) -> bool:
        """Show a model with other values; return whether any value has changed.

        Raises `BrdfkitError` for another material than the one that the BSDF was made of.
        """
        shown: Any = self.material
        if material is shown:
            return False
        if not isinstance(material, Model) or type(material) is not type(shown):
            raise BrdfkitError(f"{material.name} is another material than {shown.name}.")
        new = material.rgb
        changed = [n for n in new.parameters if getattr(new, n) != getattr(shown, n)]
        for name in changed:
            self._assign(name, getattr(new, name))
        if changed:
            self.parameters.update()
        self.material = new
        return bool(changed)

    def _assign(self, name: str, value: Any) -> None:
        """Assign the value of a parameter as an input of kernels."""
        import drjit as dr

        key = f"{name}.value"
        kind = type(self.parameters[key])
        numbers = np.broadcast_to(value, 3) if dr.size_v(kind) == 3 else [np.mean(value)]
        opaque = kind(*map(float, numbers))
        dr.make_opaque(opaque)
        self.parameters[key] = opaque


def describe_model(model: Model) -> dict[str, Any]:
    """Return the dictionary of a model's BSDF, with an entry for every parameter.

    Weights are colours even where all channels are equal.
    """
    entries = model.scene_dict()
    for name, parameter in model.parameters.items():
        value: Any = getattr(model, name)
        if parameter.linear:
            value = {"type": "rgb", "value": np.broadcast_to(value, 3).tolist()}
        entries[name] = value
    return entries
