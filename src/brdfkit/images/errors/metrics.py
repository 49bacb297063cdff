"""The metrics of pictures: what they are called, and which way is better."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from brdfkit.core.colours import to_srgb
from brdfkit.images.errors.colour_difference import ciede2000, delta_e_itp
from brdfkit.images.errors.flip import flip
from brdfkit.images.errors.masks import crop_to_mask
from brdfkit.images.errors.psnr import psnr

RADIUS = 5  # of the window [pixels]: 11 × 11, a Gaussian of σ = 1.5, as in the paper


def ssim(reference, picture, mask):
    """The mean structural similarity over the mask and R, G, B of sRGB in 0..1 [Wang et al. 2004].

    Equal pictures have 1.     Raises `ImportError` without the package scikit-image.
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
    """A metric: its column's `title`, the `function` (reference, picture, mask), the `digits` that
    are shown, whether `more` is better, and the `package` that it needs, if any."""

    title: str
    function: Callable[[np.ndarray, np.ndarray, np.ndarray], float]
    digits: int
    more: bool = False
    package: str = ""

    def text(self, value):
        """A value of the metric as text; a dash for nan."""
        return "-" if np.isnan(value) else f"{value:.{self.digits}f}"

    def exceeds(self, value, floor):
        """Whether an error is more than the noise floor's; also where either is unknown."""
        return not (value >= floor if self.more else value <= floor)


def _percentile_of(differences, share):
    """The metric that takes a percentile of per-pixel `differences`."""

    def of(reference, picture, mask):
        return float(np.percentile(differences(reference[mask], picture[mask]), share))

    return of


METRICS = {
    "psnr": Metric("PSNR [dB]", psnr, 1, more=True),
    "delta_e_2000": Metric("ΔE2000 [median]", _percentile_of(ciede2000, 50), 2),
    "delta_e_2000_95": Metric("ΔE2000 [95 %]", _percentile_of(ciede2000, 95), 2),
    "delta_e_itp_95": Metric("ΔE ITP [95 %]", _percentile_of(delta_e_itp, 95), 2),
    "flip": Metric("FLIP", flip, 4, package="flip-evaluator"),
    "ssim": Metric("SSIM", ssim, 4, more=True, package="scikit-image"),
}
