"""Walks down the tree of blocks: to find the block around a point, or to draw a point.

A point that is drawn moves with the uniform number along the axis of each cut, stretched by the
shares of the two parts. So points that are evenly spread stay so, and strata are kept.

A node has four numbers, read at once: where it is cut, along which axis, the first of its parts,
and the share of that part in the node; a block has 0 as its part, and its density. [Ergun 2015,
section 6.2] packs a node into eight bytes, for maps of at most 2048 pixels a side and 2¹⁸ blocks;
here it has sixteen, and no limits.
"""

import numpy as np

from brdfkit.host.arrays import Rows


class Walk:
    """A `Tree` and the densities of its blocks, relative to an even one."""

    def __init__(self, tree, densities):
        leaf, left = tree.left < 0, tree.left.clip(0)
        x0, x1, y0, y1 = tree.boxes.T
        probability = np.zeros(len(leaf))
        probability[leaf] = densities * ((x1 - x0) * (y1 - y0))[leaf]
        for node in np.flatnonzero(~leaf)[::-1]:  # parts stand behind the whole
            probability[node] = probability[left[node]] + probability[left[node] + 1]
        share = probability[left] / np.maximum(probability, 1e-300)
        down = x1[left] == x1
        cut = np.where(down, y1[left], x1[left])
        share[leaf] = densities
        self.nodes, self.nbytes = Rows(np.stack([cut, down, left, share], axis=1)), 16 * len(leaf)
        self.whole = tree.boxes[0].tolist()

    def sample(self, u, active):
        """(x, y, density) of a point drawn by the probabilities of the blocks."""
        import drjit as dr
        import mitsuba as mi

        def further(node, box, u):
            # The part, its bounds, and the number along the axis of the cut within the part
            cut, down, share = node.x, node.y > 0, node.w
            along = dr.select(down, u.y, u.x)
            second = along >= share
            start, size = dr.select(second, share, 0), dr.select(second, 1 - share, share)
            along = dr.minimum((along - start) / size, 1)
            u = mi.Vector2f(dr.select(down, u.x, along), dr.select(down, along, u.y))
            x0, y0 = (dr.select(second, cut, edge) for edge in (box.x, box.z))
            x1, y1 = (dr.select(second, edge, cut) for edge in (box.y, box.w))
            across, downwards = mi.Vector4f(x0, x1, box.z, box.w), mi.Vector4f(box.x, box.y, y0, y1)
            return self._part(node, second, active), dr.select(down, downwards, across), u

        start = self._node(mi.UInt32(0), active), mi.Vector4f(self.whole), mi.Vector2f(u)
        node, box, u = dr.while_loop(start, lambda node, box, u: (node.z > 0) & active, further)
        return dr.lerp(box.x, box.y, u.x), dr.lerp(box.z, box.w, u.y), node.w

    def density(self, x, y, active):
        """The density of the block around a point."""
        import drjit as dr
        import mitsuba as mi

        x, y = dr.detach(x), dr.detach(y)

        def further(node):
            return (self._part(node, dr.select(node.y > 0, y, x) >= node.x, active),)

        start = (self._node(mi.UInt32(0), active),)
        return dr.while_loop(start, lambda node: (node.z > 0) & active, further)[0].w

    def _part(self, node, second, active):
        """The first or the second part of a node."""
        import drjit as dr
        import mitsuba as mi

        return self._node(mi.UInt32(node.z) + dr.select(second, mi.UInt32(1), 0), active)

    def _node(self, index, active):
        import mitsuba as mi

        return self.nodes.at(index, mi.Vector4f, active)
