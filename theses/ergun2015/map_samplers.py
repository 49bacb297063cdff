"""Makes environment emitters that sample a map as the thesis does, as brdfkit does, or by sums.

The thesis's blocks are cut by the sum of squared errors, and a point is uniform in its block.
brdfkit's blocks are those of least variance, with densities that are linear along both axes.
"""

import numpy as np

from brdfkit.core.colours import luminance
from brdfkit.lighting.sampling import blocks
from brdfkit.theses.replacing import replace_part

COMPRESSION = 170  # cells per block of Uffizi in Figure 9.3
FEW = 191  # blocks of a map of 256 × 128 pixels at this compression
OURS = 4096  # blocks of `kdtree_envmap` by default
DRAWS = 1 << 20


def make_thesis_emitter(rgb, count=FEW, distribution="hyperbolic"):
    """Return an emitter of the map `rgb` with at most `count` of the thesis's blocks.

    The `distribution` is "hyperbolic" for the thesis's law of sorted shares, or "exact".
    """
    with replace_part(blocks, "fit_slopes", _leave_flat):
        return make_sloped_emitter(rgb, count, distribution)


def make_sloped_emitter(rgb, count, distribution="hyperbolic"):
    """Return an emitter like `make_thesis_emitter`, but with brdfkit's linear densities."""
    settings = {"blocks": count, "distribution": distribution, "criterion": "sse"}
    return _load_emitter(rgb, "kdtree_envmap", **settings)


def make_our_emitter(rgb, count=OURS, distribution="exact"):
    """Return an emitter of the map `rgb` with at most `count` of brdfkit's blocks."""
    return _load_emitter(rgb, "kdtree_envmap", blocks=count, distribution=distribution)


def make_rival_emitter(rgb, sampler="cdf"):
    """Return an emitter of the map `rgb` that is sampled by cumulative sums, or as `sampler` says.

    It is one of the samplers of `sampled_envmap`, or "envmap", Mitsuba's own.
    """
    if sampler == "envmap":
        return _load_emitter(rgb, "envmap")
    return _load_emitter(rgb, "sampled_envmap", sampler=sampler)


def draw_weights(lamp, count=DRAWS):
    """Return the luminance (count,) over the density of directions that an emitter draws."""
    import drjit as dr
    import mitsuba as mi

    sampler = mi.load_dict({"type": "independent"})
    sampler.seed(1, count)
    _, weight = lamp.sample_direction(dr.zeros(mi.SurfaceInteraction3f), sampler.next_2d())
    return luminance(np.array(weight, float).T)


def measure_variance(lamp):
    """Return the relative variance of the directions that an emitter draws, for its whole light."""
    weights = draw_weights(lamp)
    return float(weights.var() / weights.mean() ** 2)


def _leave_flat(sums, pixels, boxes):
    """Return slopes of 0 for the densities in blocks, in place of `blocks.fit_slopes`."""
    return np.zeros((len(boxes), 2))


def _load_emitter(rgb, kind, **settings):
    """Load an emitter of a kind with a map."""
    import mitsuba as mi

    entries = {"type": kind, "bitmap": mi.Bitmap(rgb.astype(np.float32)), **settings}
    return mi.load_dict(entries, parallel=False)
