"""Samples a map by alias tables: a row, then a cell of the row, two reads each [Vose 1991].

Every entry of a table is drawn as often as any other. It stands for itself below its threshold, and
for one other entry, its alias, above. One table of all cells would use up the bits of a uniform
number in single precision.
"""

import numpy as np

from brdfkit.lighting.sampling.power_map import cell_power
from brdfkit.mitsuba_bridge.arrays import Integers, Rows, cell


class Alias:
    """Alias tables of the rows, and of the cells of each row."""

    def __init__(self, brightness):
        power = cell_power(brightness)
        self.rows, self.columns = power.shape
        tables = [alias_table(row) for row in power]
        self.by_row = _Table(*alias_table(power.sum(axis=1)))
        self.by_cell = _Table(*(np.concatenate(part) for part in zip(*tables, strict=True)))
        self.densities = Rows(power.ravel() / power.mean())
        self.nbytes = 4 * power.size + self.by_row.nbytes + self.by_cell.nbytes

    def sample(self, u, active):
        import mitsuba as mi

        row, y = self.by_row.choose(u.y, 0, self.rows, active)
        column, x = self.by_cell.choose(u.x, row * self.columns, self.columns, active)
        density = self.densities.at(row * self.columns + column, active=active)
        return mi.Float(column) + x, mi.Float(row) + y, density

    def density(self, x, y, active):
        index = cell(y, self.rows) * self.columns + cell(x, self.columns)
        return self.densities.at(index, active=active)


class _Table:
    def __init__(self, thresholds, aliases):
        self.thresholds, self.aliases = Rows(thresholds), Integers(aliases)
        self.nbytes = 8 * len(thresholds)

    def choose(self, u, first, count, active):
        """(Entry, what is left of `u`) of the table of `count` entries that begins at `first`."""
        import drjit as dr
        import mitsuba as mi

        entry = cell(u * count, count)
        rest = u * count - mi.Float(entry)
        threshold = self.thresholds.at(first + entry, active=active)
        own = rest < threshold
        left = dr.select(own, rest, rest - threshold)
        left = left / dr.maximum(dr.select(own, threshold, 1 - threshold), 1e-7)
        return dr.select(own, entry, self.aliases.at(first + entry, active)), dr.clip(left, 0, 1)


def alias_table(weights):
    """Thresholds (n,) and aliases (n,) of `weights` (n,) ≥ 0; even ones if all are 0.

    Light entries, below the mean, are filled up by the heavy ones in their order; so sums of what
    is missing and of what is over say who fills up whom.

    >>> [part.tolist() for part in alias_table(np.array([1.0, 3.0]))]
    [[0.5, 1.0], [1, 1]]
    """
    n, total = len(weights), weights.sum()
    share = weights * (n / total) if total > 0 else np.ones(n)
    thresholds, aliases = np.ones(n), np.arange(n)
    light, heavy = np.flatnonzero(share < 1), np.flatnonzero(share >= 1)
    if min(len(light), len(heavy)) == 0:  # even, but for rounding
        return thresholds, aliases
    missing, over = np.cumsum(1 - share[light]), np.cumsum(share[heavy] - 1)
    last = len(heavy) - 1
    # A light entry is filled up by the heavy one that is not used up when its turn comes
    thresholds[light] = share[light]
    turn = np.searchsorted(over, missing - (1 - share[light]), side="right")
    aliases[light] = heavy[np.minimum(turn, last)]
    # The light entry that uses a heavy one up leaves it short, and the next heavy one fills it up
    by = np.searchsorted(missing, over, side="right")
    short = np.flatnonzero((by < len(light)) & (np.arange(last + 1) < last))
    thresholds[heavy[short]] = 1 - (missing[by[short]] - over[short])
    aliases[heavy[short]] = heavy[short + 1]
    return thresholds.clip(0, 1), aliases
