"""Bilinear percentage-closer filter: as PCF, but the window moves with the point, without steps.

    lit = Σ_ij w_i w_j [z ≤ f_ij],   w = (1 - f, 1 ... 1, f) / (n - 1)

f is where in a texel the window begins; of 3 texels, w = ((1 - f)/2, 1/2, f/2): the mean of the
four bilinear interpolations of [Ergun 2008, 2.2.1.3], which are those that graphics hardware makes
of the comparisons of 2 × 2 texels. The borders of shadows are n - 1 texels wide, and smooth.

[Reeves et al. 1987], [Ergun 2008, 2.2.1.3]
"""

from brdfkit.shadows.maps.window import WIDTH, Windows

SETTINGS = {"width": WIDTH}


class Lookup:
    """The mean of comparisons over a square, `width` - 1 texels along a side; of 1, `depth`'s."""

    def __init__(self, depths, width):
        self.windows, self.width = Windows(depths, width), width

    def lit(self, point):
        """The share of the light that arrives at a `MapPoint`."""
        return self.windows.mean_lit(point, self.weights)

    def weights(self, begin):
        """Of the columns or rows of a window that begins at `begin`, 0 to 1, in its first texel."""
        if self.width == 1:
            return [1.0]
        inner = [1.0] * (self.width - 2)
        return [w / (self.width - 1) for w in (1 - begin, *inner, begin)]
