"""Closed formulas for the probabilities of a map's blocks, to draw a block without table or search.

A law approximates the shares of power of n blocks that are sorted from the largest to the smallest.
It has P̂(i) as `probability(i)`, the cumulative F as `cumulative(x)`, and F⁻¹ as `inverse(xi)`.
They compute by the functions of its module `maths`: NumPy's, or Dr.Jit's in the renderer. Estimates
by any law are unbiased, because P̂ divides them, not the share. [Ergun 2015, section 6.3]
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from dataclasses import dataclass
from types import ModuleType
from typing import Any

import numpy as np

from brdfkit.core.array_types import FloatArray, JitFloat, JitMask, JitVector
from brdfkit.lighting.sampling.block_slopes import draw_on_line, line_density
from brdfkit.lighting.sampling.tree import Tree
from brdfkit.mitsuba_bridge.arrays import Rows

STEPS = 8  # of the law `Steps`
EDGES = 64  # places where a step may begin, in equal ratios of ranks


@dataclass(frozen=True)
class Hyperbolic:
    """The thesis's law of one parameter `u` > 0 for `n` blocks: a density 1 / (u + x) of ranks x.

    Sorted shares rarely follow it; where they do not, samples are noisier than by the exact shares.
    [Ergun 2015, eqs. 6.3-6.5]
    """

    n: int
    u: float
    maths: ModuleType = np

    @classmethod
    def fit(cls, shares: FloatArray) -> Hyperbolic:
        """Return the law of maximum likelihood Σ P log P̂ for sorted `shares` P (n,).

        >>> Hyperbolic.fit(Hyperbolic(256, 5.0).probability(np.arange(256))).u    # doctest: +SKIP
        5.000
        """
        from scipy.optimize import minimize_scalar

        n = len(shares)
        i = np.arange(n)

        def loss(log_u: float) -> float:
            return float(-shares @ np.log(cls(n, np.exp(log_u)).probability(i)))

        # From nearly all light in one block to equal shares
        minimum = minimize_scalar(loss, bounds=(-10, np.log(n) + 10), method="bounded")
        return cls(n, float(np.exp(minimum.x)))

    def cumulative(self, x: JitFloat) -> JitFloat:
        """Return F(x) of eq. 6.4, the probability of the blocks before rank `x`."""
        log = self.maths.log
        return log(1 + x / self.u) / log(1 + self.n / self.u)

    def probability(self, i: JitFloat) -> JitFloat:
        """Return P̂(i) = F(i + 1) - F(i) of eq. 6.4, the probability of block `i`."""
        log = self.maths.log
        return log(1 + 1 / (self.u + i)) / log(1 + self.n / self.u)

    def inverse(self, xi: JitFloat) -> JitFloat:
        """Return F⁻¹(ξ) of eq. 6.5, the rank below which the blocks have probability `xi`."""
        return self.u * ((1 + self.n / self.u) ** xi - 1)


@dataclass(frozen=True)
class Steps:
    """A law for `n` blocks with equal probabilities within each of a few ranges of ranks.

    Step k begins at rank `edges[k]` and has `shares[k]`. F and its inverse are linear in each
    range: sixteen numbers for any number of blocks. Shares fall over decades, and ranges that
    follow them leave little of the noise that the hyperbola adds.
    """

    n: int
    edges: tuple[Any, ...]
    shares: tuple[Any, ...]
    maths: ModuleType = np

    @classmethod
    def fit(cls, shares: FloatArray) -> Steps:
        """Return the law of maximum likelihood Σ P log P̂, by dynamic programming over the edges."""
        n = len(shares)
        edges = np.unique(np.append(0, np.geomspace(1, n, EDGES).round())).astype(int)
        below = np.append(0, np.cumsum(shares))[edges]
        share, width = below[None, :] - below[:, None], edges[None, :] - edges[:, None]
        likelihood = np.full(share.shape, -np.inf)  # of a step from one edge to another
        upwards = np.triu(np.ones(share.shape, bool), 1)
        black = upwards & (share <= 0)
        lit = upwards & ~black
        likelihood[black], likelihood[lit] = 0, share[lit] * np.log(share[lit] / width[lit])

        # The best k steps to an edge are the best k - 1 steps to an earlier edge, and one more
        best, origins = likelihood[0], []
        for _ in range(min(STEPS, len(edges) - 1) - 1):
            sums = best[:, None] + likelihood
            origins.append(sums.argmax(axis=0))
            best = sums.max(axis=0)
        at = [len(edges) - 1]
        for origin in reversed(origins):
            at.insert(0, origin[at[0]])
        share = np.diff(below[at], prepend=0)
        return cls(n, tuple(np.append(0, edges[at[:-1]]).tolist()), tuple(share.tolist()))

    def _steps(self) -> Iterator[tuple[Any, Any, Any, Any]]:
        """Yield (first rank, number of blocks, share of all steps before, share) of each step."""
        below = 0
        ends = (*self.edges[1:], self.n)
        for first, end, share in zip(self.edges, ends, self.shares, strict=True):
            yield first, end - first, below, share
            below = below + share

    def cumulative(self, x: JitFloat) -> JitFloat:
        """Return F(x), the probability of the blocks before rank `x`."""
        clip = self.maths.clip
        return sum(share * clip((x - first) / n, 0, 1) for first, n, _, share in self._steps())

    def probability(self, i: JitFloat) -> JitFloat:
        """Return P̂(i), the probability of block `i`."""
        clip = self.maths.clip  # of whole numbers: 1 in the step, 0 outside it
        return sum(
            share / n * clip(i + 1 - first, 0, 1) * clip(first + n - i, 0, 1)
            for first, n, _, share in self._steps()
        )

    def inverse(self, xi: JitFloat) -> JitFloat:
        """Return F⁻¹(ξ), the rank below which the blocks have probability `xi`."""
        clip, maximum = self.maths.clip, self.maths.maximum
        return sum(
            n * clip((xi - below) / maximum(share, 1e-30), 0, 1)
            for _, n, below, share in self._steps()
        )


Law = Hyperbolic | Steps


class SortedBlocks:
    """Draws points of a map: a block by a law, and a point in it by the block's slopes.

    The blocks are those of a `Tree`, with `slopes` (n, 2) and `shares` (n,) of the power, to which
    a law of the class `law` is fitted. Neighbours in the order of shares lie anywhere in the map,
    so that the strata of Mitsuba's samplers are mostly lost.
    """

    def __init__(self, tree: Tree, shares: FloatArray, slopes: FloatArray, law: type[Law]) -> None:
        order = np.argsort(-shares, kind="stable")
        x0, x1, y0, y1 = tree.blocks[order].T
        self.cells, areas = tree.boxes[0, 1] * tree.boxes[0, 3], (x1 - x0) * (y1 - y0)
        self.law = law.fit(shares[order])
        self.densities = np.empty(len(order))  # in the order of `Tree.blocks`
        self.densities[order] = self.law.probability(np.arange(len(order))) * self.cells / areas
        self.in_renderer = _to_renderer(self.law)
        self.boxes = Rows(np.stack([x0, x1, y0, y1], axis=1))
        self.slopes = Rows(slopes[order])
        self.nbytes = 24 * len(order)

    def sample(self, u: JitVector, active: JitMask) -> tuple[JitFloat, JitFloat, JitFloat]:
        """Return (x, y, density relative to a uniform one) of a point for uniform numbers `u`."""
        import drjit as dr
        import mitsuba as mi

        law = self.in_renderer
        i = dr.minimum(dr.floor(law.inverse(u.x)), law.n - 1)
        probability = law.probability(i)
        remainder = (u.x - law.cumulative(i)) / dr.maximum(probability, 1e-30)
        box = self.boxes.at(mi.UInt32(i), mi.Vector4f, active)
        slope = self.slopes.at(mi.UInt32(i), mi.Vector2f, active)
        s, t = draw_on_line(dr.clip(remainder, 0, 1), slope.x), draw_on_line(u.y, slope.y)
        mean = probability * mi.Float(self.cells) / ((box.y - box.x) * (box.w - box.z))
        density = mean * line_density(s, slope.x) * line_density(t, slope.y)
        return dr.lerp(box.x, box.y, s), dr.lerp(box.z, box.w, t), density


def _to_renderer(law: Law) -> Law:
    """Return the law with Dr.Jit's functions and numbers that its kernels read from memory."""
    import drjit as dr

    numbers = {f.name: getattr(law, f.name) for f in dataclasses.fields(law) if f.name != "maths"}
    return type(law)(maths=dr, **{name: _to_opaque(value) for name, value in numbers.items()})


def _to_opaque(value: Any) -> Any:
    """Return a number, or a tuple of numbers, as Dr.Jit's, so that all values share one kernel."""
    import drjit as dr
    import mitsuba as mi

    if isinstance(value, tuple):
        return tuple(_to_opaque(number) for number in value)
    opaque = mi.Float(float(value))
    dr.make_opaque(opaque)
    return opaque
