"""What the verdict says of the pictures: whether a fit's can be told from the measured one by eye,
and whether another one is nearer."""

from math import isnan

# ΔE: the least difference that is seen side by side, and one that is plain
SEEN, PLAIN = 1.0, 3.0
NOISE = 0.5  # what is less than this part of the noise is not known
DROWNED = 2.0  # times noise that is seen itself: less cannot be told from it


def visibility(errors):
    """Whether the first fit's picture can be told from the measured one, in words.

    `errors`: the `PictureError`s of the fits by metric.
    """
    median, upper = errors["delta_e_2000"], errors["delta_e_2000_95"]
    typical, most = (_without_noise(error) for error in (median, upper))
    if isnan(median.values[0]):
        return "nothing can be said of its picture, which is not finite"
    figures = f"ΔE {median.values[0]:.1f} in the median"
    if not isnan(median.floor):
        figures += f", where noise alone has {median.floor:.1f}"
    if median.floor > SEEN and median.values[0] < DROWNED * median.floor:
        return f"the pictures are too noisy to tell; use more --spp ({figures})"
    if most < NOISE * upper.floor:
        return f"its picture differs by no more than noise ({figures})"
    if most < SEEN:
        return f"its picture cannot be told from the measured one by eye ({figures})"
    if typical < SEEN:
        return f"its picture differs visibly in places only ({figures})"
    if typical < PLAIN:
        return f"its picture differs visibly, side by side ({figures})"
    return f"its picture is plainly another one ({figures})"


def leads_in_picture(psnr):
    """Whether the first fit's picture is nearer than all others, by more than noise."""
    return all(_is_nearer(psnr, 0, other) for other in range(1, len(psnr.values)))


def nearer_in_picture(names, psnr):
    """A sentence where another fit's picture is nearer than the first fit's, by more than noise."""
    nearest = psnr.first
    if nearest is None or not _is_nearer(psnr, nearest, 0):
        return []
    near, own = (psnr.text(psnr.values[place]) for place in (nearest, 0))
    return [
        f"In the picture {names[nearest]} comes nearest: PSNR {near} dB, against {own} dB of "
        f"{names[0]}."
    ]


def _is_nearer(psnr, one, other):
    """Whether fit `one` has the nearer picture than the `other`: the squared difference that noise
    makes is less than that between the two."""
    squares = [10 ** (-value / 10) for value in (psnr.values[one], psnr.values[other], psnr.floor)]
    told = psnr.text(psnr.values[one]) != psnr.text(psnr.values[other])
    return told and squares[1] - squares[0] > squares[2]


def _without_noise(error):
    """The first fit's error less that of noise, if known, which adds to it as squares do."""
    noise = 0.0 if isnan(error.floor) else error.floor
    return max(error.values[0] ** 2 - noise**2, 0.0) ** 0.5
