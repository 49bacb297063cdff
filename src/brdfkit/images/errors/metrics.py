"""The metrics of pictures: their titles, functions and directions."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from brdfkit.core.array_types import AnyArray, BoolArray
from brdfkit.core.colours import to_srgb
from brdfkit.images.errors.colour_difference import ciede2000, delta_e_itp
from brdfkit.images.errors.flip import flip
from brdfkit.images.errors.masks import crop_to_mask
from brdfkit.images.errors.psnr import psnr

RADIUS = 5  # pixels: the window is 11 × 11, a Gaussian of σ = 1.5, as in the paper


def ssim(reference: AnyArray, picture: AnyArray, mask: BoolArray) -> float:
    """Return the mean structural similarity over the mask and R, G, B of sRGB [Wang et al. 2004].

    Equal pictures have 1. Raises `ImportError` without the package scikit-image.
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
    """A metric of pictures.

    `title` is that of its column, `function` takes (reference, picture, mask), `digits` is the
    number of decimals that are shown. `more` says whether a larger value is better; `package` names
    the package that it needs, if any.
    """

    title: str
    function: Callable[[AnyArray, AnyArray, BoolArray], float]
    digits: int
    more: bool = False
    package: str = ""

    def text(self, value: float) -> str:
        """Format a value of the metric; nan becomes a dash."""
        return "-" if np.isnan(value) else f"{value:.{self.digits}f}"

    def exceeds(self, value: float, floor: float) -> bool:
        """Return whether an error is worse than the noise floor, or either is unknown."""
        return not (value >= floor if self.more else value <= floor)


def _percentile_of(
    differences: Callable[[AnyArray, AnyArray], AnyArray], share: float
) -> Callable[[AnyArray, AnyArray, BoolArray], float]:
    """Return the metric that takes a percentile of per-pixel `differences`."""

    def of(reference: AnyArray, picture: AnyArray, mask: BoolArray) -> float:
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
