"""Draws points of a map from its sorted blocks: a block by a law, and a point in it by its slopes.

[Ergun 2015, section 6.3]. Blocks beside each other in this order lie anywhere in the map, so that
strata of Mitsuba's samplers are mostly lost.
"""

import dataclasses

import numpy as np

from brdfkit.lighting.sampling.block_slopes import draw, line
from brdfkit.mitsuba_bridge.arrays import Rows


class SortedBlocks:
    """The blocks of a `Tree` with `slopes` (n, 2), and the law of the class `law` fitted to their
    shares (n,)."""

    def __init__(self, tree, shares, slopes, law):
        order = np.argsort(-shares, kind="stable")
        x0, x1, y0, y1 = tree.blocks[order].T
        self.cells, areas = tree.boxes[0, 1] * tree.boxes[0, 3], (x1 - x0) * (y1 - y0)
        self.law = law.fit(shares[order])
        self.densities = np.empty(len(order))  # in the order of `Tree.blocks`
        self.densities[order] = self.law.probability(np.arange(len(order))) * self.cells / areas
        self.in_renderer = _in_renderer(self.law)
        self.boxes = Rows(np.stack([x0, x1, y0, y1], axis=1))
        self.slopes = Rows(slopes[order])
        self.nbytes = 24 * len(order)

    def sample(self, u, active):
        """(x, y, density relative to an even one)."""
        import drjit as dr
        import mitsuba as mi

        law = self.in_renderer
        i = dr.minimum(dr.floor(law.inverse(u.x)), law.n - 1)
        probability = law.probability(i)
        rest = (u.x - law.cumulative(i)) / dr.maximum(probability, 1e-30)
        box = self.boxes.at(mi.UInt32(i), mi.Vector4f, active)
        slope = self.slopes.at(mi.UInt32(i), mi.Vector2f, active)
        s, t = draw(dr.clip(rest, 0, 1), slope.x), draw(u.y, slope.y)
        mean = probability * mi.Float(self.cells) / ((box.y - box.x) * (box.w - box.z))
        density = mean * line(s, slope.x) * line(t, slope.y)
        return dr.lerp(box.x, box.y, s), dr.lerp(box.z, box.w, t), density


def _in_renderer(law):
    """The law in Mitsuba's current variant; kernels do not contain its numbers."""
    import drjit as dr

    numbers = {f.name: getattr(law, f.name) for f in dataclasses.fields(law) if f.name != "maths"}
    return type(law)(maths=dr, **{name: _opaque(value) for name, value in numbers.items()})


def _opaque(value):
    """A number, or a tuple of numbers, any value of which has one kernel."""
    import drjit as dr
    import mitsuba as mi

    if isinstance(value, tuple):
        return tuple(_opaque(number) for number in value)
    opaque = mi.Float(float(value))
    dr.make_opaque(opaque)
    return opaque
