"""A small bounding volume hierarchy, built by NumPy in a millisecond, traversed without a stack.

The tree is complete: it has 2^k leaves, some of which may be empty. Node 1 is the root, and the
children of node i are 2 i and 2 i + 1, so that no links are stored. To find the node that follows
the subtree of node i in the traversal, the trailing zeros of i + 1 in binary form are removed. If
this gives 1, the traversal ends.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

from brdfkit.core.array_types import FloatArray, IntArray, JitInt, JitMask, MitsubaObject
from brdfkit.mitsuba_bridge.arrays import Integers, Rows

ROOT, END = 1, 0  # numbers of the first node, and of the end that follows the last subtree


class Hierarchy:
    """A tree of bounding boxes over n boxes, to find those that a ray hits.

    The boxes have the corners `low` and `high` (n, 3), and each is in one leaf.
    """

    def __init__(self, low: FloatArray, high: FloatArray) -> None:
        import drjit as dr
        import mitsuba as mi

        order = _sort_boxes(low, high)
        self.leaves = mi.UInt32(len(order))
        # Hidden from Dr.Jit's compiler, which would make a kernel for each number of boxes
        dr.make_opaque(self.leaves)
        self.order = Integers(np.maximum(order, 0))
        self.low = Rows(_combine_node_corners(_arrange_corners(low, order), np.fmin))
        self.high = Rows(_combine_node_corners(_arrange_corners(high, order), np.fmax))

    def find_any_hit(
        self,
        ray: MitsubaObject,
        test: Callable[[JitInt, JitMask], tuple[JitMask, JitInt]],
        active: JitMask = True,
    ) -> tuple[JitMask, JitInt]:
        """Return whether a ray hits the content of a box before its `maxt`, and the memory reads.

        `test(number, active)` tests the content of the box with this number: it returns whether
        the ray hits it, and its number of memory reads, which are summed to measure the costs.
        """
        import drjit as dr
        import mitsuba as mi

        def visit_leaf(node: JitInt, hit: JitInt, reads: JitInt) -> tuple[JitInt, JitInt, JitInt]:
            leaf, number = self._find_next_leaf(node, ray)
            hit_here, more = test(number, leaf != END)
            hit_here = hit_here & (leaf != END)
            onward = dr.select(leaf != END, find_next_subtree(leaf), END)
            return onward, dr.select(hit_here, mi.UInt32(1), mi.UInt32(0)), reads + more

        start = dr.select(active, mi.UInt32(ROOT), mi.UInt32(END))
        with dr.suspend_grad():  # visibility is a step function, without derivatives
            _, hit, reads = dr.while_loop(
                (start, mi.UInt32(0), mi.UInt32(0)),
                lambda node, hit, reads: (node != END) & (hit == 0),
                visit_leaf,
            )
        return hit == 1, reads

    def _find_next_leaf(self, node: JitInt, ray: MitsubaObject) -> tuple[JitInt, JitInt]:
        """Return the next leaf, from `node` on, whose box the ray hits, and the box's number.

        The leaf is END if there is none.
        """
        import drjit as dr
        import mitsuba as mi

        inverse = dr.rcp(ray.d)

        def visit_node(node: JitInt, found: JitInt) -> tuple[JitInt, JitInt]:
            a = (self.low.at(node, mi.Point3f) - ray.o) * inverse
            b = (self.high.at(node, mi.Point3f) - ray.o) * inverse
            near, far = dr.max(dr.minimum(a, b)), dr.min(dr.maximum(a, b))
            hit = (near <= far) & (far >= 0) & (near <= ray.maxt)
            leaf = node >= self.leaves
            onward = dr.select(hit, dr.select(leaf, node, 2 * node), find_next_subtree(node))
            return onward, dr.select(hit & leaf, mi.UInt32(1), mi.UInt32(0))

        leaf, _ = dr.while_loop(
            (mi.UInt32(node), mi.UInt32(0)),
            lambda node, found: (node != END) & (found == 0),
            visit_node,
        )
        return leaf, self.order.at(leaf - self.leaves, leaf != END)


def find_next_subtree(node: JitInt) -> JitInt:
    """Return the node that follows the subtree of `node` in the traversal, or END.

    For node 5, the right child of 2, this is 3, the sibling of 2.
    """
    import drjit as dr

    following = (node + 1) >> dr.tzcnt(node + 1)
    return dr.select(following == ROOT, END, following)


def _sort_boxes(low: FloatArray, high: FloatArray) -> IntArray:
    """Assign boxes to the leaves of a tree, so that neighbouring leaves have neighbouring boxes.

    Returns the box's number for each leaf, -1 for an empty leaf. The boxes of a node are sorted
    along the longest side of the bounding box of their centres, and divided in the middle.
    """
    leaves = 1 << max(int(np.ceil(np.log2(len(low)))), 0)
    order = np.full(leaves, -1)
    order[: len(low)] = np.arange(len(low))
    centres = np.full((leaves, 3), np.nan)  # NaN, so that empty leaves are sorted to the end
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


def _arrange_corners(corners: FloatArray, order: IntArray) -> FloatArray:
    """Return the boxes' corners (leaves, 3) in the `order` of leaves; NaN, never hit, if empty."""
    return np.where(order[:, None] < 0, np.nan, corners[order])


def _combine_node_corners(leaves: FloatArray, combine: Callable[[Any, Any], Any]) -> FloatArray:
    """Return the boxes' corners (2 · leaves, 3) of all nodes of a tree, from those of its `leaves`.

    `combine` is np.fmin for lower corners and np.fmax for upper ones. Node 0 is not used.
    """
    levels = [leaves]
    while len(levels[0]) > 1:
        levels.insert(0, combine(levels[0][::2], levels[0][1::2]))
    return np.concatenate([np.zeros((1, 3)), *levels])
