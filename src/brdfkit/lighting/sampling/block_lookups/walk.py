"""Walks down the tree of blocks: to find the block around a point, or to draw a point.

A point that is drawn moves with the uniform number along the axis of each cut, stretched by the
shares of the two parts. So points that are evenly spread stay so, and strata are kept.

A node has four numbers, read at once: where it is cut, along which axis, the first of its parts,
and the share of that part in the node; a block has its mean density, and 0 as its part between its
two slopes. [Ergun 2015,
section 6.2] packs a node into eight bytes, for maps of at most 2048 pixels a side and 2¹⁸ blocks;
here it has sixteen, and no limits.
"""

import numpy as np

from brdfkit.lighting.sampling.block_slopes import draw, line
from brdfkit.mitsuba_bridge.arrays import Rows


class Walk:
    """A `Tree`, and the densities of its blocks, relative to an even one, and their slopes."""

    def __init__(self, tree, densities, slopes):
        leaf, left = tree.left < 0, tree.left.clip(0)
        x0, x1, y0, y1 = tree.boxes.T
        probability = np.zeros(len(leaf))
        probability[leaf] = densities * ((x1 - x0) * (y1 - y0))[leaf]
        for node in np.flatnonzero(~leaf)[::-1]:  # parts stand behind the whole
            probability[node] = probability[left[node]] + probability[left[node] + 1]
        down = x1[left] == x1
        cut = np.where(down, y1[left], x1[left])
        share = probability[left] / np.maximum(probability, 1e-300)
        nodes = np.stack([cut, down, left, share], axis=1)
        nodes[leaf] = np.column_stack([densities, slopes[:, 0], 0 * densities, slopes[:, 1]])
        self.nodes, self.nbytes = Rows(nodes), 16 * len(leaf)
        self.whole = tree.boxes[0].tolist()

    def sample(self, u, active):
        """(x, y, density) of a point drawn by the probabilities of the blocks."""
        import drjit as dr
        import mitsuba as mi

        def further(node, box, u):
            # The part, and the number along the axis of the cut within the part
            down, share = node.y > 0, node.w
            along = dr.select(down, u.y, u.x)
            second = along >= share
            start, size = dr.select(second, share, 0), dr.select(second, 1 - share, share)
            along = dr.minimum((along - start) / size, 1)
            u = mi.Vector2f(dr.select(down, u.x, along), dr.select(down, along, u.y))
            return *self._part(node, box, second, active), u

        start = *self._whole(active), mi.Vector2f(u)
        node, box, u = dr.while_loop(start, lambda node, box, u: (node.z > 0) & active, further)
        s, t = draw(u.x, node.y), draw(u.y, node.w)
        density = node.x * line(s, node.y) * line(t, node.w)
        return dr.lerp(box.x, box.y, s), dr.lerp(box.z, box.w, t), density

    def density(self, x, y, active):
        """The density at a point."""
        import drjit as dr

        x, y = dr.detach(x), dr.detach(y)

        def further(node, box):
            return self._part(node, box, dr.select(node.y > 0, y, x) >= node.x, active)

        start = self._whole(active)
        node, box = dr.while_loop(start, lambda node, box: (node.z > 0) & active, further)
        s, t = (x - box.x) / (box.y - box.x), (y - box.z) / (box.w - box.z)
        return node.x * line(dr.clip(s, 0, 1), node.y) * line(dr.clip(t, 0, 1), node.w)

    def _whole(self, active):
        """The node of the whole picture, and its bounds."""
        import mitsuba as mi

        return self.nodes.at(mi.UInt32(0), mi.Vector4f, active), mi.Vector4f(self.whole)

    def _part(self, node, box, second, active):
        """The first or the second part of a node, and its bounds."""
        import drjit as dr
        import mitsuba as mi

        cut, down = node.x, node.y > 0
        x0, y0 = (dr.select(second, cut, edge) for edge in (box.x, box.z))
        x1, y1 = (dr.select(second, edge, cut) for edge in (box.y, box.w))
        across, downwards = mi.Vector4f(x0, x1, box.z, box.w), mi.Vector4f(box.x, box.y, y0, y1)
        index = mi.UInt32(node.z) + dr.select(second, mi.UInt32(1), 0)
        return self.nodes.at(index, mi.Vector4f, active), dr.select(down, downwards, across)
