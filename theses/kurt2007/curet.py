"""The 52 isotropic samples of CUReT: their fits, and the thesis's error of any of them."""

from dataclasses import replace
from functools import cache

import numpy as np
from brdfkit.theses.kurt2007.printed import SEVEN

from brdfkit.core.jit import double_precision
from brdfkit.fitting.fit import fit
from brdfkit.materials.loading import load
from brdfkit.materials.measured.selection import select_samples
from brdfkit.model import labels
from brdfkit.model.evaluation import compute_lobe_values, to_weight_matrix
from brdfkit.regression import losses


def error(model, samples):
    """E of a model with values at `Samples`, squares summed over the channels."""
    plain, squared = compute_lobe_values(model, samples.wi, samples.wo)
    weights = to_weight_matrix(model)
    return error_of(plain @ weights + squared @ weights**2, samples)


def error_of(values, samples):
    """E of values (n, channels) of a BRDF."""
    squares = ((values - samples.values) * samples.wi[:, 2:]) ** 2
    return float(np.sqrt(losses.named["kurt"].importance(samples) @ squares.sum(axis=1)))


# Ribbed paper, straw, corduroy, linen, cotton, corn husk, two woods and bark, as the thesis says
ANISOTROPIC = 38, 40, 42, 44, 46, 51, 54, 56, 58
NUMBERS = tuple(n for n in range(1, 62) if n not in ANISOTROPIC)
# The thesis's widths are at most 0.5; its polynomials are fitted by bisquare without a cosine, and
# Koenderink's basis by plain least squares
BOUNDS = {name: {"alpha_u": (0.001, 0.5)} for name in ("ward", "ward_duer")}
PLAIN = replace(losses.named.by_sample["plain"], name="plain sum", measure="samples")
BISQUARE, OLS, WLS = (PLAIN, "bisquare"), (PLAIN, None), ("kurt", None)
METHODS = {"bisquare": BISQUARE, "least squares": OLS, "weighted by eq. 5.13": WLS}


class Sample:
    """A sample of CUReT: the 189 values below 80°, and the weights of eq. 5.13."""

    def __init__(self, sources, number):
        self.data = load(f"{sources.path('curet/abrdf.dat')}#{number}")
        self.samples = select_samples(self.data, 80)
        self.wi, self.wo = self.samples.wi, self.samples.wo
        self.values, self.cosines = self.samples.values[:, 0], self.wi[:, 2]
        self.weights = losses.named["kurt"].weights(self.cosines)
        self.fits = {}

    def fit(self, label, how=WLS):
        """The `Fit` of a model; `how`: the loss and the robust weight."""
        if (label, how) not in self.fits:
            loss, robust = how
            found = fit(self.data, label, loss=loss, robust=robust, bounds=BOUNDS.get(label))
            self.fits[label, how] = found
        return self.fits[label, how]

    def error(self, label, how=WLS):
        """E of a fit."""
        return error(self.fit(label, how).model, self.samples)

    def error_of(self, values):
        """E of values (n,) of a BRDF."""
        return error_of(values[:, None], self.samples)

    def rooted(self, columns):
        """Columns (n, k) and values as least squares by E wants them."""
        root = np.sqrt(self.weights) * self.cosines
        return columns * root[:, None], self.values * root

    def solve(self, columns):
        """The best coefficients (k,) of columns (n, k), of any sign as in the thesis."""
        return np.linalg.lstsq(*self.rooted(columns), rcond=None)[0]


@cache
def sample(sources, number):
    """The `Sample` of a number; its fits are kept."""
    return Sample(sources, number)


def samples(sources):
    """The 52 samples by number."""
    return {number: sample(sources, number) for number in NUMBERS}


def errors(sources, label, how=WLS, report=None):
    """E (52,) of a model's fits to all samples."""
    found = []
    for done, data in enumerate(samples(sources).values()):
        found.append(data.error(label, how))
        if report:
            report(done + 1, len(NUMBERS))
    return np.array(found)


def lobes_at(name, shapes, wi, wo):
    """Lobes (n, lobes) of a model at shape parameters that may lie beyond our bounds.

    The thesis lets exponents be 0.
    """
    bound = labels.model(name).bind({n: double_precision.to_scalar(v) for n, v in shapes.items()})
    wi, wo = double_precision.to_vector(wi), double_precision.to_vector(wo)
    values = [np.asarray(lobe.eval(wi, wo)) for _, lobe in bound.terms()]
    return np.stack([np.broadcast_to(v, len(np.asarray(wi.x))) for v in values], axis=1)


def scale(data, printed):
    """The factor from our E of a sample to the thesis's, which sums over three channels.

    The median over the seven models of printed / ours; `printed`: name → error.
    """
    names = [n for n in SEVEN if np.isfinite(printed[n])]
    return np.median([printed[n] / data.error(SEVEN[n]) for n in names])
