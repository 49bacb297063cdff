"""Cases of fits: a full table, few samples, the thesis's 364 fits, and their memory."""

import os
import time
from functools import cache, lru_cache, partial
from pathlib import Path

import numpy as np
from scipy.optimize import minimize

import brdfkit as bk
from brdfkit.model.samples import Table

from .memory import read_resident_memory, reset_peak
from .rows import SAMPLES

# (model, loss, robust) of the fits of a full table
FITS = (
    ("ward_duer", "cosine", None),
    ("ggx", "cosine", None),
    ("ggx+ggx", "log", None),
    ("koenderink", "log", None),
    ("sgd", "log", None),
    ("koenderink:order=8", "plain", "bisquare"),
    ("pca_polynomial:degree=7", "plain", "bisquare"),
    ("ggx", "log", "bisquare"),
)
LOSSES = "cosine", "log"  # of the fits whose memory is measured
FEW = 200  # samples of a small fit
MERL = 90, 90, 180  # cells of a full table
NOISE = 0.05  # relative, of made samples


@cache
def make_full_table():
    """Return a material that comes with brdfkit, at the resolution of a MERL file."""
    table = Table(np.full((*MERL, 3), np.nan))
    wi, wo = table.directions()
    above = (wi[..., 2] > 0) & (wo[..., 2] > 0)
    table.values[above] = bk.load("car_paint").eval(wi[above], wo[above])
    return bk.Measured.from_table(table.values, name="car_paint, full size")


def fit_ward_duer_with_scipy(samples):
    """Return α of `ward_duer`, fitted by "cosine" in a few lines, from one start of SLSQP."""
    h = samples.wi + samples.wo
    tan2 = (h[:, 0] ** 2 + h[:, 1] ** 2) / h[:, 2] ** 2
    cos_i, cos_o = samples.wi[:, 2], samples.wo[:, 2]
    w = np.sqrt(1 - cos_i**2) * samples.weight * cos_i**2

    def error(x):
        """Return the squared loss with the best weights, at a logarithm of α, `x` (1,)."""
        alpha = np.exp(x[0])
        S = np.exp(-tan2 / alpha**2) / (4 * np.pi * alpha**2 * cos_i * cos_o)
        T = np.stack([np.full_like(S, 1 / np.pi), S])
        gram, moment = (T * w) @ T.T, (T * w) @ samples.values
        return (w @ samples.values**2).sum() - (moment * np.linalg.solve(gram, moment)).sum()

    found = minimize(error, [np.log(0.2)], method="SLSQP", bounds=[(np.log(0.001), 0)])
    return float(np.exp(found.x[0]))


def prepare_scipy_fit(make_material):
    """Return the fit of `ward_duer` by plain SciPy to the samples of a material."""
    from brdfkit.materials.measured.selection import select_samples

    return partial(fit_ward_duer_with_scipy, select_samples(make_material(), 80.0))


def prepare_table_fit(model, loss, robust):
    """Return a fit of a full table."""
    return partial(bk.fit, make_full_table(), model, loss=loss, robust=robust)


@lru_cache(maxsize=2)
def make_samples(count):
    """Return a made material: noisy values of `ggx` at random pairs of directions."""
    random = np.random.default_rng(0)
    wi, wo = (draw_directions(random, count) for _ in range(2))
    material = bk.models()["ggx"](
        diffuse_reflectance=(0.1, 0.2, 0.3), specular_reflectance=(0.5, 0.5, 0.5), alpha_u=0.2
    )
    values = material.eval(wi, wo)
    values = values * (1 + NOISE * random.standard_normal(values.shape))
    return bk.Measured.from_samples(wi, wo, np.maximum(values, 0), name=f"{count} samples")


def draw_directions(random, count):
    """Return random directions (count, 3) within 80° of the normal."""
    z, phi = random.uniform(np.cos(np.radians(80)), 1, count), random.uniform(0, 2 * np.pi, count)
    r = np.sqrt(1 - z**2)
    return np.stack([r * np.cos(phi), r * np.sin(phi), z], axis=-1)


def prepare_fit_of_samples(count):
    """Return a fit of `ggx` to made samples by the default loss, which tells what the first took.

    The first fit of a material finds the extents of its samples, too, and compiles.
    """
    fit = partial(bk.fit, make_samples(count), "ggx")
    began = time.perf_counter()
    fit()
    told = {"first": time.perf_counter() - began}

    def fit_again():
        fit()
        return told

    return fit_again


def prepare_curet():
    """Return the thesis's fits: 52 samples of CUReT by seven models."""
    from brdfkit.theses.kurt2007.curet import NUMBERS
    from brdfkit.theses.kurt2007.printed import SEVEN

    file = Path(os.environ["BRDFKIT_DATA"]) / "curet" / "abrdf.dat"
    samples = [bk.load(f"{file}#{number}") for number in NUMBERS]

    def fit_all():
        for model in SEVEN.values():
            for sample in samples:
                bk.fit(sample, model, loss="cosine")

    return fit_all


def prepare_memory(model, loss):
    """Return a fit of a full table that tells its largest memory [MB] above the imports."""
    bk.fit(make_samples(FEW), model, loss=loss)
    before = read_resident_memory()
    table = make_full_table()

    def fit_and_read_peak():
        reset_peak()
        bk.fit(table, model, loss=loss)
        return {"MB": (read_resident_memory(peak=True) - before) / 1e6, "unit": "MB"}

    return fit_and_read_peak


def name_fit(model, loss, robust):
    """Return the name of a case."""
    return "fits: " + " ".join(filter(None, (model, loss, robust)))


CASES = {name_fit(*fit): partial(prepare_table_fit, *fit) for fit in FITS}
CASES |= {
    "fits: SciPy": partial(prepare_scipy_fit, make_full_table),
    "fits: few": partial(prepare_fit_of_samples, FEW),
    "fits: few, SciPy": partial(prepare_scipy_fit, partial(make_samples, FEW)),
    "fits: CUReT": prepare_curet,
}
CASES |= {f"memory: ggx {loss}": partial(prepare_memory, "ggx", loss) for loss in LOSSES}
for count in SAMPLES:
    CASES |= {
        f"samples {count}: ggx": partial(prepare_fit_of_samples, count),
        f"samples {count}: SciPy": partial(prepare_scipy_fit, partial(make_samples, count)),
    }
