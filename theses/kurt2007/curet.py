"""Loads the 52 isotropic samples of CUReT, fits models to them, and computes the thesis's error.

The error E, eq. 5.13, is the root of a weighted sum of squared differences between model and
measurement, each times the cosine of the incident direction.
"""

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
from brdfkit.model.parameters import SIGNED
from brdfkit.regression import losses


def compute_error(model, samples):
    """Return the thesis's error E of a model at measured `Samples`, summed over the channels."""
    plain, squared = compute_lobe_values(model, samples.wi, samples.wo)
    weights = to_weight_matrix(model)
    return compute_value_error(plain @ weights + squared @ weights**2, samples)


def compute_value_error(values, samples):
    """Return the thesis's error E of BRDF values (n, channels) at measured `Samples`."""
    squares = ((values - samples.values) * samples.wi[:, 2:]) ** 2
    return float(np.sqrt(losses.named["kurt"].importance(samples) @ squares.sum(axis=1)))


# Samples that the thesis leaves out: papers, straw, cloths, corn husk, woods and bark
ANISOTROPIC = 38, 40, 42, 44, 46, 51, 54, 56, 58
NUMBERS = tuple(n for n in range(1, 62) if n not in ANISOTROPIC)
# The thesis's lobe widths are at most 0.5; it fits polynomials by bisquare weights without cosines,
# and Koenderink's basis by plain least squares
BOUNDS = {name: {"alpha_u": (0.001, 0.5)} for name in ("ward", "ward_duer")}
PLAIN = replace(losses.named.by_sample["plain"], name="plain sum", measure="samples")
BISQUARE, OLS, WLS = (PLAIN, "bisquare"), (PLAIN, None), ("kurt", None)
METHODS = {"bisquare": BISQUARE, "least squares": OLS, "weighted by eq. 5.13": WLS}


@cache
def make_signed_model(label):
    """Return a model's class with weights of any sign, as the thesis lets k_d and k_s have."""
    model = labels.model(label)
    weights = {name: replace(model.parameters[name], bounds=SIGNED) for name in model.weights()}
    return type(f"Signed{model.__name__}", (model,), weights)


class Sample:
    """A sample of CUReT, with its 189 values at angles below 80° and the weights of eq. 5.13."""

    def __init__(self, sources, number):
        self.data = load(f"{sources.find_file('curet/abrdf.dat')}#{number}")
        self.samples = select_samples(self.data, 80)
        self.wi, self.wo = self.samples.wi, self.samples.wo
        self.values, self.cosines = self.samples.values[:, 0], self.wi[:, 2]
        self.weights = losses.named["kurt"].weights(self.cosines)
        self.fits = {}

    def fit(self, label, how=WLS, signed=False):
        """Return the `Fit` of a model, made once; `how` holds the loss and the robust weight.

        If `signed`, the weights may have any sign.
        """
        if (label, how, signed) not in self.fits:
            loss, robust = how
            found = fit(
                self.data,
                make_signed_model(label) if signed else label,
                loss=loss,
                robust=robust,
                bounds=BOUNDS.get(label),
                extrapolate="free",
            )
            self.fits[label, how, signed] = found
        return self.fits[label, how, signed]

    def compute_error(self, label, how=WLS, signed=False):
        """Return the thesis's error E of a model's fit to the sample."""
        return compute_error(self.fit(label, how, signed).model, self.samples)

    def compute_value_error(self, values):
        """Return the thesis's error E of BRDF values (n,) at the sample's directions."""
        return compute_value_error(values[:, None], self.samples)

    def weigh_by_root(self, columns):
        """Return columns (n, k) and the measured values, times the roots of the thesis's weights.

        The squared differences of these make up the thesis's error E.
        """
        root = np.sqrt(self.weights) * self.cosines
        return columns * root[:, None], self.values * root

    def solve_coefficients(self, columns):
        """Return the coefficients (k,) of columns (n, k) with the thesis's least error E, of any
        sign.
        """
        return np.linalg.lstsq(*self.weigh_by_root(columns), rcond=None)[0]


@cache
def load_sample(sources, number):
    """Return the `Sample` of a number; equal calls share it and its fits."""
    return Sample(sources, number)


def load_samples(sources):
    """Return the 52 isotropic samples by number."""
    return {number: load_sample(sources, number) for number in NUMBERS}


def compute_errors(sources, label, how=WLS, report=None, signed=False):
    """Return the thesis's error E (52,) of a model's fits to all samples."""
    found = []
    for done, data in enumerate(load_samples(sources).values()):
        found.append(data.compute_error(label, how, signed))
        if report:
            report(done + 1, len(NUMBERS))
    return np.array(found)


def evaluate_lobes(name, shapes, wi, wo):
    """Return the lobes (n, lobes) of a model, for shape parameters beyond brdfkit's bounds as well.

    The thesis lets exponents be 0.
    """
    bound = labels.model(name).bind({n: double_precision.to_scalar(v) for n, v in shapes.items()})
    wi, wo = double_precision.to_vector(wi), double_precision.to_vector(wo)
    values = [np.asarray(lobe.eval(wi, wo)) for _, lobe in bound.terms()]
    return np.stack([np.broadcast_to(v, len(np.asarray(wi.x))) for v in values], axis=1)


def find_scale(data, printed):
    """Return the factor from our error of a sample to the thesis's, summed over three channels.

    It is the median over the seven models of printed / ours, with weights of any sign; `printed`
    maps names to errors.
    """
    names = [n for n in SEVEN if np.isfinite(printed[n])]
    return np.median([printed[n] / data.compute_error(SEVEN[n], signed=True) for n in names])
