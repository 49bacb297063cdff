"""The density stored for every cell of the map: one read, and as much memory as one channel.

[Ergun 2015, section 6.2] has it in the fourth channel of a texture, which else lies idle.
"""

import numpy as np

from brdfkit.host.arrays import Rows, cell


class Texture:
    """The densities of the blocks of a tree, by cell."""

    def __init__(self, tree, densities):
        _, self.columns, _, self.rows = tree.boxes[0].tolist()
        texels = np.zeros((self.rows, self.columns), np.float32)
        for (x0, x1, y0, y1), density in zip(tree.blocks.tolist(), densities, strict=True):
            texels[y0:y1, x0:x1] = density
        self.texels, self.nbytes = Rows(texels.ravel()), texels.nbytes

    def density(self, x, y, active):
        index = cell(y, self.rows) * self.columns + cell(x, self.columns)
        return self.texels.at(index, active=active)
