"""Differences in colour, pixel by pixel: ΔE2000 and, for what is brighter than white, ΔE ITP."""

import numpy as np

from brdfkit.colours import colour_science

# Luminance of the value 1 [cd/m²]: the white of paper in HDR pictures, by Report ITU-R BT.2408
WHITE = 203.0


def ciede2000(reference, picture):
    """ΔE2000 (...) of linear sRGB (..., 3) [Luo et al. 2001]: 1 is just seen, black to white 100.

    Values above white are not clipped, so that differences within highlights count. It is nan where
    a value is not finite.
    """
    colour = colour_science()
    to_xyz = colour.RGB_COLOURSPACES["sRGB"].matrix_RGB_to_XYZ
    with np.errstate(invalid="ignore"):
        lab = [colour.XYZ_to_Lab(values @ to_xyz.T) for values in (reference, picture)]
        return colour.delta_E(*lab, method="CIE 2000")


def delta_e_itp(reference, picture):
    """ΔE ITP (...) of linear sRGB (..., 3) [ITU-R 2019]: 1 is seen at best.

    It is made for high dynamic range, and so for absolute luminances: 1 is shown at 203 cd/m².
    """
    colour = colour_science()
    to_xyz = colour.RGB_COLOURSPACES["sRGB"].matrix_RGB_to_XYZ
    shown = [WHITE * np.maximum(values, 0) @ to_xyz.T for values in (reference, picture)]
    return colour.difference.delta_E_ITP(*map(colour.XYZ_to_ICtCp, shown))
