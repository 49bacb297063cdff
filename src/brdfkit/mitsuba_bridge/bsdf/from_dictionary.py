"""A BSDF of Mitsuba, given by its dictionary, as a material that is evaluated like a model."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from brdfkit.core.array_types import AnyArray, ArrayLike, MitsubaObject
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.jit.llvm import use_variant
from brdfkit.core.jit.threads import in_turn
from brdfkit.mitsuba_bridge.properties.picture_file import load_by_mitsuba


@dataclass(frozen=True, eq=False)
class BsdfMaterial:
    """A BSDF of Mitsuba as a material with a `name`; `entries` is its dictionary for `load_dict`.

    >>> BsdfMaterial("grey", {"type": "diffuse"}).eval(up, up)    # doctest: +SKIP
    array([[0.15915494, 0.15915494, 0.15915494]])
    """

    name: str
    entries: dict[str, Any]

    @classmethod
    def from_dictionary(cls, entries: dict[str, Any]) -> BsdfMaterial:
        """Make the material from Mitsuba's dictionary; its name is the entry "name" or else "type".

        Raises `BrdfkitError` for a dictionary without "type".
        """
        if "type" not in entries:
            raise BrdfkitError(f'{entries!r} is the dictionary of no BSDF: it has no "type".')
        bsdf = dict(entries)
        return cls(str(bsdf.pop("name", bsdf["type"])), bsdf)

    def scene_dict(self) -> dict[str, Any]:
        """Return the BSDF's dictionary for `mitsuba.load_dict`."""
        return dict(self.entries)

    @in_turn
    def eval(self, wi: ArrayLike, wo: ArrayLike) -> AnyArray:
        """Compute the BRDF (n, channels) in sr⁻¹ at direction pairs (n, 3), in single precision.

        Raises `BrdfkitError` in a spectral or scalar variant of Mitsuba.
        """
        import mitsuba as mi

        if use_variant().startswith("scalar") or mi.is_spectral:
            raise BrdfkitError(
                f"{self.name}: a BSDF of Mitsuba's is not evaluated in the variant {mi.variant()}; "
                "set llvm_ad_rgb or cuda_ad_rgb."
            )
        return eval_bsdf(load_by_mitsuba(mi.load_dict, self.entries, self.name), wi, wo)


def eval_bsdf(bsdf: MitsubaObject, wi: ArrayLike, wo: ArrayLike, types: Any = None) -> AnyArray:
    """Compute the BRDF (n, channels) in sr⁻¹ of a `mitsuba.BSDF` at direction pairs (n, 3).

    `types` are flags of the components that count, by default all. The channels of a spectral
    variant are wavelengths in the middle of the visible range.
    """
    import drjit as dr
    import mitsuba as mi

    wi, wo = (np.asarray(w, np.float32) for w in (wi, wo))
    si = dr.zeros(mi.SurfaceInteraction3f, len(wi))
    si.wi, si.sh_frame, si.n = (
        mi.Vector3f(wi.T),
        mi.Frame3f(mi.Vector3f(0, 0, 1)),
        mi.Normal3f(0, 0, 1),
    )
    if mi.is_spectral:
        si.wavelengths = type(si.wavelengths)(*np.linspace(450, 650, len(si.wavelengths)).tolist())
    context = mi.BSDFContext()
    if types is not None:
        context.type_mask = types
    value = bsdf.eval(context, si, mi.Vector3f(wo.T))
    value = np.array(mi.unpolarized_spectrum(value)).T
    above = (wi[:, 2:] > 0) & (wo[:, 2:] > 0)
    return np.where(above, value / np.where(above, wo[:, 2:], 1), 0).astype(float)
