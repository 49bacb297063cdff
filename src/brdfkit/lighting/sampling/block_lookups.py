"""Look-ups of the density at a point of a map: by a texture of block numbers, a grid, or the tree.

Multiple importance sampling needs the density for directions that BSDFs have drawn. Each class is
made from the `Tree` of blocks, their mean densities (n,) relative to a uniform one, and the slopes
(n, 2) of their densities, in the order of `Tree.blocks`. It has `density(x, y, active)`, and
`nbytes`, the memory of its tables.
"""

import numpy as np

from brdfkit.core.array_types import FloatArray, IntArray, JitFloat, JitInt, JitMask, JitVector
from brdfkit.lighting.sampling.block_slopes import line_density, sample_line_density
from brdfkit.lighting.sampling.tree import Tree, summed_area_table
from brdfkit.mitsuba_bridge.arrays import Integers, Rows, find_cell


class BlockDensities:
    """The linear densities in the blocks of a map, in Mitsuba's memory.

    Block k covers `boxes[k]`, (x0, x1, y0, y1), with the mean density `densities[k]` and the slopes
    `slopes[k]` across and down.
    """

    def __init__(self, boxes: IntArray, densities: FloatArray, slopes: FloatArray) -> None:
        self.boxes = Rows(boxes)
        self.lines = Rows(np.column_stack([densities, slopes]))
        self.nbytes = 28 * len(boxes)

    def density_in_block(
        self, block: JitInt, x: JitFloat, y: JitFloat, active: JitMask
    ) -> JitFloat:
        """Return the sampling density at a point (x, y) that lies in the block with this number."""
        import drjit as dr
        import mitsuba as mi

        box = self.boxes.at(block, mi.Vector4f, active)
        lines = self.lines.at(block, mi.Vector3f, active)
        s = dr.clip((x - box.x) / (box.y - box.x), 0, 1)
        t = dr.clip((y - box.z) / (box.w - box.z), 0, 1)
        return lines.x * line_density(s, lines.y) * line_density(t, lines.z)

    def sample_in_block(
        self, block: JitInt, u: JitFloat, v: JitFloat, active: JitMask
    ) -> tuple[JitFloat, JitFloat, JitFloat]:
        """Draw a point in the block with this number by uniform numbers; return (x, y, density)."""
        import drjit as dr
        import mitsuba as mi

        box = self.boxes.at(block, mi.Vector4f, active)
        lines = self.lines.at(block, mi.Vector3f, active)
        s, t = sample_line_density(u, lines.y), sample_line_density(v, lines.z)
        density = lines.x * line_density(s, lines.y) * line_density(t, lines.z)
        return dr.lerp(box.x, box.y, s), dr.lerp(box.z, box.w, t), density


class TextureLookup:
    """Density look-up by a texture with the block's number for each cell: fastest, most memory."""

    def __init__(self, tree: Tree, densities: FloatArray, slopes: FloatArray) -> None:
        _, self.columns, _, self.rows = tree.boxes[0].tolist()
        texels = _paint_block_numbers(tree.blocks, self.columns, self.rows)
        self.texels = Integers(texels.ravel())
        self.densities = BlockDensities(tree.blocks, densities, slopes)
        self.nbytes = texels.nbytes + self.densities.nbytes

    def density(self, x: JitFloat, y: JitFloat, active: JitMask) -> JitFloat:
        """Return the sampling density at a point (x, y) of the map, relative to a uniform one."""
        index = find_cell(y, self.rows) * self.columns + find_cell(x, self.columns)
        return self.densities.density_in_block(self.texels.at(index, active), x, y, active)


def _paint_block_numbers(blocks: IntArray, columns: int, rows: int) -> IntArray:
    """Return the number (rows, columns) of the block around each cell of the map.

    Sums along rows and columns spread the numbers from the corners of the `blocks` (n, 4).
    """
    x0, x1, y0, y1 = blocks.T
    steps = np.zeros((rows + 1, columns + 1), np.int32)
    numbers = np.arange(len(blocks), dtype=np.int32)
    for y, x, sign in ((y0, x0, 1), (y0, x1, -1), (y1, x0, -1), (y1, x1, 1)):
        np.add.at(steps, (y, x), sign * numbers)
    return summed_area_table(steps[:-1, :-1])[1:, 1:].astype(np.uint32)


class GridLookup:
    """Density look-up by a coarse grid over the map, whose squares list the overlapping blocks.

    There are half as many squares as blocks. A square over small blocks, such as at a sun, lists
    many, which are tested one after the other. [Ergun 2015, section 6.2]
    """

    def __init__(self, tree: Tree, densities: FloatArray, slopes: FloatArray) -> None:
        blocks = tree.blocks
        _, self.width, _, self.height = tree.boxes[0].tolist()
        side = np.sqrt(2 * self.width * self.height / len(blocks))
        self.columns, self.rows = (max(round(n / side), 1) for n in (self.width, self.height))

        lists: list[list[int]] = [[] for _ in range(self.columns * self.rows)]
        x0, x1 = _find_grid_squares(blocks[:, 0], blocks[:, 1], self.columns, self.width)
        y0, y1 = _find_grid_squares(blocks[:, 2], blocks[:, 3], self.rows, self.height)
        for block, (a, b, c, d) in enumerate(zip(x0, x1, y0, y1, strict=True)):
            for row in range(c, d):
                for square in lists[row * self.columns + a : row * self.columns + b]:
                    square.append(block)
        self.first = Integers(np.cumsum([0] + [len(square) for square in lists[:-1]]))
        self.listed = Integers(np.concatenate(lists))
        self.densities = BlockDensities(blocks, densities, slopes)
        self.nbytes = 4 * (len(lists) + sum(map(len, lists))) + self.densities.nbytes

    def density(self, x: JitFloat, y: JitFloat, active: JitMask) -> JitFloat:
        """Return the sampling density at a point (x, y) of the map, relative to a uniform one."""
        import drjit as dr
        import mitsuba as mi

        # A block contains the point if it contains the point's pixel: rounding of x and y cannot
        # put a whole pixel between two blocks
        column, row = (mi.Float(find_cell(a, n)) for a, n in ((x, self.width), (y, self.height)))
        square = find_cell((row + 0.5) * (self.rows / self.height), self.rows) * self.columns
        square = square + find_cell((column + 0.5) * (self.columns / self.width), self.columns)

        def is_outside(i: JitInt) -> JitMask:
            box = self.densities.boxes.at(self.listed.at(i, active), mi.Vector4f, active)
            inside = (column >= box.x) & (column < box.y) & (row >= box.z) & (row < box.w)
            return ~inside & active if dr.is_jit_v(mi.Float) else not inside and active

        first = self.first.at(square, active)
        (i,) = dr.while_loop((first,), is_outside, lambda i: (i + 1,))
        return self.densities.density_in_block(self.listed.at(i, active), x, y, active)


def _find_grid_squares(
    start: IntArray, end: IntArray, count: int, size: int
) -> tuple[IntArray, IntArray]:
    """Return the range of the grid's squares that blocks overlap along an axis: first, last + 1.

    The blocks reach from the cells `start` to `end`. There are `count` squares along `size` cells;
    a cell belongs to the square of its middle.
    """
    first, last = ((a + 0.5) * count / size for a in (start, end - 1))
    return first.astype(int), last.astype(int) + 1


class TreeWalk:
    """A walk down the tree of blocks, which looks up the density at a point, or draws a point.

    To draw, a uniform number chooses one of the two parts at each cut by their probabilities, and
    is stretched to 0 to 1 again. Evenly spread numbers thus give evenly spread points, so that the
    stratification of samplers is kept.

    A node is stored as four numbers, which are read at once: the coordinate of its cut, the cut's
    axis, the index of its first part, and the probability of that part. A block, which has no cut,
    is stored as its mean density, the slope across, 0 in place of an index, and the slope down.
    [Ergun 2015, section 6.2] packs a node into eight bytes, for maps up to 2048 pixels a side and
    2¹⁸ blocks; sixteen bytes have no limits.
    """

    def __init__(self, tree: Tree, densities: FloatArray, slopes: FloatArray) -> None:
        leaf, left = tree.left < 0, tree.left.clip(0)
        x0, x1, y0, y1 = tree.boxes.T
        probability = _sum_parts(tree, densities * ((x1 - x0) * (y1 - y0))[leaf])
        down = x1[left] == x1
        cut = np.where(down, y1[left], x1[left])
        share = probability[left] / np.maximum(probability, 1e-300)
        nodes = np.stack([cut, down, left, share], axis=1)
        nodes[leaf] = np.column_stack([densities, slopes[:, 0], 0 * densities, slopes[:, 1]])
        self.nodes, self.nbytes = Rows(nodes), 16 * len(leaf)
        self.root_box = tree.boxes[0].tolist()

    def sample(self, u: JitVector, active: JitMask) -> tuple[JitFloat, JitFloat, JitFloat]:
        """Draw a point of the map by uniform numbers `u`; return (x, y, density)."""
        import drjit as dr
        import mitsuba as mi

        def descend_to_part(node: JitVector, box: JitVector, u: JitVector) -> tuple[JitVector, ...]:
            # Choose one part of the node, and stretch the random number that chose it to the range
            # 0 to 1 again, for the next choice
            down, share = node.y > 0, node.w
            along = dr.select(down, u.y, u.x)
            second = along >= share
            start, size = dr.select(second, share, 0), dr.select(second, 1 - share, share)
            along = dr.minimum((along - start) / size, 1)
            u = mi.Vector2f(dr.select(down, u.x, along), dr.select(down, along, u.y))
            return *self._get_child_node(node, box, second, active), u

        start = *self._get_root_node(active), mi.Vector2f(u)
        node, box, u = dr.while_loop(
            start, lambda node, box, u: (node.z > 0) & active, descend_to_part
        )
        s, t = sample_line_density(u.x, node.y), sample_line_density(u.y, node.w)
        density = node.x * line_density(s, node.y) * line_density(t, node.w)
        return dr.lerp(box.x, box.y, s), dr.lerp(box.z, box.w, t), density

    def density(self, x: JitFloat, y: JitFloat, active: JitMask) -> JitFloat:
        """Return the sampling density at a point (x, y) of the map, relative to a uniform one."""
        import drjit as dr

        x, y = dr.detach(x), dr.detach(y)

        def descend_to_part(node: JitVector, box: JitVector) -> tuple[JitVector, JitVector]:
            return self._get_child_node(node, box, dr.select(node.y > 0, y, x) >= node.x, active)

        start = self._get_root_node(active)
        node, box = dr.while_loop(start, lambda node, box: (node.z > 0) & active, descend_to_part)
        s, t = (x - box.x) / (box.y - box.x), (y - box.z) / (box.w - box.z)
        s, t = dr.clip(s, 0, 1), dr.clip(t, 0, 1)
        return node.x * line_density(s, node.y) * line_density(t, node.w)

    def _get_root_node(self, active: JitMask) -> tuple[JitVector, JitVector]:
        """Return the tree's root node, which is the whole map, and its bounds (x0, x1, y0, y1)."""
        import mitsuba as mi

        return self.nodes.at(mi.UInt32(0), mi.Vector4f, active), mi.Vector4f(self.root_box)

    def _get_child_node(
        self, node: JitVector, box: JitVector, second: JitMask, active: JitMask
    ) -> tuple[JitVector, JitVector]:
        """Return the first or the `second` part of a node, and the bounds of that part.

        `box` are the bounds (x0, x1, y0, y1) of the node itself.
        """
        import drjit as dr
        import mitsuba as mi

        cut, down = node.x, node.y > 0
        x0, y0 = (dr.select(second, cut, edge) for edge in (box.x, box.z))
        x1, y1 = (dr.select(second, edge, cut) for edge in (box.y, box.w))
        across, downwards = mi.Vector4f(x0, x1, box.z, box.w), mi.Vector4f(box.x, box.y, y0, y1)
        index = mi.UInt32(node.z) + dr.select(second, mi.UInt32(1), 0)
        return self.nodes.at(index, mi.Vector4f, active), dr.select(down, downwards, across)


def _sum_parts(tree: Tree, weights: FloatArray) -> FloatArray:
    """Return the sum (n,) of the blocks' `weights` in each node of a tree."""
    leaf = tree.left < 0
    sums = np.zeros(len(leaf))
    sums[leaf] = weights
    levels = [np.array([0])]  # of nodes, from the whole map downwards
    while len(first := tree.left[levels[-1][~leaf[levels[-1]]]]):
        levels.append(np.concatenate([first, first + 1]))
    for level in levels[::-1]:
        whole = level[~leaf[level]]
        sums[whole] = sums[tree.left[whole]] + sums[tree.left[whole] + 1]
    return sums
