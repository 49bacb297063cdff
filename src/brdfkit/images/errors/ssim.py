"""Structural similarity of pictures as they are shown [Wang et al. 2004]."""

from brdfkit.core.colours import to_srgb
from brdfkit.images.errors.masks import cropped

RADIUS = 5  # of the window [pixels]: 11 × 11, a Gaussian of σ = 1.5, as in the paper


def ssim(reference, picture, mask):
    """The mean SSIM over the mask and R, G, B of sRGB in 0..1; 1 for equal pictures.

    Raises `ImportError` without the package scikit-image.
    """
    from skimage.metrics import structural_similarity

    (first, other), inside = cropped([reference, picture], mask, margin=RADIUS)
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
