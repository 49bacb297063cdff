"""Properties of the BSDFs in a scene, such as isotropy, and a cache of results for each BSDF."""

from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

from brdfkit.core.array_types import FloatArray, JitMask, MitsubaModule, MitsubaObject
from brdfkit.core.geometry.directions import rotate_z
from brdfkit.mitsuba_bridge.bsdf.from_dictionary import eval_bsdf

TOLERANCE = 1e-3  # smaller differences, relative to the largest value, count as rounding errors
CACHED_BSDFS = 16  # largest number of BSDFs whose results `CacheByValues` keeps


def _make_direction_pairs(count: int = 64) -> FloatArray:
    """Return pairs (wi and wo, count, 3) of directions above the surface, to compare BSDFs there.

    One half are random pairs. The others lie near the mirror direction, at angles from a thousandth
    of a radian to a third, where narrow lobes differ.
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


PAIRS = _make_direction_pairs()  # direction pairs at which BSDFs are compared


def list_distinct_bsdfs(scene: MitsubaObject) -> list[MitsubaObject]:
    """Return the BSDFs of a scene's shapes, each once."""
    return list(dict.fromkeys(shape.bsdf() for shape in scene.shapes()))


def points_to_one_of(bsdf: MitsubaObject, others: Iterable[MitsubaObject]) -> JitMask:
    """Return a mask of the elements of a `mi.BSDFPtr` that point to one of the BSDFs `others`."""
    import mitsuba as mi

    matches = mi.Bool(False)
    for other in others:
        matches |= bsdf == mi.BSDFPtr(other)
    return matches


def split_component_types(mi: MitsubaModule) -> tuple[int, int]:
    """Return Mitsuba's flags of diffusely reflecting BSDF components, and of all others."""
    matte = int(mi.BSDFFlags.DiffuseReflection)
    return matte, int(mi.BSDFFlags.All) & ~matte


def has_separate_diffuse_part(bsdf: MitsubaObject) -> bool:
    """Return whether the diffuse components of a BSDF are constant, and can be evaluated alone.

    The BSDF of a model knows it, whatever the values of its parameters. Others are tested, because
    some evaluate all components even if only the diffuse ones are requested.
    """
    import mitsuba as mi

    parts = _list_children(bsdf) if bsdf.class_name() == "TwoSidedBRDF" else [bsdf]
    known = [getattr(part, "has_constant_diffuse_part", None) for part in parts]
    if None not in known:
        return all(known)
    wi, wo = PAIRS
    matte, others = (eval_bsdf(bsdf, wi, wo, types) for types in split_component_types(mi))
    whole = eval_bsdf(bsdf, wi, wo)
    return bool(
        matte.max() > 0
        and np.ptp(matte, axis=0).max() < TOLERANCE * matte.max()
        and np.abs(whole - matte - others).max() < TOLERANCE * whole.max()
    )


def _list_children(parent: MitsubaObject) -> list[MitsubaObject]:
    """Return the objects that a Mitsuba object holds, such as the BSDFs of a two-sided one."""
    import mitsuba as mi

    found = []

    class Children(mi.TraversalCallback):
        def put(self, name: str, value: Any, *_: Any) -> None:
            if isinstance(value, mi.Object):
                found.append(value)

    parent.traverse(Children())
    return found


def is_isotropic(bsdf: MitsubaObject) -> bool:
    """Return whether a BSDF is isotropic: unchanged if both directions turn about the normal."""
    return find_period(bsdf) == 0


def find_period(bsdf: MitsubaObject) -> float:
    """Return the turn of both directions about the normal that leaves a BSDF unchanged [rad].

    It is 0 for any turn, of an isotropic BSDF; π, as for an ellipse; or 2π.
    """
    turns = [PAIRS, rotate_z(PAIRS, 1.0), rotate_z(PAIRS, np.pi)]
    values = eval_bsdf(bsdf, *np.concatenate(turns, axis=1))
    value, turned, half_turned = np.split(values, len(turns))
    for period, other in ((0.0, turned), (np.pi, half_turned)):
        if np.abs(value - other).max() <= TOLERANCE * value.max():
            return period
    return 2 * np.pi


def is_uniform_over_surface(bsdf: MitsubaObject) -> bool:
    """Return whether a BSDF is equal at all points of a surface, so that results can be stored.

    It counts as different if it has a texture, a mirror or refraction, if derivatives with respect
    to its parameters are needed, and in spectral variants.
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
    """Return whether a Mitsuba object or one of its children has a spatially varying texture."""
    import mitsuba as mi

    return any(
        child.is_spatially_varying() if isinstance(child, mi.Texture) else _has_texture(child)
        for child in _list_children(parent)
    )


class CacheByValues:
    """A cache of results `make(bsdf)`, which recognises a BSDF by its values at some directions.

    A BSDF that reflects at the back of surfaces is another one, though these values are equal.
    """

    def __init__(self, make: Callable[[MitsubaObject], Any]) -> None:
        self.make, self.results = make, dict[bytes, Any]()

    def get_or_make_results(self, bsdfs: list[MitsubaObject]) -> list[tuple[MitsubaObject, Any]]:
        """Return pairs (BSDF, result); a result that is not in the cache is made."""
        import mitsuba as mi

        pairs = []
        for bsdf in bsdfs:
            has_back = mi.has_flag(bsdf.flags(), mi.BSDFFlags.BackSide)
            key = eval_bsdf(bsdf, *PAIRS).tobytes() + bytes([has_back])
            result = self.results.pop(key, None) or self.make(bsdf)
            # becomes the last entry; the first ones are deleted below
            self.results[key] = result
            pairs.append((bsdf, result))
        for oldest in list(self.results)[: -max(CACHED_BSDFS, len(pairs))]:
            del self.results[oldest]
        return pairs
