"""The density found by a coarse grid over the map: each square lists the blocks that overlap it.

Half as many squares as blocks. Where blocks are small, at a sun, a square lists many, which are
tried one after the other. [Ergun 2015, section 6.2]
"""

import numpy as np

from brdfkit.lighting.sampling.block_slopes import line
from brdfkit.mitsuba_bridge.arrays import Integers, Rows, cell


class BlockDensities:
    """Of `boxes` (n, 4), their mean densities (n,) and their slopes (n, 2)."""

    def __init__(self, boxes, densities, slopes):
        self.boxes = Rows(boxes)
        self.lines = Rows(np.column_stack([densities, slopes]))
        self.nbytes = 28 * len(boxes)

    def at(self, block, x, y, active):
        """The density at a point of the block of this number."""
        import drjit as dr
        import mitsuba as mi

        box = self.boxes.at(block, mi.Vector4f, active)
        lines = self.lines.at(block, mi.Vector3f, active)
        s = dr.clip((x - box.x) / (box.y - box.x), 0, 1)
        t = dr.clip((y - box.z) / (box.w - box.z), 0, 1)
        return lines.x * line(s, lines.y) * line(t, lines.z)


class Grid:
    """Squares of the map, their lists of blocks, and the densities in blocks."""

    def __init__(self, tree, densities, slopes):
        blocks = tree.blocks
        _, self.width, _, self.height = tree.boxes[0].tolist()
        side = np.sqrt(2 * self.width * self.height / len(blocks))
        self.columns, self.rows = (max(round(n / side), 1) for n in (self.width, self.height))

        lists = [[] for _ in range(self.columns * self.rows)]
        x0, x1 = _squares(blocks[:, 0], blocks[:, 1], self.columns, self.width)
        y0, y1 = _squares(blocks[:, 2], blocks[:, 3], self.rows, self.height)
        for block, (a, b, c, d) in enumerate(zip(x0, x1, y0, y1, strict=True)):
            for row in range(c, d):
                for list_ in lists[row * self.columns + a : row * self.columns + b]:
                    list_.append(block)
        self.first = Integers(np.cumsum([0] + [len(list_) for list_ in lists[:-1]]))
        self.listed = Integers(np.concatenate(lists))
        self.densities = BlockDensities(blocks, densities, slopes)
        self.nbytes = 4 * (len(lists) + sum(map(len, lists))) + self.densities.nbytes

    def density(self, x, y, active):
        import drjit as dr
        import mitsuba as mi

        # The same cell for all blocks: on an edge, one of them has it
        column, row = (mi.Float(cell(a, n)) for a, n in ((x, self.width), (y, self.height)))
        square = cell((row + 0.5) * (self.rows / self.height), self.rows) * self.columns
        square = square + cell((column + 0.5) * (self.columns / self.width), self.columns)

        def outside(i):
            box = self.densities.boxes.at(self.listed.at(i, active), mi.Vector4f, active)
            inside = (column >= box.x) & (column < box.y) & (row >= box.z) & (row < box.w)
            return ~inside & active if dr.is_jit_v(mi.Float) else not inside and active

        first = self.first.at(square, active)
        (i,) = dr.while_loop((first,), outside, lambda i: (i + 1,))
        return self.densities.at(self.listed.at(i, active), x, y, active)


def _squares(start, end, count, size):
    """The squares that the pixels from `start` to `end` overlap, of `count` along `size` pixels.

    Pixels lie where their middles are.
    """
    first, last = ((a + 0.5) * count / size for a in (start, end - 1))
    return first.astype(int), last.astype(int) + 1


class Texture:
    """The blocks of a tree by cell, their mean densities and slopes."""

    def __init__(self, tree, densities, slopes):
        _, self.columns, _, self.rows = tree.boxes[0].tolist()
        texels = np.zeros((self.rows, self.columns), np.uint32)
        for block, (x0, x1, y0, y1) in enumerate(tree.blocks.tolist()):
            texels[y0:y1, x0:x1] = block
        self.texels = Integers(texels.ravel())
        self.densities = BlockDensities(tree.blocks, densities, slopes)
        self.nbytes = texels.nbytes + self.densities.nbytes

    def density(self, x, y, active):
        index = cell(y, self.rows) * self.columns + cell(x, self.columns)
        return self.densities.at(self.texels.at(index, active), x, y, active)
