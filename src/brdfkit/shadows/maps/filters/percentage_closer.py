"""Percentage-closer filter (PCF): the share of n × n texels that leave the point lit.

    lit = 1/n² Σ_ij [z ≤ f_ij]

Depths are compared first and averaged then: an average of depths is the depth of nothing. The
borders of shadows are n texels wide, in n² steps, whatever is between the objects; the derivative
by their place is 0 between the steps.

[Reeves et al. 1987], [Ergun 2008, 2.2.1.3]
"""

from brdfkit.shadows.maps.window import WIDTH, Windows

SETTINGS = {"width": WIDTH}


class Lookup:
    """The mean of comparisons over a window of texels, `width` along a side."""

    def __init__(self, depths, width):
        self.windows, self.width = Windows(depths, width), width

    def lit(self, point):
        """The share of the light that arrives at a `MapPoint`."""
        evenly = [1 / self.width] * self.width
        return self.windows.mean_lit(point, lambda begin: evenly)
