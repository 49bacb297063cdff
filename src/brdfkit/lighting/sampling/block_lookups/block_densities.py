"""The densities at points of blocks, for look-ups that find the number of a block."""

import numpy as np

from brdfkit.lighting.sampling.block_slopes import line
from brdfkit.mitsuba_bridge.arrays import Rows


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
