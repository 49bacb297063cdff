"""Writes sentences on how visibly the fits' pictures differ from the picture of the measurement."""

from collections.abc import Mapping, Sequence
from math import isnan

from brdfkit.reporting.pictures.picture_errors import PictureError

# Colour differences ΔE: the smallest that is visible side by side, and one that is obvious
VISIBLE, PLAIN = 1.0, 3.0
# An error below this share of the rendering's noise cannot be distinguished from noise
UNKNOWN_SHARE = 0.5
# Visible noise hides an error that is less than this many times the error that noise causes
HIDDEN_RATIO = 2.0


def describe_visibility(errors: Mapping[str, PictureError]) -> str:
    """Return a part of a sentence on how visibly the first fit's picture differs from the measured.

    `errors`: the errors of all fits' pictures, by metric.
    """
    median, upper = errors["delta_e_2000"], errors["delta_e_2000_95"]
    typical, large = (_subtract_noise(error) for error in (median, upper))
    if isnan(median.values[0]):
        return "nothing can be said of its picture, which is not finite"
    figures = f"ΔE {median.values[0]:.1f} in the median"
    if not isnan(median.floor):
        figures += f", where noise alone has {median.floor:.1f}"
    if median.floor > VISIBLE and median.values[0] < HIDDEN_RATIO * median.floor:
        return f"the pictures are too noisy to tell; use more --spp ({figures})"
    if large < UNKNOWN_SHARE * upper.floor:
        return f"its picture differs by no more than noise ({figures})"
    if large < VISIBLE:
        return f"its picture cannot be told from the measured one by eye ({figures})"
    if typical < VISIBLE:
        return f"its picture differs visibly in places only ({figures})"
    if typical < PLAIN:
        return f"its picture differs visibly, side by side ({figures})"
    return f"its picture is plainly another one ({figures})"


def has_nearest_picture(psnr: PictureError) -> bool:
    """Return whether the first fit has the picture nearest to the measurement's.

    The lead before all other fits has to exceed noise.
    """
    return all(_has_nearer_picture(psnr, 0, other) for other in range(1, len(psnr.values)))


def describe_nearest_picture(names: Sequence[str], psnr: PictureError) -> list[str]:
    """Return a sentence if another fit than the first has the nearest picture, else an empty list.

    `names`: names of the fits; `psnr`: PSNR of their pictures. The lead has to exceed noise.
    """
    nearest = psnr.best_index
    if nearest is None or not _has_nearer_picture(psnr, nearest, 0):
        return []
    near, own = (psnr.format_value(psnr.values[k]) for k in (nearest, 0))
    return [
        f"In the picture {names[nearest]} comes nearest: PSNR {near} dB, against {own} dB of "
        f"{names[0]}."
    ]


def _has_nearer_picture(psnr: PictureError, one: int, other: int) -> bool:
    """Return whether fit `one` has a picture nearer to the measurement's than fit `other`.

    `one`, `other`: indices of the fits. The difference of the squared errors of their pictures has
    to exceed the squared error of noise.
    """
    squares = [10 ** (-value / 10) for value in (psnr.values[one], psnr.values[other], psnr.floor)]
    differs = psnr.format_value(psnr.values[one]) != psnr.format_value(psnr.values[other])
    return differs and squares[1] - squares[0] > squares[2]


def _subtract_noise(error: PictureError) -> float:
    """Return the error of the first fit's picture without the part that rendering noise causes.

    The squared errors of fit and noise add up, so their difference is taken.
    """
    noise = 0.0 if isnan(error.floor) else error.floor
    return float(max(error.values[0] ** 2 - noise**2, 0.0) ** 0.5)
