"""The BSDFs of a scene: tests of their properties, and a cache of what is computed from them."""

from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

from brdfkit.core.array_types import FloatArray, JitMask, MitsubaModule, MitsubaObject
from brdfkit.core.geometry.directions import rotate_z
from brdfkit.mitsuba_bridge.bsdf.from_dictionary import eval_bsdf

TOLERANCE = 1e-3  # share of the largest value: smaller differences do not count
CACHED_BSDFS = 16


def _make_pairs(count: int = 64) -> FloatArray:
    """Return direction pairs (2, count, 3) above the surface.

    Half of them lie anywhere. Half lie near the mirror direction, from a thousandth of a radian to
    a third, where narrow lobes differ.
    """
    random, near = np.random.default_rng(0), count // 2
    wi, wo = random.normal(size=(2, count, 3))
    wi /= np.linalg.norm(wi, axis=-1, keepdims=True)
    off = np.logspace(-3, -0.5, near)[:, None] * random.normal(size=(near, 3))
    wo[:near] = wi[:near] * [-1, -1, 1] + off
    wo /= np.linalg.norm(wo, axis=-1, keepdims=True)
    pairs = np.stack([wi, wo])
    pairs[..., 2] = np.abs(pairs[..., 2])
    return pairs


PAIRS = _make_pairs()  # BSDFs are compared by their values there


def distinct_bsdfs(scene: MitsubaObject) -> list[MitsubaObject]:
    """Return the different BSDFs of a `scene`."""
    return list(dict.fromkeys(shape.bsdf() for shape in scene.shapes()))


def is_one_of(bsdf: MitsubaObject, others: Iterable[MitsubaObject]) -> JitMask:
    """Return whether a `BSDFPtr` points to one of the BSDFs `others`."""
    import mitsuba as mi

    matches = mi.Bool(False)
    for other in others:
        matches |= bsdf == mi.BSDFPtr(other)
    return matches


def component_types(mi: MitsubaModule) -> tuple[int, int]:
    """Return the types of Mitsuba's components that reflect diffusely, and all other types."""
    matte = int(mi.BSDFFlags.DiffuseReflection)
    return matte, int(mi.BSDFFlags.All) & ~matte


def has_matte_part(bsdf: MitsubaObject) -> bool:
    """Return whether the diffuse components of a BSDF are constant and evaluated separately.

    Some BSDFs evaluate all components whichever are requested.
    """
    import mitsuba as mi

    wi, wo = PAIRS
    matte, others = (eval_bsdf(bsdf, wi, wo, types) for types in component_types(mi))
    whole = eval_bsdf(bsdf, wi, wo)
    allowed = TOLERANCE * matte.max()
    return bool(
        matte.max() > 0
        and np.ptp(matte, axis=0).max() < allowed
        and np.abs(whole - matte - others).max() < TOLERANCE * whole.max()
    )


def is_isotropic(bsdf: MitsubaObject) -> bool:
    """Return whether a BSDF keeps its values when both directions turn about the normal."""
    value, turned = eval_bsdf(bsdf, *PAIRS), eval_bsdf(bsdf, *rotate_z(PAIRS, 1.0))
    return bool(np.abs(value - turned).max() <= TOLERANCE * value.max())


def is_same_everywhere(bsdf: MitsubaObject) -> bool:
    """Return whether values at a few directions describe a BSDF at every point of a surface.

    They do not where the BSDF has a texture, a mirror or refracted light, which those directions
    miss, nor where derivatives by its parameters are needed, nor in a spectral variant.
    """
    import drjit as dr
    import mitsuba as mi

    flags = mi.BSDFFlags
    missed = (flags.Delta, flags.Transmission, flags.Null)
    if mi.is_spectral or any(mi.has_flag(bsdf.flags(), flag) for flag in missed):
        return False
    differentiated = any(dr.grad_enabled(value) for _, value in mi.traverse(bsdf))
    return not (differentiated or _has_texture(bsdf))


def _has_texture(parent: MitsubaObject) -> bool:
    """Return whether an object of Mitsuba's, or a part of it, has a texture that varies."""
    import mitsuba as mi

    varies = []

    class Parts(mi.TraversalCallback):
        def put(self, name: str, value: Any, *_: Any) -> None:
            if isinstance(value, mi.Texture):
                varies.append(value.is_spatially_varying())
            elif isinstance(value, mi.Object):
                value.traverse(Parts())

    parent.traverse(Parts())
    return any(varies)


class CacheByValues:
    """A cache of the results of `make(bsdf)`, by the values of the BSDF at some directions."""

    def __init__(self, make: Callable[[MitsubaObject], Any]) -> None:
        self.make, self.results = make, dict[bytes, Any]()

    def get(self, bsdfs: list[MitsubaObject]) -> list[tuple[MitsubaObject, Any]]:
        """Return pairs (BSDF, result) for `bsdfs` with their present parameters."""
        pairs = []
        for bsdf in bsdfs:
            values = eval_bsdf(bsdf, *PAIRS).tobytes()
            result = self.results.pop(values, None) or self.make(bsdf)
            self.results[values] = result  # the newest comes last
            pairs.append((bsdf, result))
        for oldest in list(self.results)[: -max(CACHED_BSDFS, len(pairs))]:
            del self.results[oldest]
        return pairs
