"""A small tree of boxes (BVH), built in NumPy within a millisecond and walked without a stack.

The tree is complete: 2^k leaves, the spare ones empty. Node 1 is the root, the children of node i
are 2 i and 2 i + 1, so no links are stored. After the subtree of node i comes the node whose number
is i + 1 without the zeros at the end of its binary form; where that is 1, the walk ends.
"""

import numpy as np

from brdfkit.mitsuba_bridge.arrays import Integers, Rows

ROOT, END = 1, 0  # END: what follows the last subtree


class Hierarchy:
    """A tree over `n` boxes, with corners `low` and `high` (n, 3); each is in one leaf."""

    def __init__(self, low, high):
        import drjit as dr
        import mitsuba as mi

        order = _order(low, high)
        self.leaves = mi.UInt32(len(order))
        dr.make_opaque(self.leaves)  # one kernel for any number of boxes
        self.order = Integers(np.maximum(order, 0))
        self.low = Rows(_nodes(_leaves(low, order), np.fmin))
        self.high = Rows(_nodes(_leaves(high, order), np.fmax))

    def any_hit(self, ray, test, active=True):
        """(whether the ray hits anything between its origin and its `maxt`, reads of maps).

        test : a function (box's number, active) → (whether the ray hits what is in the box, reads
            of maps that this took).
        """
        import drjit as dr
        import mitsuba as mi

        def visit(node, hit, reads):
            leaf, number = self._next_leaf(node, ray)
            hit_here, more = test(number, leaf != END)
            hit_here = hit_here & (leaf != END)
            onward = dr.select(leaf != END, after(leaf), END)
            return onward, dr.select(hit_here, mi.UInt32(1), mi.UInt32(0)), reads + more

        start = dr.select(active, mi.UInt32(ROOT), mi.UInt32(END))
        with dr.suspend_grad():  # shadows have edges, of which such a test has no derivative
            _, hit, reads = dr.while_loop(
                (start, mi.UInt32(0), mi.UInt32(0)),
                lambda node, hit, reads: (node != END) & (hit == 0),
                visit,
            )
        return hit == 1, reads

    def _next_leaf(self, node, ray):
        """(the first leaf whose box a ray hits, from `node` on in the walk, its box's number).

        The leaf is `END` where there is none.
        """
        import drjit as dr
        import mitsuba as mi

        inverse = dr.rcp(ray.d)

        def step(node, found):
            a = (self.low.at(node, mi.Point3f) - ray.o) * inverse
            b = (self.high.at(node, mi.Point3f) - ray.o) * inverse
            near, far = dr.max(dr.minimum(a, b)), dr.min(dr.maximum(a, b))
            hit = (near <= far) & (far >= 0) & (near <= ray.maxt)
            leaf = node >= self.leaves
            onward = dr.select(hit, dr.select(leaf, node, 2 * node), after(node))
            return onward, dr.select(hit & leaf, mi.UInt32(1), mi.UInt32(0))

        leaf, _ = dr.while_loop(
            (mi.UInt32(node), mi.UInt32(0)),
            lambda node, found: (node != END) & (found == 0),
            step,
        )
        return leaf, self.order.at(leaf - self.leaves, leaf != END)


def after(node):
    """The node that follows the subtree of `node` in the walk; `END` after the last.

    Of 5, the right child of 2, that is 3, the sibling of 2.
    """
    import drjit as dr

    following = (node + 1) >> dr.tzcnt(node + 1)
    return dr.select(following == ROOT, END, following)


def _order(low, high):
    """The numbers of the boxes from the first leaf to the last, -1 for an empty leaf.

    The boxes of a node are sorted along the longest side of the box around their centres, and cut
    in the middle; all nodes of a level at once.
    """
    leaves = 1 << max(int(np.ceil(np.log2(len(low)))), 0)
    order = np.full(leaves, -1)
    order[: len(low)] = np.arange(len(low))
    centres = np.full((leaves, 3), np.nan)  # of empty leaves, which are sorted to the end
    centres[: len(low)] = (low + high) / 2
    size = leaves
    while size > 1:
        groups = centres[order].reshape(-1, size, 3)
        empty = np.isnan(groups)
        extent = np.where(empty, -np.inf, groups).max(1) - np.where(empty, np.inf, groups).min(1)
        axis = extent.argmax(axis=1)[:, None, None]
        along = np.take_along_axis(groups, axis, axis=2)[..., 0]
        ranks = along.argsort(axis=1)
        order = np.take_along_axis(order.reshape(-1, size), ranks, axis=1).reshape(-1)
        size //= 2
    return order


def _leaves(corners, order):
    """The corners (leaves, 3) of the boxes in their `order`; NaN for an empty leaf, which no ray
    hits."""
    return np.where(order[:, None] < 0, np.nan, corners[order])


def _nodes(leaves, combine):
    """The corners (2 * leaves, 3) of all nodes; those of node 0, which does not exist, are 0."""
    levels = [leaves]
    while len(levels[0]) > 1:
        levels.insert(0, combine(levels[0][::2], levels[0][1::2]))
    return np.concatenate([np.zeros((1, 3)), *levels])
