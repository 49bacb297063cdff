"""Values of τ and of marches that were computed apart, in double precision, to all their digits."""

from functools import cache

import numpy as np
from brdfkit.theses.balint2019.dense import dense
from brdfkit.theses.balint2019.rivals import NEWTON_STEPS, tau_inverse
from brdfkit.theses.balint2019.scenes import MARCHES
from drjit.llvm import Array3f64, Float64
from scipy.integrate import quad

from brdfkit.core.jit.threads import in_turn
from brdfkit.distance_fields import plane, sphere
from brdfkit.distance_fields.shadows import LightCone
from brdfkit.distance_fields.shadows.monte_carlo import compute_monte_carlo_shadow
from brdfkit.distance_fields.shadows.tau import lit_disc_share
from brdfkit.theses.claims import Claim, verdict
from brdfkit.theses.page import Section, Table

SECONDS = 1
RAYS = 100_000
SLOPE = 0.3  # r of the plane through the apex
# March and 1 / ε → shares and steps, in the directions A and B, of `SPHERE` in `cone()`
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
DIGIT = 0.5001e-6  # one of the shares, 146 / 256, ends in a 5 behind it
SPHERE = sphere(0.3).at(0.35, 0, 2.5)
TEXT = """A cone of length 6 with radii 0.02 and 1, and in its way a half-space whose plane goes
through the apex, or a sphere of radius 0.3 at (0.35, 0, 2.5). The thesis prints no such values;
these were computed apart, by a program that shares no line with brdfkit. 146/256, the last share of
`discrete`, ends in a 5, which is rounded up or down."""


@in_turn
def run(sources, report):
    """The values, and the claims on them."""
    rows, equal = [], 0
    for done, ((name, n), expected) in enumerate(SHARES_AND_STEPS.items()):
        found = shares_and_steps(name, n)
        equal += agree(found, expected)
        rows.append((name, f"1/{n}", *(in_words(values) for values in (found, expected))))
        report(done, len(SHARES_AND_STEPS))
    model = dense(SPHERE, cone())
    true = compute_monte_carlo_shadow(SPHERE, cone(), RAYS, hit=1e-5).visible[0]
    caption = (
        "Shares of the light and steps, in the directions A and B. Dense search: r_min = "
        f"{model.r[0]:.6f} at t = {model.t[0]:.5f}, τ(r_min) = {model.visible[0]:.6f}, apart "
        f"0.116583, 2.50667, 0.574051. The light that truly arrives is {true:.4f}, by 10⁶ random "
        "rays apart 0.7123: ε bounds the error of the march, not that of the model, one straight "
        "edge."
    )
    table = Table(("march", "ε", "here", "apart"), rows, caption)
    claims = [share_claim(), inverse_claim(), plane_claim(), sphere_claim(equal)]
    return Section("Check values", TEXT, claims, [table])


@cache
def cone():
    """The cone of all check values."""
    return LightCone(Array3f64(0, 0, 0), Array3f64(0, 0, 1), Float64(6), Float64(0.02), Float64(1))


def shares_and_steps(name, n):
    """Of the sphere by a march with ε = 1 / n: shares in the directions A and B, and steps."""
    found = [MARCHES[name](SPHERE, cone(), 1 / n, direction) for direction in "AB"]
    return *(s.visible[0] for s in found), *(int(s.evaluations[0]) for s in found)


def agree(found, expected):
    """Whether shares are equal to all printed digits, and steps altogether."""
    near = np.abs(np.subtract(found[:2], expected[:2])).max() <= DIGIT
    return bool(near) and found[2:] == expected[2:]


def in_words(values):
    a, b, steps_a, steps_b = values
    return f"{a:.6f}, {b:.6f} ({steps_a}, {steps_b})"


def share_claim():
    """τ against its integral."""
    places = np.linspace(-0.99, 0.99, 45)
    areas = [quad(lambda x: 2 * np.sqrt(1 - x * x), -1, r)[0] / np.pi for r in places]
    off = max(abs(lit_disc_share(float(r)) - area) for r, area in zip(places, areas, strict=True))
    return Claim(
        "Behind a straight edge a disc's lit share is τ(r) = ½ + (r √(1 - r²) + arcsin r) / π.",
        "4.1",
        "the formula",
        f"off by {off:.0e} from the area by quadrature",
        verdict(off < 1e-7),
    )


def inverse_claim():
    """τ⁻¹, and how it is found."""
    shares = np.linspace(0, 1, 10_001)
    off = np.abs(np.array(lit_disc_share(tau_inverse(Float64(shares)))) - shares).max()
    return Claim(
        "Newton's method cannot invert τ, because its slope is 0 at both ends.",
        "4.1",
        "bisection",
        f"{NEWTON_STEPS} steps of Newton's, off by {off:.0e} at most",
        verdict(off > 1e-6),
        "With r = ±cos(y/2) the equation is y - sin y = π - π |2 m - 1|, which Newton's method "
        "solves from the root of y³/6. Forty bisections made `base` 15 times as slow as `linear`.",
    )


def plane_claim():
    """The plane through the apex."""
    tan = float(cone().tan[0])
    sin = SLOPE * tan
    normal = np.array([np.sqrt(1 - sin**2), 0, sin])
    field = plane(normal).translate(-normal * sin * 0.02 / tan)
    names = "base", "linear", "convex"
    shares = [MARCHES[m](field, cone(), 1 / 30, d).visible[0] for m in names for d in "AB"]
    true = lit_disc_share(SLOPE / np.sqrt(1 - sin**2))
    return Claim(
        "Behind a plane through the apex the marches give τ(r), whatever ε is.",
        "4.1",
        "0.688081 at r = 0.3, computed apart",
        f"{min(shares):.6f} to {max(shares):.6f}",
        verdict({f"{share:.6f}" for share in shares} == {"0.688081"}),
        f"`discrete` gives multiples of ε. The true share is {true:.6f}: the thesis takes the "
        "plane for parallel to the axis.",
    )


def sphere_claim(equal):
    """The sphere; `equal`: how many rows of it are."""
    return Claim(
        "Shares and steps of the algorithms, as they are meant, on a sphere.",
        "Algorithms 3-5",
        f"{len(SHARES_AND_STEPS)} settings in two directions, computed apart",
        f"{equal} of {len(SHARES_AND_STEPS)} equal to all digits",
        verdict(equal == len(SHARES_AND_STEPS)),
    )
