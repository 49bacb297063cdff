"""Alias tables, which draw an entry, or a block of a map, in constant time [Vose 1991]."""

import numpy as np

from brdfkit.core.array_types import FloatArray, IntArray, JitFloat, JitInt, JitMask, JitVector
from brdfkit.lighting.sampling.block_lookups import BlockDensities
from brdfkit.mitsuba_bridge.arrays import Integers, Rows, find_cell


class AliasTable:
    """Alias tables, one after another, for drawing entries in proportion to their weights.

    It draws every entry of a table equally often, then keeps the entry if a second random number is
    below the entry's threshold, and otherwise takes the entry's alias, which is another entry.

    `thresholds` (n,) and `aliases` (n,) are those of the entries of all tables.
    """

    def __init__(self, thresholds: FloatArray, aliases: IntArray) -> None:
        self.thresholds, self.aliases = Rows(thresholds), Integers(aliases)
        self.nbytes = 8 * len(thresholds)

    def draw_entry(
        self, u: JitFloat, first: JitInt, count: int, active: JitMask
    ) -> tuple[JitInt, JitFloat]:
        """Draw an entry of the table of `count` entries that begins at `first`, by the number `u`.

        Returns the index of the entry within its table, and a random number that is independent of
        it, made from the remaining digits of `u`.
        """
        import drjit as dr
        import mitsuba as mi

        entry = find_cell(u * count, count)
        remainder = u * count - mi.Float(entry)
        threshold = self.thresholds.at(first + entry, active=active)
        own = remainder < threshold
        left = dr.select(own, remainder, remainder - threshold)
        left = left / dr.maximum(dr.select(own, threshold, 1 - threshold), 1e-7)
        return dr.select(own, entry, self.aliases.at(first + entry, active)), dr.clip(left, 0, 1)


def make_alias_table(weights: FloatArray) -> tuple[FloatArray, IntArray]:
    """Return an alias table of `weights` (n,) ≥ 0: thresholds (n,) and aliases (n,).

    An entry lighter than the mean is filled up to the mean by heavier entries, in order; cumulative
    sums of the deficits and excesses show which heavy entry that is. If all weights are 0, they
    count as equal.

    >>> [part.tolist() for part in make_alias_table(np.array([1.0, 3.0]))]
    [[0.5, 1.0], [1, 1]]
    """
    n, total = len(weights), weights.sum()
    share = weights * (n / total) if total > 0 else np.ones(n)
    thresholds, aliases = np.ones(n), np.arange(n)
    light, heavy = np.flatnonzero(share < 1), np.flatnonzero(share >= 1)
    if min(len(light), len(heavy)) == 0:  # up to rounding, all weights are equal
        return thresholds, aliases
    deficit, excess = np.cumsum(1 - share[light]), np.cumsum(share[heavy] - 1)
    last = len(heavy) - 1
    # A light entry is filled up by the first heavy entry with some excess left
    thresholds[light] = share[light]
    turn = np.searchsorted(excess, deficit - (1 - share[light]), side="right")
    aliases[light] = heavy[np.minimum(turn, last)]
    # A heavy entry that gives away more than its excess is filled up by the next heavy entry
    by = np.searchsorted(deficit, excess, side="right")
    short = np.flatnonzero((by < len(light)) & (np.arange(last + 1) < last))
    thresholds[heavy[short]] = 1 - (deficit[by[short]] - excess[short])
    aliases[heavy[short]] = heavy[short + 1]
    return thresholds.clip(0, 1), aliases


class AliasBlocks:
    """Draws points of a map: first a block by an alias table, then a point by a linear density.

    The blocks (n, 4) are given with their mean densities (n,), relative to a uniform one, their
    `shares` (n,) of the map's power, and the slopes (n, 2) of their densities. Every block takes
    the same time, but successive entries of the table lead to blocks far apart, so that the
    stratification of Mitsuba's samplers is mostly lost.
    """

    def __init__(
        self, blocks: IntArray, densities: FloatArray, shares: FloatArray, slopes: FloatArray
    ) -> None:
        self.count = len(blocks)
        self.table = AliasTable(*make_alias_table(shares))
        self.densities = BlockDensities(blocks, densities, slopes)
        self.nbytes = self.table.nbytes + self.densities.nbytes

    def sample(self, u: JitVector, active: JitMask) -> tuple[JitFloat, JitFloat, JitFloat]:
        """Draw a point of the map by uniform numbers `u`; return (x, y, density)."""
        block, remainder = self.table.draw_entry(u.x, 0, self.count, active)
        return self.densities.sample_in_block(block, remainder, u.y, active)
