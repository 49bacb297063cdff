"""Checks the sampling of a BSDF: its density, its weights, and that it misses no lobe."""

from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from brdfkit.checks.material_subject import INCIDENCES, Subject, list_incidences
from brdfkit.checks.registry import check_of, larger_or_nan
from brdfkit.checks.variants import stack_channels
from brdfkit.core.array_types import (
    AnyArray,
    FloatArray,
    JitColour,
    JitFloat,
    JitVector,
    MitsubaModule,
    MitsubaObject,
)
from brdfkit.core.discovery.plugin_files import MODELS
from brdfkit.core.geometry.quadrature import TOLERANCE, directional_albedo
from brdfkit.core.jit.padding import pad

# All tests of one check together reject a correct sampler with this probability. Seeds are fixed,
# so a check that has passed will pass again.
SIGNIFICANCE = 0.01
SAMPLES = 1_000_000
# Numbers of the histogram's cells, and of points in a cell at which the density is integrated, both
# along each axis. If a test rejects, it is repeated with more points, which narrow lobes need.
CELLS, SUBCELLS = 48, (16, 64, 128)


@check_of(MODELS)
def check_chi_squared(subject: Subject) -> tuple[bool, str]:
    """Check by Pearson's χ² test that sampled directions have the density `pdf`.

    The test runs at every angle of incidence. Its histogram is over half vectors, where a narrow
    lobe is as round at grazing as at normal incidence. Its cells become smaller towards the normal.
    """
    import drjit as dr
    import mitsuba as mi
    from mitsuba.chi2 import ChiSquareTest, PlanarDomain

    corners = mi.ScalarPoint2f(0, 0), mi.ScalarPoint2f(1, 1)
    domain = PlanarDomain(mi.ScalarBoundingBox2f(*corners))
    p_values, rejected = [], []
    for degrees, wi in list_incidences():
        si = subject.make_interaction(wi)

        def sample(u: Sequence[JitFloat], si: MitsubaObject = si) -> tuple[JitVector, JitFloat]:
            drawn, _ = subject.bsdf.sample(mi.BSDFContext(), si, u[0], mi.Point2f(u[1], u[2]))
            return _map_to_square(mi, drawn.wo, si.wi), dr.select(drawn.pdf > 0, mi.Float(1), 0)

        def pdf(point: JitVector, si: MitsubaObject = si) -> JitFloat:
            wo, jacobian = _map_to_direction(mi, point, si.wi)
            return subject.bsdf.pdf(mi.BSDFContext(), si, wo) * jacobian

        # If the coarser integrals of the density reject, the finest one decides
        for subcells in SUBCELLS:
            test: MitsubaObject = ChiSquareTest(
                domain, sample, pdf, 3, SAMPLES, res=CELLS, ires=subcells
            )
            if test.run(SIGNIFICANCE, test_count=len(INCIDENCES), quiet=True):
                break
        else:
            rejected.append(f"rejected at {degrees}°")
        p_values.append(test.p_value)
    return not rejected, "; ".join([f"smallest p-value {np.min(p_values):.3g}", *rejected])


def _map_to_square(mi: MitsubaModule, wo: JitVector, wi: JitVector) -> JitVector:
    """Map the half vector of two directions to the point (φ_h / 2π, y) of the unit square.

    θ_h = π/2 y³ and φ_h are the polar angle and azimuth of the half vector. The power makes cells
    of the square small near the normal.
    """
    import drjit as dr

    s = wi + wo
    s = s * dr.rsqrt(dr.maximum(dr.dot(s, s), 1e-20))
    # The half vector points down only if a direction is below the surface, where the density is 0
    s = dr.select(s.z < 0, -s, s)
    theta = dr.atan2(dr.sqrt(s.x * s.x + s.y * s.y), s.z)
    phi = dr.atan2(s.y, s.x) / (2 * dr.pi)
    return mi.Point2f(dr.select(phi < 0, phi + 1, phi), (theta / (dr.pi / 2)) ** (1 / 3))


def _map_to_direction(
    mi: MitsubaModule, point: JitVector, wi: JitVector
) -> tuple[JitVector, JitFloat]:
    """Map a point of the unit square to the direction wo, the inverse of `_map_to_square`.

    Returns wo, and the Jacobian of the map, d solid angle / d area.
    """
    import drjit as dr

    sin_phi, cos_phi = dr.sincos(2 * dr.pi * point.x)
    sin_theta, cos_theta = dr.sincos(dr.pi / 2 * point.y**3)
    h = mi.Vector3f(sin_theta * cos_phi, sin_theta * sin_phi, cos_theta)
    cos_d = dr.dot(wi, h)
    jacobian = 4 * cos_d * sin_theta * 2 * dr.pi * (1.5 * dr.pi * point.y**2)
    return 2 * cos_d * h - wi, dr.select(cos_d > 0, jacobian, 0)


@check_of(MODELS)
def check_coverage(subject: Subject) -> tuple[bool, str]:
    """Check that samples miss no lobe: their mean weight equals the numerically integrated albedo.

    The χ² test cannot detect a lobe that neither `sample` nor `pdf` includes.
    """
    worst, where = 0.0, ""
    for degrees, wi in list_incidences():
        weights = stack_channels(sample_weights(subject, wi), SAMPLES).mean(axis=0)
        mean = float(weights.mean())
        expected = float(directional_albedo(subject.eval_expected, wi).mean())
        error = np.hypot(weights.std() / np.sqrt(len(weights)), TOLERANCE * expected)
        deviation = abs(mean - expected) / max(error, 1e-12)
        if deviation >= worst:
            worst, where = deviation, f" at {degrees}° ({mean:.4f} and {expected:.4f})"
    figure = f"mean weight and albedo at most {worst:.1f} standard errors apart{where}"
    return bool(worst < 4.5), figure


@check_of(MODELS)
def check_weights(subject: Subject) -> tuple[bool, str]:
    """Check that samples have the weight eval / pdf, and that eval_pdf equals eval and pdf."""
    import drjit as dr
    import mitsuba as mi

    worst = 0.0
    for _degrees, wi in list_incidences():
        n = 20_000
        si = subject.make_interaction(wi)
        drawn, weight = subject.bsdf.sample(mi.BSDFContext(), si, *draw_uniform_numbers(n, seed=3))
        value, pdf = subject.bsdf.eval_pdf(mi.BSDFContext(), si, drawn.wo)
        value_2 = subject.bsdf.eval(mi.BSDFContext(), si, drawn.wo)
        pdf_2 = subject.bsdf.pdf(mi.BSDFContext(), si, drawn.wo)
        dr.eval(drawn, weight, value, pdf, value_2, pdf_2)  # compiles one kernel, not six

        # Samples below the surface have a density of 0
        valid = np.array(drawn.pdf) > 0
        value, value_2, weight = (stack_channels(x, n)[:, valid] for x in (value, value_2, weight))
        pdf, pdf_2, sample_pdf = (np.array(x)[valid] for x in (pdf, pdf_2, drawn.pdf))
        pairs = [(weight * pdf, value), (value, value_2), (pdf, pdf_2), (pdf, sample_pdf)]
        for a, b in pairs:
            worst = larger_or_nan(worst, float(np.max(np.abs(a - b) / np.maximum(np.abs(b), 1e-6))))
    return worst < 1e-3, f"relative difference at most {worst:.1e}"


def compute_weight_spreads(subject: Subject, samples: int = SAMPLES) -> list[float]:
    """Return the standard deviation of the weights of samples, relative to their mean.

    There is a number for each angle of `INCIDENCES`, from so many `samples`. A small number means
    little noise in a rendering.
    """
    import mitsuba as mi

    # One evaluation for all angles, because tracing it takes longer than some thousand samples
    angles = [wi for _, wi in list_incidences()]
    si = subject.make_interaction(np.repeat(angles, samples, axis=0))
    u = [pad(np.tile(row, len(angles))) for row in _draw_rows(samples, seed=1)]
    _, spectrum = subject.bsdf.sample(mi.BSDFContext(), si, mi.Float(u[0]), mi.Point2f(*u[1:]))
    weights = stack_channels(spectrum, len(u[0])).mean(axis=0).reshape(len(angles), samples)
    spreads: list[float] = (weights.std(axis=1) / weights.mean(axis=1)).tolist()
    return spreads


def sample_weights(
    subject: Subject, wi: FloatArray, samples: int = SAMPLES, seed: int = 1
) -> JitColour:
    """Draw samples of the BSDF at one incident direction, and return their weights."""
    import mitsuba as mi

    si = subject.make_interaction(wi)
    return subject.bsdf.sample(mi.BSDFContext(), si, *draw_uniform_numbers(samples, seed))[1]


def draw_uniform_numbers(n: int, seed: int) -> tuple[JitFloat, JitVector]:
    """Draw the uniform random numbers for `n` samples of a BSDF, as (mi.Float, mi.Point2f)."""
    import mitsuba as mi

    u = _draw_rows(n, seed)
    return mi.Float(u[0]), mi.Point2f(u[1], u[2])


@lru_cache(maxsize=4)  # drawing a million takes as long as some BSDFs take to use them
def _draw_rows(n: int, seed: int) -> list[AnyArray]:
    """Draw three rows (n,) of uniform random numbers that Dr.Jit can read without a copy."""
    return [pad(row) for row in np.random.default_rng(seed).random((3, n), np.float32)]
