"""Checks brdfkit against the thesis's formulas of chapters 2 and 3, at independently computed
values.
"""

from dataclasses import replace

import numpy as np
from brdfkit.theses.ergun2008.trapezoid import CORNERS, SQUARE, map_trapezoid_to_square
from drjit.llvm import Float64

from brdfkit.core.jit.llvm import use_variant
from brdfkit.core.jit.threads import in_turn
from brdfkit.core.projective.camera import Camera
from brdfkit.core.projective.homogeneous import make_axes, make_rigid_matrix, project_points
from brdfkit.core.projective.light import Light
from brdfkit.shadows.maps.filters.bilinear_percentage_closer import Lookup
from brdfkit.shadows.maps.line_of_sight import LineOfSight
from brdfkit.shadows.maps.moments.bounds import bound_by_two_moments
from brdfkit.shadows.maps.placement import Placement
from brdfkit.shadows.maps.projection import Projection
from brdfkit.shadows.maps.projections import light_space_perspective
from brdfkit.shadows.maps.resolution import texel_area_in_pixels
from brdfkit.shadows.maps.split_planes import compute_split_planes
from brdfkit.shadows.volumes.volume import extrude_points
from brdfkit.theses.claims import Claim, to_verdict
from brdfkit.theses.page import Section

SECONDS = 1
DIGIT = 1e-6  # the tolerance of values, which are known to six digits
TEXT = """The thesis prints formulas and few values. These were computed apart, from the formulas
with their misprints corrected, by a program that shares no line with brdfkit. Our figures are those
of the code that renders."""
ABOVE = Light(np.array([0, 0, 1.0, 0]))


@in_turn
def check_claims(sources, report):
    """Check the claims on formulas of shadows at known values; return their section of the page."""
    use_variant()
    checks = (
        claim_infinity,
        claim_depths,
        claim_trapezoid,
        claim_two_planes,
        claim_bilinear,
        claim_splits,
        claim_best_warp,
        claim_footprint,
        claim_levels,
    )
    return Section("Check values", TEXT, [replace(check(), arithmetic=True) for check in checks])


def make_camera(eye, target, near=1.0, far=100.0, slope=1.0):
    """Return a `Camera` at `eye` that looks at `target`."""
    back = np.subtract(eye, target) / np.linalg.norm(np.subtract(eye, target))
    return Camera(
        make_rigid_matrix(make_axes(back, [0, 0, 1]), np.array(eye, float)), slope, slope, near, far
    )


def claim_agreement(says, where, expected, found, shown="{:.6f}"):
    """Claim that values agree to `DIGIT`; `shown` is their format."""
    expected, found = np.ravel(expected), np.ravel(found)
    off = np.abs(expected - found).max()
    printed, ours = (", ".join(map(shown.format, values)) for values in (expected, found))
    return Claim(says, where, printed, f"{ours}; off by {off:.0e}", to_verdict(off <= DIGIT))


def claim_infinity():
    camera = Camera(np.eye(4), 0.5, 0.4, 0.1, 10)
    points = np.random.default_rng(3).normal(size=(1000, 3)) - [0, 0, 6]
    ends = extrude_points(points, Light(np.array([0, 0, 3, 1.0])), 0) @ camera.infinite_projection.T
    depth = ends[:, 2] / ends[:, 3]
    return claim_agreement(
        "No point at infinity is clipped by P∞: its depth is 1.",
        "2.1.8",
        [1.0, 1.0],
        [depth.min(), depth.max()],
    )


def claim_depths():
    z = np.array([1, 2, 10, 50, 99, 100.0])
    found = project_points(make_camera((0, 0, 0), (0, 1, 0)).matrix, np.outer(z, [0, 1, 0]))[:, 2]
    expected = [-1, 0.010101010, 0.818181818, 0.979797980, 0.999795918, 1]
    return claim_agreement(
        "z' = (f + n) / (f - n) - 2 f n / ((f - n) z), of z = 1, 2, 10, 50, 99, 100.",
        "3.1.3",
        expected,
        found,
    )


def claim_trapezoid():
    """Claim that the map N_T takes a trapezoid to a square, however it is turned.

    It is computed by the thesis's eight steps, and as the perspective that renders.
    """
    off = 0.0
    for angle in (0, 0.7, 2.5):
        turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        placed = np.eye(4)
        placed[:2, :2], placed[:2, 3] = turn, (3, -5)
        corners = CORNERS @ turn.T + (3, -5)
        points = [(x, y, z) for x, y in corners for z in (-1, 1)]
        mapped = project_points(map_trapezoid_to_square(corners), points)[:, :2]
        off = max(off, np.abs(mapped[::2] - SQUARE).max())
        # The line of sight goes from the sides' apex, (0.1, 1.35), to the narrow side's middle
        to_sight = np.array([[-1, 0, 0, 0.1], [0, -1, 0, 0.6], [0, 0, 1, 0], [0, 0, 0, 1.0]])
        below = Light(-ABOVE.point)
        sight = LineOfSight(to_sight @ np.linalg.inv(placed), below, np.array(points), None, None)
        u, v, _ = sight.make_warped_projection(1.35 - 0.6).project(*np.transpose(points))
        off = max(off, np.abs(np.column_stack([-u, -v]) - mapped).max())
    found = project_points(map_trapezoid_to_square(), [(0, 0, 0), (0, 0.4, 0.25), (0, -0.7, 0)])
    expected = [(-0.022222222, -1 / 3, 0), (-0.115789474, 0.368421053, 0.197368421)]
    expected += [(0.053658537, -0.902439024, 0)]
    inner = np.abs(found - expected).max()
    return Claim(
        "N_T maps a trapezoid to the square, however it is turned.",
        "2.2.2.4",
        "corners of the square, and three points within",
        f"corners, and the map that renders, off by {off:.0e}; points by {inner:.0e}",
        to_verdict(max(off, inner) <= DIGIT),
    )


def claim_two_planes():
    d_1, d_2, p = 1.0, 2.0, np.array([0.1, 0.25, 0.5, 0.9])
    mean, square = p * d_2 + (1 - p) * d_1, p * d_2**2 + (1 - p) * d_1**2
    found = bound_by_two_moments(Float64(mean), Float64(square), Float64(d_2))
    return claim_agreement(
        "Of an occluder above a receiver the bound of the variance is the lit share itself.",
        "2.2.1.4",
        p,
        np.array(found, float),
    )


def claim_bilinear():
    import mitsuba as mi

    compared, off = np.random.default_rng(1).integers(0, 2, (3, 3)), 0.0
    lookup = Lookup(mi.TensorXf(np.zeros((3, 3))), 3)
    for f_x, f_y in np.random.default_rng(2).random((100, 2)):
        c = (1 - f_x) * compared[:, :-1] + f_x * compared[:, 1:]
        d = (1 - f_y) * c[:-1] + f_y * c[1:]
        weights = np.outer(lookup.window_weights(f_y), lookup.window_weights(f_x))
        off = max(off, abs(d.mean() - (weights * compared).sum()))
    return Claim(
        "Four bilinear mixtures of 3 × 3 comparisons, and their mean.",
        "2.2.1.3",
        "weights (1 - f)/2, 1/2, f/2",
        f"off by {off:.0e} for 100 places",
        to_verdict(off < DIGIT),
    )


def claim_splits():
    found = [compute_split_planes(1, 100, 4, s)[1:-1] for s in ("logarithmic", "uniform", "mean")]
    expected = [3.16227766, 10, 31.6227766, 25.75, 50.5, 75.25, 14.45613883, 30.25, 53.4363883]
    return claim_agreement(
        "Planes of four parts from 1 to 100: logarithmic, uniform, and their mean.",
        "2.2.3.4",
        expected,
        found,
        "{:.4f}",
    )


def claim_best_warp():
    camera = make_camera((0, 0, 0), (0, 1, 0), 1.0, 10.0, 0.5)
    place = Placement(camera, ABOVE, np.array([-20, -1, -20.0]), np.array([20, 10, 20.0]))

    def compute_ratios(apex):
        warped = light_space_perspective.make_projection(place, apex)
        ends = [
            [
                warped.directional_derivative(p, (1.0, 0, 0))[0],
                warped.directional_derivative(p, (0, 1.0, 0))[1],
            ]
            for p in ((0.3, 1.0, 0.2), (2.0, 10.0, -1.0))
        ]
        return np.abs(np.divide(*ends))

    return claim_agreement(
        "LiSPSM from 1 to 10: texels near over far, across and along; and with n = 10⁷ times.",
        "2.2.2.3",
        [np.sqrt(10), 10, 1, 1],
        [*compute_ratios(1.0), *compute_ratios(1e7)],
    )


def claim_footprint():
    eyes = np.array([0.0, 3, 2]), np.array([0.0, -1, 4])
    light, eye = (
        Projection.from_matrix(make_camera(p, (0, 0, 0)).matrix, Light(np.append(p, 1)))
        for p in eyes
    )
    area = texel_area_in_pixels((light, 64), (eye, (64, 64)), (0, 0, 0), (0, 0, 1))
    lengths = [abs(1 / p.directional_derivative((0, 0, 0), (0, 1, 0))[1]) for p in (light, eye)]
    return claim_agreement(
        "A texel beside a pixel: d r_s cosβ / (d_i r_i cosα), and the ratio of areas.",
        "3.1.1",
        [1.5294117647, 1.3374317886],
        [lengths[0] / lengths[1], area],
    )


def claim_levels():
    """State the printed PSNRs as errors of grey levels."""
    found = 255 * 10 ** (-np.array([24.35, 30.5, 51.03]) / 20)
    return Claim(
        "24.35, 30.5 and 51.03 dB as errors of grey levels.",
        "4.2.3",
        "15.45, 7.61, 0.716 of 255",
        ", ".join(f"{level:.3g}" for level in found),
        to_verdict(np.allclose(found, [15.45, 7.61, 0.716], rtol=1e-3)),
    )
