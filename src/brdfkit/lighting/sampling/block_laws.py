"""Closed formulas for the probabilities of a map's blocks, to draw a block without table or search.

Each of the map's n blocks emits a share of its power. The blocks are sorted from the largest share
to the smallest; the rank of a block is its number in this order, from 0. A law is a formula that
approximates the share of the block with rank i. The method `probability` returns this value P̂(i),
and `cumulative_probability` the cumulative distribution F. `inverse_cumulative` is the inverse of
F, which draws ranks from random numbers. They use the functions of `maths`: NumPy, or Dr.Jit in the
renderer. No law biases an estimate, because samples are divided by P̂, not by the block's share.
[Ergun 2015, section 6.3]
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from dataclasses import dataclass
from types import ModuleType
from typing import Any

import numpy as np

from brdfkit.core.array_types import FloatArray, JitFloat, JitMask, JitVector
from brdfkit.lighting.sampling.block_slopes import line_density, sample_line_density
from brdfkit.lighting.sampling.tree import Tree
from brdfkit.mitsuba_bridge.arrays import Rows

# The law `Steps` sorts the blocks of a map by power, and divides the sorted list into at most this
# many ranges; all blocks of a range get the same probability
STEPS = 8
# Number of places in the sorted list where a range may begin; successive places have equal ratios
EDGES = 64


@dataclass(frozen=True)
class Hyperbolic:
    """A law for `n` blocks whose probabilities fall hyperbolically, as 1 / (u + x) at the rank x.

    Sorted shares of power rarely fall like this; where they do not, samples are noisier than with
    the exact shares. The parameter is `u` > 0. [Ergun 2015, eqs. 6.3-6.5]
    """

    n: int
    u: float
    maths: ModuleType = np

    @classmethod
    def fit_to_shares(cls, shares: FloatArray) -> Hyperbolic:
        """Fit the law to sorted `shares` P (n,) of the power of blocks.

        The law's probabilities P̂ maximise the log likelihood Σ P log P̂.

        >>> shares = Hyperbolic(256, 5.0).probability(np.arange(256))
        >>> round(Hyperbolic.fit_to_shares(shares).u, 3)
        5.0
        """
        from scipy.optimize import minimize_scalar

        n = len(shares)
        i = np.arange(n)

        def loss(log_u: float) -> float:
            return float(-shares @ np.log(cls(n, np.exp(log_u)).probability(i)))

        # At the lower bound of log u, the brightest block gets about half of the samples; at the
        # upper one, all blocks get about the same number
        minimum = minimize_scalar(loss, bounds=(-10, np.log(n) + 10), method="bounded")
        return cls(n, float(np.exp(minimum.x)))

    def cumulative_probability(self, x: JitFloat) -> JitFloat:
        """Return the probability F(x) of all blocks before the rank `x`."""
        log = self.maths.log
        return log(1 + x / self.u) / log(1 + self.n / self.u)

    def probability(self, i: JitFloat) -> JitFloat:
        """Return the probability P̂(i) = F(i + 1) - F(i) of the block with the rank `i`."""
        log = self.maths.log
        return log(1 + 1 / (self.u + i)) / log(1 + self.n / self.u)

    def inverse_cumulative(self, xi: JitFloat) -> JitFloat:
        """Return the rank below which the blocks together have the probability `xi`."""
        return self.u * ((1 + self.n / self.u) ** xi - 1)


@dataclass(frozen=True)
class Steps:
    """A law for `n` blocks with equal probabilities within each of a few ranges of ranks.

    Step k begins at the rank `edges[k]`, and its blocks have the probability `shares[k]` together.
    The cumulative distribution and its inverse are linear in each range. Samples are less noisy
    than with the law `Hyperbolic`, since the steps follow the blocks' shares.
    """

    n: int
    edges: tuple[Any, ...]
    shares: tuple[Any, ...]
    maths: ModuleType = np

    @classmethod
    def fit_to_shares(cls, shares: FloatArray) -> Steps:
        """Fit the law to sorted `shares` P (n,) of the power of blocks.

        The law's probabilities P̂ maximise the log likelihood Σ P log P̂. Dynamic programming finds
        the edges of the steps.
        """
        n = len(shares)
        edges = np.unique(np.append(0, np.geomspace(1, n, EDGES).round())).astype(int)
        below = np.append(0, np.cumsum(shares))[edges]
        share, width = below[None, :] - below[:, None], edges[None, :] - edges[:, None]
        # entry [i, j] belongs to a step from edge i to edge j
        likelihood = np.full(share.shape, -np.inf)
        upwards = np.triu(np.ones(share.shape, bool), 1)
        black = upwards & (share <= 0)
        lit = upwards & ~black
        likelihood[black], likelihood[lit] = 0, share[lit] * np.log(share[lit] / width[lit])

        # Dynamic programming: the best k steps up to an edge are the best k - 1 steps up to some
        # earlier edge, and one step from there
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

    def _list_steps(self) -> Iterator[tuple[Any, Any, Any, Any]]:
        """Yield each step: first rank, number of blocks, probability before, own probability."""
        below = 0
        ends = (*self.edges[1:], self.n)
        for first, end, share in zip(self.edges, ends, self.shares, strict=True):
            yield first, end - first, below, share
            below = below + share

    def cumulative_probability(self, x: JitFloat) -> JitFloat:
        """Return the probability F(x) of all blocks before the rank `x`."""
        clip = self.maths.clip
        return sum(share * clip((x - first) / n, 0, 1) for first, n, _, share in self._list_steps())

    def probability(self, i: JitFloat) -> JitFloat:
        """Return the probability P̂(i) of the block with the rank `i`."""
        clip = self.maths.clip
        # Both clipped factors are 1 for the ranks in a step, and one of them is 0 outside it
        return sum(
            share / n * clip(i + 1 - first, 0, 1) * clip(first + n - i, 0, 1)
            for first, n, _, share in self._list_steps()
        )

    def inverse_cumulative(self, xi: JitFloat) -> JitFloat:
        """Return the rank below which the blocks together have the probability `xi`."""
        clip, maximum = self.maths.clip, self.maths.maximum
        return sum(
            n * clip((xi - below) / maximum(share, 1e-30), 0, 1)
            for _, n, below, share in self._list_steps()
        )


Law = Hyperbolic | Steps


class SortedBlocks:
    """Draws points of a map: first a block by a law, then a point in it by a linear density.

    The blocks are those of a `Tree`, with the `slopes` (n, 2) of their densities, and their
    `shares` (n,) of the map's power, to which a law of the class `law` is fitted. Blocks with
    neighbouring ranks may lie far apart in the map, so that the stratification of Mitsuba's
    samplers is mostly lost.
    """

    def __init__(self, tree: Tree, shares: FloatArray, slopes: FloatArray, law: type[Law]) -> None:
        order = np.argsort(-shares, kind="stable")
        x0, x1, y0, y1 = tree.blocks[order].T
        self.cells, areas = tree.boxes[0, 1] * tree.boxes[0, 3], (x1 - x0) * (y1 - y0)
        self.law = law.fit_to_shares(shares[order])
        self.densities = np.empty(len(order))  # in the order of `Tree.blocks`, not by rank
        self.densities[order] = self.law.probability(np.arange(len(order))) * self.cells / areas
        self.in_renderer = _convert_to_drjit(self.law)
        self.boxes = Rows(np.stack([x0, x1, y0, y1], axis=1))
        self.slopes = Rows(slopes[order])
        self.nbytes = 24 * len(order)

    def sample(self, u: JitVector, active: JitMask) -> tuple[JitFloat, JitFloat, JitFloat]:
        """Draw a point of the map by uniform numbers `u`; return (x, y, density)."""
        import drjit as dr
        import mitsuba as mi

        law = self.in_renderer
        i = dr.minimum(dr.floor(law.inverse_cumulative(u.x)), law.n - 1)
        probability = law.probability(i)
        remainder = (u.x - law.cumulative_probability(i)) / dr.maximum(probability, 1e-30)
        box = self.boxes.at(mi.UInt32(i), mi.Vector4f, active)
        slope = self.slopes.at(mi.UInt32(i), mi.Vector2f, active)
        s, t = (
            sample_line_density(dr.clip(remainder, 0, 1), slope.x),
            sample_line_density(u.y, slope.y),
        )
        mean = probability * mi.Float(self.cells) / ((box.y - box.x) * (box.w - box.z))
        density = mean * line_density(s, slope.x) * line_density(t, slope.y)
        return dr.lerp(box.x, box.y, s), dr.lerp(box.z, box.w, t), density


def _convert_to_drjit(law: Law) -> Law:
    """Return a law of block probabilities that computes with Dr.Jit, for the renderer."""
    import drjit as dr

    numbers = {f.name: getattr(law, f.name) for f in dataclasses.fields(law) if f.name != "maths"}
    return type(law)(maths=dr, **{name: _make_opaque(value) for name, value in numbers.items()})


def _make_opaque(value: Any) -> Any:
    """Convert one or several numbers to Dr.Jit's, so that a new value needs no new kernel."""
    import drjit as dr
    import mitsuba as mi

    if isinstance(value, tuple):
        return tuple(_make_opaque(number) for number in value)
    opaque = mi.Float(float(value))
    dr.make_opaque(opaque)
    return opaque
