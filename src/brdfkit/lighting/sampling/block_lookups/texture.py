"""The number of its block stored for every cell of the map: as much memory as one channel.

[Ergun 2015, section 6.2] has the density in the fourth channel of a texture, which else lies idle.
"""

import numpy as np

from brdfkit.lighting.sampling.block_lookups.block_densities import BlockDensities
from brdfkit.mitsuba_bridge.arrays import Integers, cell


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
