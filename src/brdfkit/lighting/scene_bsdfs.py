"""The BSDFs of a scene: whether their matte part can be told from the rest, whether they turn."""

import numpy as np

from brdfkit.geometry.directions import rotate_z
from brdfkit.host.bsdf_material import eval_bsdf

SAME = 1e-3  # of the largest value: differences that do not count


def _pairs(count=64):
    """Direction pairs (2, count, 3) above the surface: half of them anywhere, half near the mirror
    direction, from a thousandth of a radian to a third, where narrow lobes differ."""
    random, near = np.random.default_rng(0), count // 2
    wi, wo = random.normal(size=(2, count, 3))
    wi /= np.linalg.norm(wi, axis=-1, keepdims=True)
    off = np.logspace(-3, -0.5, near)[:, None] * random.normal(size=(near, 3))
    wo[:near] = wi[:near] * [-1, -1, 1] + off
    wo /= np.linalg.norm(wo, axis=-1, keepdims=True)
    pairs = np.stack([wi, wo])
    pairs[..., 2] = np.abs(pairs[..., 2])
    return pairs


PAIRS = _pairs()  # by whose values BSDFs are compared


def bsdfs_of(scene):
    """The different BSDFs of a `scene`, a list."""
    return list(dict.fromkeys(shape.bsdf() for shape in scene.shapes()))


def is_one_of(bsdf, others):
    """Whether a `BSDFPtr` points to one of the BSDFs `others`."""
    import mitsuba as mi

    found = mi.Bool(False)
    for other in others:
        found |= bsdf == mi.BSDFPtr(other)
    return found


def matte_and_rest(mi):
    """The types of Mitsuba's components that are diffuse reflections, and all others."""
    matte = int(mi.BSDFFlags.DiffuseReflection)
    return matte, int(mi.BSDFFlags.All) & ~matte


def has_matte_part(bsdf):
    """Whether the diffuse components of a BSDF are constant, and it takes requests for them alone.

    Some BSDFs give all of themselves whichever components are asked for.
    """
    import mitsuba as mi

    matte, rest = (eval_bsdf(bsdf, *PAIRS, types) for types in matte_and_rest(mi))
    whole = eval_bsdf(bsdf, *PAIRS)
    allowed = SAME * matte.max()
    return bool(
        matte.max() > 0
        and np.ptp(matte, axis=0).max() < allowed
        and np.abs(whole - matte - rest).max() < SAME * whole.max()
    )


def is_isotropic(bsdf):
    """Whether the values of a BSDF stay when both directions turn about the normal."""
    value, turned = eval_bsdf(bsdf, *PAIRS), eval_bsdf(bsdf, *rotate_z(PAIRS, 1.0))
    return bool(np.abs(value - turned).max() <= SAME * value.max())
