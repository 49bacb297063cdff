"""Colour differences of pixels: ΔE2000 and, for high dynamic range, ΔE ITP."""

from typing import Any

import numpy as np

from brdfkit.core.array_types import AnyArray

TO_XYZ = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])
WHITE_XYZ = np.array([0.3127 / 0.3290, 1, 0.3583 / 0.3290])  # white D65, by its x and y
# Luminance [cd/m²] of the value 1: that of white paper in HDR pictures, by Report ITU-R BT.2408
WHITE = 203.0
# Matrices from XYZ to BT.2020, from BT.2020 to LMS, and from LMS after PQ's curve to ITP
# [ITU-R 2019]
TO_2020 = np.array(
    [
        [1.7166512, -0.3556708, -0.2533663],
        [-0.6666844, 1.6164812, 0.0157685],
        [0.0176399, -0.0427706, 0.9421031],
    ]
)
TO_LMS = np.array([[1688, 2146, 262], [683, 2951, 462], [99, 309, 3688]]) / 4096
TO_ITP = np.array([[2048, 2048, 0], [3305, -6806.5, 3501.5], [17933, -17390, -543]]) / 4096


def ciede2000(reference: AnyArray, picture: AnyArray) -> AnyArray:
    """Return the colour differences ΔE2000 (...) of colours in linear sRGB (..., 3).

    A difference of 1 is just visible; black and white differ by 100 [Luo et al. 2001]. Values above
    white are not clipped, so that highlights can differ. The result is nan where a value is not
    finite.
    """
    with np.errstate(invalid="ignore"):
        return _compare_lab(_to_lab(reference), _to_lab(picture))


def delta_e_itp(reference: AnyArray, picture: AnyArray) -> AnyArray:
    """Return the colour differences ΔE ITP (...) of colours in linear sRGB (..., 3).

    A difference of 1 is just visible under the best conditions [ITU-R 2019]. The metric is made for
    high dynamic range, and needs absolute luminances: the value 1 is taken as 203 cd/m².
    """
    with np.errstate(invalid="ignore"):
        return 720 * np.linalg.norm(_to_itp(reference) - _to_itp(picture), axis=-1)


def _to_lab(rgb: AnyArray) -> tuple[Any, Any, Any]:
    """Convert linear sRGB (..., 3) to CIE L*, a* and b*, each (...)."""
    t = rgb @ TO_XYZ.T / WHITE_XYZ
    f = np.where(t > (6 / 29) ** 3, np.cbrt(t), t * (29 / 6) ** 2 / 3 + 4 / 29)
    x, y, z = np.moveaxis(f, -1, 0)
    return 116 * y - 16, 500 * (x - y), 200 * (y - z)


def _compare_lab(first: tuple[Any, Any, Any], other: tuple[Any, Any, Any]) -> AnyArray:
    """Return ΔE2000 of two colours (L*, a*, b*), in the symbols of [Luo et al. 2001]."""
    (L1, a1, b1), (L2, a2, b2) = first, other
    G = 0.5 * (1 - _chroma_share((np.hypot(a1, b1) + np.hypot(a2, b2)) / 2))
    a1, a2 = (1 + G) * a1, (1 + G) * a2
    C1, C2 = np.hypot(a1, b1), np.hypot(a2, b2)
    h1, h2 = (np.degrees(np.arctan2(b, a)) % 360 for a, b in ((a1, b1), (a2, b2)))
    # Hues are angles, compared along the shorter arc. A grey, without hue, takes the other's hue
    grey = C1 * C2 == 0
    Δh = np.where(grey, 0, (h2 - h1 + 180) % 360 - 180)
    ΔL, ΔC, ΔH = L2 - L1, C2 - C1, 2 * np.sqrt(C1 * C2) * np.sin(np.radians(Δh / 2))
    L, C, h = (L1 + L2) / 2, (C1 + C2) / 2, np.where(grey, h1 + h2, h1 + Δh / 2)
    T = (
        1
        - 0.17 * np.cos(np.radians(h - 30))
        + 0.24 * np.cos(np.radians(2 * h))
        + 0.32 * np.cos(np.radians(3 * h + 6))
        - 0.20 * np.cos(np.radians(4 * h - 63))
    )
    S_L = 1 + 0.015 * (L - 50) ** 2 / np.sqrt(20 + (L - 50) ** 2)
    S_C, S_H = 1 + 0.045 * C, 1 + 0.015 * C * T
    Δθ = 30 * np.exp(-((((h % 360) - 275) / 25) ** 2))
    R_T = -2 * _chroma_share(C) * np.sin(np.radians(2 * Δθ))
    l, c, H = ΔL / S_L, ΔC / S_C, ΔH / S_H
    return np.sqrt(l**2 + c**2 + H**2 + R_T * c * H)


def _chroma_share(C: AnyArray) -> AnyArray:
    """Return the factor √(C⁷ / (C⁷ + 25⁷)) of ΔE2000, near 1 for colours of high chroma C."""
    return np.sqrt(C**7 / (C**7 + 25.0**7))


def _to_itp(rgb: AnyArray) -> AnyArray:
    """Convert linear sRGB (..., 3) to the colour space ITP (..., 3) of ΔE ITP [ITU-R 2019]."""
    y = (WHITE * np.maximum(rgb, 0) @ (TO_LMS @ TO_2020 @ TO_XYZ).T / 10_000) ** (2610 / 16384)
    pq = ((3424 / 4096 + 2413 / 128 * y) / (1 + 2392 / 128 * y)) ** (2523 / 32)
    return pq @ TO_ITP.T
