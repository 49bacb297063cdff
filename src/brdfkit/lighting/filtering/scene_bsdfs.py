"""The BSDFs of a scene: what they are like, and what is made of them, kept between pictures."""

import numpy as np

from brdfkit.core.geometry.directions import rotate_z
from brdfkit.mitsuba_bridge.bsdf.from_dictionary import eval_bsdf

SAME = 1e-3  # of the largest value: differences that do not count
KEPT = 16  # BSDFs of which something is kept between pictures


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


def is_same_everywhere(bsdf):
    """Whether the values of a BSDF at some directions say what it is at every point of a surface.

    So not where it has a texture, or a mirror or refracted light, which those directions miss, or
    where derivatives by its parameters are wanted; nor in a spectral variant.
    """
    import drjit as dr
    import mitsuba as mi

    flags = mi.BSDFFlags
    missed = (flags.Delta, flags.Transmission, flags.Null)
    if mi.is_spectral or any(mi.has_flag(bsdf.flags(), flag) for flag in missed):
        return False
    differentiated = any(dr.grad_enabled(value) for _, value in mi.traverse(bsdf))
    return not (differentiated or _has_texture(bsdf))


def _has_texture(thing):
    """Whether an object of Mitsuba's, or one that it consists of, has a texture that varies."""
    import mitsuba as mi

    found = []

    class Parts(mi.TraversalCallback):
        def put(self, name, value, *_):
            if isinstance(value, mi.Texture):
                found.append(value.is_spatially_varying())
            elif isinstance(value, mi.Object):
                value.traverse(Parts())

    thing.traverse(Parts())
    return any(found)


class KeptByValues:
    """What `make` makes of a BSDF, kept by the BSDF's values at some directions."""

    def __init__(self, make):
        self.make, self.known = make, {}

    def of(self, bsdfs):
        """(BSDF, what is made of it) of each of `bsdfs`, as they are now."""
        found = []
        for bsdf in bsdfs:
            values = eval_bsdf(bsdf, *PAIRS).tobytes()
            made = self.known.pop(values, None) or self.make(bsdf)
            self.known[values] = made  # the newest comes last
            found.append((bsdf, made))
        for oldest in list(self.known)[: -max(KEPT, len(found))]:
            del self.known[oldest]
        return found
