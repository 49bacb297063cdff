"""The density found by a walk down the tree of cuts, whose nodes have four bytes each.

A node, from its lowest bit: 1 for a block; the axis of the cut, 1 bit; where it is cut, 11 bits;
the first of its two parts, 19 bits. A block has its number in place of the cut. [Ergun 2015,
section 6.2] has four bytes more, a cumulative probability for sampling by the tree, which the laws
make needless.
"""

import numpy as np

from brdfkit.errors import BrdfkitError
from brdfkit.host.arrays import Integers, Rows

MOST_PIXELS = 2**11  # along a side
MOST_BLOCKS = 2**18


class TreeOfCuts:
    """The tree as words of 32 bits, and the densities of the blocks."""

    def __init__(self, tree, densities):
        _, columns, _, rows = tree.boxes[0].tolist()
        if max(columns, rows) > MOST_PIXELS or len(densities) > MOST_BLOCKS:
            raise BrdfkitError(
                f"lookup = tree takes maps of at most {MOST_PIXELS}×{MOST_PIXELS} pixels and "
                f"{MOST_BLOCKS} blocks, not {columns}×{rows} and {len(densities)}; give another "
                "lookup, or a smaller map."
            )
        leaf = tree.left < 0
        part = tree.boxes[tree.left]  # the left or the upper one
        across = (part[:, 1] < tree.boxes[:, 1]).astype(int)
        split = np.where(across, part[:, 1], part[:, 3])
        words = np.where(leaf, 0, across << 1 | split << 2 | tree.left << 13)
        words[leaf] = 1 | np.arange(leaf.sum()) << 1
        self.words, self.densities = Integers(words), Rows(densities)
        self.nbytes = 4 * (len(words) + len(densities))

    def density(self, x, y, active):
        import drjit as dr
        import mitsuba as mi

        x, y = dr.detach(x), dr.detach(y)

        def further(word):
            split, left = mi.Float((word >> 2) & 0x7FF), word >> 13
            beyond = dr.select((word >> 1) & 1 == 1, x, y) >= split
            return (self.words.at(left + dr.select(beyond, mi.UInt32(1), mi.UInt32(0)), active),)

        start = self.words.at(mi.UInt32(0), active)
        (word,) = dr.while_loop((start,), lambda word: (word & 1 == 0) & active, further)
        return self.densities.at(word >> 1, active=active)
