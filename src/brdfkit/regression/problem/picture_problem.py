"""What a fit by `Picture` minimises: E² of a model on pixels, and a share of it on samples."""

import math

from brdfkit.core.errors import BrdfkitError
from brdfkit.regression import losses
from brdfkit.regression.problem.pixel_problem import PixelProblem
from brdfkit.regression.problem.problem import Problem
from brdfkit.regression.problem.subset import draw_part

LOG = losses.named.by_sample["log"]
# So many samples stand for all; where starts are compared, fewer do, and a share of the pixels
SAMPLES, FEW_SAMPLES, FEW_PIXELS = 20_000, 2_000, 1 / 12


class PictureProblem(PixelProblem):
    """E² of a model class under a `Picture`, on `Pixels` and on valid `Samples`."""

    def __init__(self, model, samples, picture, space, pixels):
        weights = pixels.weights / (pixels.weights.sum() * samples.values.shape[1])
        of_pixels = pixels, weights, picture.of_pixels
        super().__init__(model, samples, LOG, space, picture.share, *of_pixels)
        self.picture = picture
        if self.clamped:
            raise BrdfkitError(
                f"{model.type_name()}: may be negative, and is clamped at 0 there, so that pixels "
                "are no sums of its lobes; choose another loss, or another model."
            )

    @classmethod
    def of(cls, model, samples, picture, space, pixels, rng):
        """The problem on a part of many samples, which the generator `rng` draws."""
        return cls(model, _part(model, samples, space, SAMPLES, rng), picture, space, pixels)

    def few(self, rng):
        """The same problem on few samples and pixels, by which starts are compared."""
        samples = _part(self.model, self.samples, self.space, FEW_SAMPLES, rng)
        pixels = self.pixels.take_first(math.ceil(len(self.pixels.values) * FEW_PIXELS))
        return PictureProblem(self.model, samples, self.picture, self.space, pixels)


def _part(model, samples, space, size, rng):
    """About `size` of `Samples`, or all where they are not many more."""
    if len(samples.wi) <= 2 * size:
        return samples
    part, _ = draw_part(samples, Problem(model, samples, LOG, space).black, size, rng)
    return part
