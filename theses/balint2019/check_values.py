"""Checks shares of the light and steps of marches against independently computed values."""

from functools import cache

import numpy as np
from brdfkit.theses.balint2019.dense import compute_dense_shadow
from brdfkit.theses.balint2019.rivals import NEWTON_STEPS, invert_tau
from brdfkit.theses.balint2019.scenes import MARCHES
from drjit.llvm import Array3f64, Float64
from scipy.integrate import quad

from brdfkit.core.jit.threads import in_turn
from brdfkit.distance_fields import plane, sphere
from brdfkit.distance_fields.shadows import LightCone
from brdfkit.distance_fields.shadows.monte_carlo import compute_monte_carlo_shadow
from brdfkit.distance_fields.shadows.tau import lit_disc_share
from brdfkit.theses.claims import Claim, to_verdict
from brdfkit.theses.page import Section, Table

SECONDS = 1
RAYS = 100_000
PLAIN_STEPS = 10  # of Newton's method for τ itself
SLOPE = 0.3  # the ratio r of the plane through the cone's apex
# March and 1 / ε → shares and steps, in the directions A and B, of `SPHERE` in `make_cone()`
SHARES_AND_STEPS = {
    ("base", 10): (0.574147, 0.576359, 17, 19),
    ("base", 20): (0.574060, 0.574233, 28, 30),
    ("base", 30): (0.574061, 0.574104, 38, 41),
    ("base", 256): (0.574054, 0.574051, 237, 258),
    ("linear", 10): (0.574866, 0.574080, 19, 21),
    ("linear", 20): (0.574492, 0.574581, 32, 35),
    ("linear", 30): (0.574244, 0.574113, 43, 48),
    ("linear", 256): (0.574051, 0.574052, 282, 314),
    ("discrete", 10): (0.500000, 0.500000, 13, 13),
    ("discrete", 20): (0.550000, 0.550000, 22, 23),
    ("discrete", 30): (0.566667, 0.566667, 30, 31),
    ("discrete", 256): (0.570312, 0.570312, 167, 173),
}
DIGIT = 0.5001e-6  # half of the last digit; one of the shares, 146 / 256, is rounded by just that
SPHERE = sphere(0.3).at(0.35, 0, 2.5)
TEXT = """A cone of length 6 with radii 0.02 and 1, and in its way a half-space whose plane goes
through the apex, or a sphere of radius 0.3 at (0.35, 0, 2.5). The thesis prints no such values;
these were computed apart, by a program that shares no line with brdfkit. 146/256, the last share of
`discrete`, ends in a 5, which is rounded up or down."""


@in_turn
def check_claims(sources, report):
    """Check the claims on shares of the light and steps of marches, and return their section."""
    rows, equal = [], 0
    for done, ((name, n), expected) in enumerate(SHARES_AND_STEPS.items()):
        found = march_sphere(name, n)
        equal += is_equal(found, expected)
        rows.append((name, f"1/{n}", *(format_values(values) for values in (found, expected))))
        report(done, len(SHARES_AND_STEPS))
    model = compute_dense_shadow(SPHERE, make_cone())
    true = compute_monte_carlo_shadow(SPHERE, make_cone(), RAYS, hit=1e-5).visible[0]
    caption = (
        "Shares of the light and steps, in the directions A and B. Dense search: r_min = "
        f"{model.r[0]:.6f} at t = {model.t[0]:.5f}, τ(r_min) = {model.visible[0]:.6f}, apart "
        f"0.116583, 2.50667, 0.574051. The light that truly arrives is {true:.4f}, by 2·10⁷ random "
        "rays apart 0.7101: ε bounds the error of the march, not that of the model, one straight "
        "edge."
    )
    table = Table(("march", "ε", "here", "apart"), rows, caption)
    claims = [claim_share(), claim_inverse(), claim_plane(), claim_sphere(equal)]
    return Section("Check values", TEXT, claims, [table])


@cache
def make_cone():
    """Return the cone of shadow rays to a light that all check values use."""
    return LightCone(Array3f64(0, 0, 0), Array3f64(0, 0, 1), Float64(6), Float64(0.02), Float64(1))


def march_sphere(name, n):
    """Return shares of the light and steps of a march past the sphere, in directions A and B.

    The error bound ε of the march is 1 / n.
    """
    found = [MARCHES[name](SPHERE, make_cone(), 1 / n, direction) for direction in "AB"]
    return *(s.visible[0] for s in found), *(int(s.evaluations[0]) for s in found)


def is_equal(found, expected):
    """Return whether shares are equal to all printed digits, and steps altogether."""
    near = np.abs(np.subtract(found[:2], expected[:2])).max() <= DIGIT
    return bool(near) and found[2:] == expected[2:]


def format_values(values):
    a, b, steps_a, steps_b = values
    return f"{a:.6f}, {b:.6f} ({steps_a}, {steps_b})"


def claim_share():
    """Claim that the formula τ(r) is the lit share of a disc behind a straight edge."""
    places = np.linspace(-0.99, 0.99, 45)
    areas = [quad(lambda x: 2 * np.sqrt(1 - x * x), -1, r)[0] / np.pi for r in places]
    off = max(abs(lit_disc_share(float(r)) - area) for r, area in zip(places, areas, strict=True))
    return Claim(
        "Behind a straight edge a disc's lit share is τ(r) = ½ + (r √(1 - r²) + arcsin r) / π.",
        "4.1",
        "the formula",
        f"off by {off:.0e} from the area by quadrature",
        to_verdict(off < 1e-7),
        arithmetic=True,
    )


def claim_inverse():
    """Claim how the formula τ of a disc's lit share can be inverted, and how exactly."""
    shares = np.linspace(0, 1, 10_001)
    found = [invert_tau(Float64(shares)), invert_plainly(shares)]
    off, plain = (np.abs(np.array(lit_disc_share(r)) - shares).max() for r in found)
    return Claim(
        "Newton's method cannot invert τ, because its slope is 0 at both ends.",
        "4.1",
        "bisection",
        f"{PLAIN_STEPS} of its steps for τ itself, from r = 0, are off by {plain:.0e} at most; "
        f"brdfkit's {NEWTON_STEPS} steps for y - sin y are off by {off:.0e}",
        to_verdict(plain > 1e-6),
        "The slope is 0 at the ends, as the thesis says, but no step begins there: above r = 0 τ "
        "lies below its tangents, so that steps from 0 approach the root from one side, even at "
        "the end, three times nearer with each. Ten bisections leave r off by up to 0.001. "
        "brdfkit solves y - sin y = π - π |2 m - 1| for r = ±cos(y/2), from the root of y³/6.",
    )


def invert_plainly(shares):
    """Return r of τ(r) = `shares` by Newton's method for τ itself, which begins at r = 0."""
    r = np.zeros_like(shares)
    for _ in range(PLAIN_STEPS):
        r -= (np.array(lit_disc_share(Float64(r))) - shares) * np.pi / (2 * np.sqrt(1 - r * r))
    return Float64(r)


def claim_plane():
    """Claim that marches give the formula's share of the light behind a plane."""
    tan = float(make_cone().tan[0])
    sin = SLOPE * tan
    normal = np.array([np.sqrt(1 - sin**2), 0, sin])
    field = plane(normal).translate(-normal * sin * 0.02 / tan)
    names = "base", "linear", "convex"
    shares = [MARCHES[m](field, make_cone(), 1 / 30, d).visible[0] for m in names for d in "AB"]
    true = lit_disc_share(SLOPE / np.sqrt(1 - sin**2))
    return Claim(
        "Behind a plane through the apex the marches give τ(r), whatever ε is.",
        "4.1",
        "0.688081 at r = 0.3, computed apart",
        f"{min(shares):.6f} to {max(shares):.6f}",
        to_verdict({f"{share:.6f}" for share in shares} == {"0.688081"}),
        f"`discrete` gives multiples of ε. Seen from the apex the true share is {true:.6f}: the "
        "thesis takes the plane for parallel to the axis.",
        arithmetic=True,
    )


def claim_sphere(equal):
    """Claim that shares and steps on a sphere are right; `equal` counts the equal settings."""
    return Claim(
        "The algorithms, as they are meant, have these shares and steps on a sphere.",
        "Algorithms 3-5",
        f"{len(SHARES_AND_STEPS)} settings in two directions, computed apart",
        f"{equal} of {len(SHARES_AND_STEPS)} equal to all digits",
        to_verdict(equal == len(SHARES_AND_STEPS)),
        arithmetic=True,
    )
