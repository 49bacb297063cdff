"""Computes formulas of the thesis as printed and as they must be meant."""

import numpy as np
from brdfkit.theses.ergun2008.printed import average_cells, read_printed_table
from brdfkit.theses.ergun2008.trapezoid import CORNERS, SQUARE, map_trapezoid_to_square

from brdfkit.core.projective.camera import Camera
from brdfkit.core.projective.homogeneous import make_axes, make_rigid_matrix, project_points
from brdfkit.core.projective.light import Light
from brdfkit.shadows.maps.projection import Projection
from brdfkit.shadows.maps.resolution import area_magnification
from brdfkit.theses.claims import Claim, to_verdict
from brdfkit.theses.page import Section

SECONDS = 1
TEXT = """Each formula is computed as printed and as it must be meant; claims are *not confirmed*
where the printed one fails. brdfkit computes what is meant."""


def check_claims(sources, report):
    """Check the claims on misprinted formulas; return their section of the page."""
    checks = (
        claim_bound,
        claim_shear,
        claim_centre,
        claim_fifth_point,
        claim_depth_matrix,
        claim_footprint_area,
        claim_rotation,
        claim_means,
    )
    return Section("Misprints", TEXT, [check() for check in checks])


def claim_misprint(says, where, wrong, right, why):
    """Claim on a formula that is off by `wrong` as printed, and by `right` as it is meant."""
    ours = f"off by {wrong:.3g}; as it is meant {right:.0e}"
    return Claim(says, where, "the formula", ours, to_verdict(wrong < 1e-4), why, arithmetic=True)


def claim_bound():
    """Claim on the bound p_max of variance shadow maps, whose last bracket is misprinted."""
    d_1, d_2, p = 1.0, 2.0, np.linspace(0.1, 0.9, 9)
    variance = (p - p**2) * (d_2 - d_1) ** 2
    gaps = d_2 - p * d_2**2 - (1 - p) * d_1**2, d_2 - p * d_2 - (1 - p) * d_1
    wrong, right = (np.abs(variance / (variance + gap**2) - p).max() for gap in gaps)
    return claim_misprint(
        "p_max of an occluder at 1 and a receiver at 2 is the lit share p.",
        "2.2.1.4",
        wrong,
        right,
        "The last bracket has squares of depths; it must be (d_2 - p d_2 - (1 - p) d_1)².",
    )


def measure_missed_corners(**as_printed):
    """Return the largest distance of the trapezoid's mapped corners from those of the square."""
    found = project_points(
        map_trapezoid_to_square(**as_printed), np.column_stack([CORNERS, np.zeros(4)])
    )
    return np.abs(found[:, :2] - SQUARE).max()


def claim_shear():
    """Claim that a trapezoid's shear H, a step of mapping it to a square, has a wrong entry."""
    return claim_misprint(
        "H, the shear of a trapezoid, has the entry -x_u / 2.",
        "2.2.2.4, step 4",
        measure_missed_corners(shear_as_printed=True),
        measure_missed_corners(),
        "It must be -x_u / y_u, so that the sides are symmetric about y.",
    )


def claim_centre():
    """Claim that T_3, a step of mapping a trapezoid to a square, divides sums wrongly."""
    return claim_misprint(
        "T_3 moves the middle of a rectangle by -(y_u + y_v) / (w_u + w_v).",
        "2.2.2.4, step 7",
        measure_missed_corners(centre_as_printed=True),
        measure_missed_corners(),
        "The middle of two points is half the sum of their quotients, not the quotient of sums.",
    )


def claim_fifth_point():
    """Claim on the fourth point of the plane, which is lifted to the light or to the eye."""
    light, eye = np.array([-1.0, -0.5, 3]) / np.sqrt(10.25), np.array([0.0, -6, 8])
    corners = np.array([(-3.0, -3, 0), (3, -3, 0), (6, 6, 0), (-6, 6, 0)])
    off = {
        way: np.abs(
            project_points(solve_five_points(light, corners, corners[3] + lift), corners)[3, :2]
            - SQUARE[3]
        ).max()
        for way, lift in {"light": 0.1 * light, "eye": 0.1 * (eye - corners[3])}.items()
    }
    return claim_misprint(
        "POSM moves one of its four points towards the point of view.",
        "2.2.2.5",
        off["eye"],
        off["light"],
        "Only towards the light does the corner of the plane itself stay on the corner of the map: "
        "the sentence is right if its point of view is the light's.",
    )


def solve_five_points(light, corners, lifted):
    """Return the matrix (4, 4) of a plane-optimal map, by five points and their images.

    It takes a light's direction (3,) to infinity, and three of four `corners` of a plane and the
    fourth `lifted` one to the corners of the map.
    """
    rows = [np.kron(row, np.append(light, 0)) for row in np.eye(4)[[0, 1, 3]]]
    targets = np.column_stack([SQUARE, [1, 1, 1, -1]])
    for point, target in zip([*corners[:3], lifted], targets, strict=True):
        equations = np.eye(4)[:3] - target[:, None] * np.eye(4)[3]
        rows += [np.kron(row, np.append(point, 1)) for row in equations]
    *_, vectors = np.linalg.svd(np.array(rows))
    return vectors[-1].reshape(4, 4)


def claim_depth_matrix():
    """Claim on the matrix of depths, which is written for rows and used with columns."""
    n, f = 1.0, 100.0
    a, c, z = (f + n) / (f - n), -2 * f * n / (f - n), np.array([n, f])
    as_printed = np.array([[a, 1], [c, 0]])
    found = [m @ np.stack([z, np.ones(2)]) for m in (as_printed, as_printed.T)]
    wrong, right = (np.abs(top / bottom - [-1, 1]).max() for top, bottom in found)
    return claim_misprint(
        "The matrix (a b; c d) times the column (z, 1) gives near -1 and far 1.",
        "3.1.3",
        wrong,
        right,
        "It is written for rows, which multiply from the left; the results beside it are right.",
    )


def claim_footprint_area():
    """Claim on the growth of a texel's footprint with the distance of the light."""
    ground, areas = ((0.0, 0, 0), (0.0, 0, 1)), []
    for place in np.array([(0, 3, 2), (0, 6, 4)], float):
        back = place / np.linalg.norm(place)
        camera = Camera(make_rigid_matrix(make_axes(back, [0, 0, 1]), place), 1.0, 1.0, 1.0, 100.0)
        light = Light(np.append(place, 1))
        areas.append(1 / area_magnification(Projection.from_matrix(camera.matrix, light), *ground))
    growth = areas[1] / areas[0]
    return Claim(
        "d_s r_s / cosα is the area of a texel on a surface.",
        "3.1.1",
        "the formula: 2 times at twice the distance",
        f"{growth:.4f} times",
        to_verdict(np.isclose(growth, 2)),
        "The formula is that of a length, along the slope; the area is d_s² r_s² / cosα. So Q2, by "
        "4.2.3 a ratio of areas, is not the ratio that 3.1.1 prints.",
        arithmetic=True,
    )


def claim_rotation():
    """Claim on a rotated point, whose last digit is wrong."""
    turn = np.radians(30)
    y = -5 * np.sin(turn) + 8 * np.cos(turn)
    return Claim(
        "(5, 8) in axes that are turned by 30°.",
        "Appendix 2",
        "(8.3301, 4.4281)",
        f"({5 * np.cos(turn) + 8 * np.sin(turn):.4f}, {y:.4f})",
        to_verdict(f"{y:.4f}" == "4.4281"),
        "The last digit is wrong: 4.42820.",
        arithmetic=True,
    )


def claim_means():
    """Claim that Tables 1 and 4 are the means of their cells."""
    tables = {"table_1": read_printed_table("table_1"), "table_4": read_printed_table("table_4")}
    expected = {("texture_use", k): v[:2] for k, v in tables["table_1"].items()}
    expected |= {("aliasing", k): tables["table_1"][k][2:] for k in read_printed_table("aliasing")}
    expected |= {("psnr", k): v for k, v in tables["table_4"].items()}
    off = [
        np.abs(average_cells(read_printed_table(table)[name]) - figures)
        / (1e-4 if table != "aliasing" else 1e-2)
        for (table, name), figures in expected.items()
    ]
    return Claim(
        "Tables 1 and 4 are means of their cells, and of the differences between the lights.",
        "5",
        f"{2 * len(expected)} figures whose cells are in the text",
        f"off by {np.max(off):.2f} of their last digits at most",
        to_verdict(np.max(off) < 1),
        arithmetic=True,
    )
