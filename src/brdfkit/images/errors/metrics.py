"""The metrics by which pictures are compared: functions, titles, and whether more is better."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from brdfkit.core.array_types import AnyArray, BoolArray
from brdfkit.core.colours import to_srgb
from brdfkit.images.errors.colour_difference import ciede2000, delta_e_itp
from brdfkit.images.errors.flip import flip
from brdfkit.images.errors.masks import crop_to_mask
from brdfkit.images.errors.psnr import psnr

RADIUS = 5  # pixels; SSIM's window has 11 × 11, a Gaussian of σ = 1.5 pixels, as in the paper


def ssim(reference: AnyArray, picture: AnyArray, mask: BoolArray) -> float:
    """Return the mean structural similarity (SSIM) over the mask and R, G, B of sRGB.

    It is 1 for equal pictures [Wang et al. 2004]. Raises `ImportError` without the package
    scikit-image.
    """
    from skimage.metrics import structural_similarity

    (first, other), inside = crop_to_mask([reference, picture], mask, margin=RADIUS)
    _, similarity = structural_similarity(
        to_srgb(first).astype(float),
        to_srgb(other).astype(float),
        data_range=1.0,
        channel_axis=-1,
        gaussian_weights=True,
        sigma=1.5,
        use_sample_covariance=False,
        full=True,
    )
    return float(similarity[inside].mean())


@dataclass(frozen=True)
class Metric:
    """A metric that compares a picture with a reference.

    `title`: heading of the metric's column in a table.
    `function`: function (reference, picture, mask) → error.
    `digits`: number of decimals in the table.
    `more`: whether a larger value means a better picture.
    `package`: name of the package that the metric needs, "" if none.
    """

    title: str
    function: Callable[[AnyArray, AnyArray, BoolArray], float]
    digits: int
    more: bool = False
    package: str = ""

    def format_value(self, value: float) -> str:
        """Format a value of the metric for a table; nan becomes a dash."""
        return "-" if np.isnan(value) else f"{value:.{self.digits}f}"

    def exceeds(self, value: float, floor: float) -> bool:
        """Return whether an error is worse than the noise floor, or one of them is unknown."""
        return not (value >= floor if self.more else value <= floor)


def _make_percentile_metric(
    differences: Callable[[AnyArray, AnyArray], AnyArray], share: float
) -> Callable[[AnyArray, AnyArray, BoolArray], float]:
    """Return a metric: the percentile `share` [%] of the `differences` of two pictures' pixels."""

    def compute_percentile(reference: AnyArray, picture: AnyArray, mask: BoolArray) -> float:
        return float(np.percentile(differences(reference[mask], picture[mask]), share))

    return compute_percentile


METRICS = {
    "psnr": Metric("PSNR [dB]", psnr, 1, more=True),
    "delta_e_2000": Metric("ΔE2000 [median]", _make_percentile_metric(ciede2000, 50), 2),
    "delta_e_2000_95": Metric("ΔE2000 [95 %]", _make_percentile_metric(ciede2000, 95), 2),
    "delta_e_itp_95": Metric("ΔE ITP [95 %]", _make_percentile_metric(delta_e_itp, 95), 2),
    "flip": Metric("FLIP", flip, 4, package="flip-evaluator"),
    "ssim": Metric("SSIM", ssim, 4, more=True, package="scikit-image"),
}
