"""Checks Woodcock tracking (eq. 5.52 to 5.54): where light collides in a medium of known
extinction.
"""

import drjit as dr
import numpy as np

from brdfkit.core.errors import BrdfkitError
from brdfkit.core.jit.llvm import use_variant
from brdfkit.core.jit.threads import in_turn
from brdfkit.theses.claims import Claim, to_verdict
from brdfkit.theses.page import Section, Table
from brdfkit.volumes.light.majorants import Majorants
from brdfkit.volumes.light.tracking import estimate_transmittance, sample_collision

SECONDS = 3
RAYS = 1 << 20
DEPTH = 2.0
MAJORANTS = 3.25, 6.5, 26.0
# The transmittance T, the mean place of a collision, and ∫ T ds
THROUGH, MEAN, SEEN = 0.0301974, 0.832288, 0.867546
LOW, BIASED = 1.5, 0.0838  # a majorant below the extinction, and the transmittance by it
TALL = np.diag([1.0, 1.0, DEPTH, 1.0])  # from the unit cube to the medium
TEXT = f"""σ(s) = 0.25 + 1.5 s for s from 0 to {DEPTH:g}: exp(-3.5) = 0.030197 of the light comes
through, the mean place of a collision is 0.83229, and a ray of majorant σ̄ looks the volume up
σ̄ ∫ T ds = 0.86755 σ̄ times. {RAYS:,} rays; in brackets how many standard errors the mean is off. The
thesis prints no values."""


@in_turn
def check_claims(sources, report):
    """Check the claims on Woodcock tracking with several majorants, and return their section."""
    use_variant()
    found = {}
    for done, bound in enumerate(MAJORANTS):
        found[bound] = track_rays(bound)
        report(done + 1, len(MAJORANTS) + 1)
    rows = [(f"{b:g}", *(format_mean(m, z) for m, z in f.values())) for b, f in found.items()]
    heads = "majorant", *next(iter(found.values()))
    caption = "The last: the standard deviation of ratio tracking over that of 0 or 1."
    claims = [claim_unbiased(found), claim_cost(found), claim_ratio(found), claim_bound()]
    return Section("Free paths", TEXT, claims, [Table(heads, rows, caption)])


def evaluate_sigma(p, active=True):
    """Return the medium's extinction σ at points of the world."""
    return 0.25 + 1.5 * p.z


def make_rays():
    """Return rays along z from where the medium begins, and a sampler for them."""
    import mitsuba as mi

    zero = dr.zeros(mi.Float, RAYS)
    sampler = mi.load_dict({"type": "independent"}, parallel=False)
    sampler.seed(0, RAYS)
    return mi.Ray3f(mi.Point3f(zero + 0.5, 0.5, 0), mi.Vector3f(0, 0, 1)), sampler


def track_rays(bound):
    """Return by one majorant the mean of each measured quantity, and its distance from the known
    value.

    The distance is in standard errors.
    """
    ray, sampler = make_rays()
    majorants = Majorants([[[bound]]], TALL)
    t, lookups = sample_collision(evaluate_sigma, majorants, ray, 0, DEPTH, sampler)
    share, _ = estimate_transmittance(evaluate_sigma, majorants, ray, 0, DEPTH, sampler)
    t, lookups, share = np.array(t, float), np.array(lookups, float), np.array(share, float)
    return {
        "comes through": compare_mean(np.isinf(t), THROUGH),
        "by ratio tracking": compare_mean(share, THROUGH),
        "mean place": compare_mean(t[np.isfinite(t)], MEAN),
        "look-ups": compare_mean(lookups, bound * SEEN),
        "error of the ratio": (share.std() / np.sqrt(THROUGH * (1 - THROUGH)), None),
    }


def compare_mean(drawn, expected):
    """Return the mean of drawn values, and its distance from an expected one in standard errors."""
    mean = float(np.mean(drawn))
    return mean, (mean - expected) / (np.std(drawn) / np.sqrt(len(drawn)))


def format_mean(mean, z):
    """Return a mean as text, with its distance from the known value in standard errors."""
    return f"{mean:.2f}" if z is None else f"{mean:.5f} ({z:+.1f})"


def claim_unbiased(found):
    """Claim that tracking is unbiased, whatever the majorant is."""
    off = [f[name][1] for f in found.values() for name in ("comes through", "mean place")]
    return Claim(
        "Woodcock tracking is unbiased, and independent of a rate of sampling.",
        "ch. 5",
        "no figure",
        f"{min(off):+.1f} to {max(off):+.1f} standard errors, for majorants of "
        f"{min(found):g} to {max(found):g}",
        to_verdict(max(map(abs, off)) < 3.5),
        "Six means; confirmed below 3.5 standard errors.",
    )


def claim_cost(found):
    """Claim that the look-ups grow with the majorant."""
    counts = [f["look-ups"][0] for f in found.values()]
    off = max(abs(f["look-ups"][1]) for f in found.values())
    return Claim(
        "The cost of Woodcock tracking grows with the majorant.",
        "ch. 5",
        "2.8195, 5.6391, 22.556 look-ups, computed apart",
        ", ".join(f"{c:.4g}" for c in counts),
        to_verdict(off < 3.5),
        "So a majorant for each coarse cell takes fewer: `single_scattering` has both.",
        arithmetic=True,
    )


def claim_ratio(found):
    """Claim that ratio tracking estimates the transmittance with a smaller deviation."""
    ratios = [f["error of the ratio"][0] for f in found.values()]
    return Claim(
        "Ratio tracking has a smaller deviation than counting the rays that come through.",
        "ch. 5",
        "residual ratio tracking is named, without a formula",
        f"its standard deviation is {min(ratios):.2f} to {max(ratios):.2f} times that of 0 or 1",
        to_verdict(max(ratios) < 1),
        "It cannot be otherwise: its estimate is the mean of theirs. The larger the majorant, the "
        "smaller the deviation, and the more look-ups, which are not counted here. Residual ratio "
        "tracking was not run.",
        arithmetic=True,
    )


def claim_bound():
    """Claim that a majorant below the extinction gives a wrong result, which brdfkit refuses."""
    came = track_as_printed(LOW)
    try:
        Majorants([[[LOW]]], TALL).require_extinction_below(evaluate_sigma)
        said = "nothing is said"
    except BrdfkitError:
        said = "brdfkit refuses the majorant"
    return Claim(
        "The majorant has to be above σ everywhere.",
        "ch. 5",
        f"{BIASED:g} comes through at {LOW:g}, computed apart",
        f"{came:.4f} in place of {THROUGH:.4f}; {said}",
        to_verdict(abs(came - BIASED) < 0.001 and said.startswith("brdfkit")),
        "The printed scheme goes on with a wrong result, and nothing shows it.",
        arithmetic=True,
    )


def track_as_printed(bound):
    """Return the transmittance by the printed scheme, which does not check the majorant."""
    rng = np.random.default_rng(0)
    s, through = np.zeros(RAYS), 0
    while len(s):
        s = s - np.log1p(-rng.random(len(s))) / bound
        through += np.count_nonzero(s >= DEPTH)
        s = s[s < DEPTH]
        s = s[rng.random(len(s)) >= (0.25 + 1.5 * s) / bound]
    return through / RAYS
