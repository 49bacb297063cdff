"""Eq. 5.52-5.54: where light collides, by Woodcock's fictitious particles."""

import drjit as dr
import numpy as np

from brdfkit.core.errors import BrdfkitError
from brdfkit.core.jit.llvm import use_variant
from brdfkit.core.jit.threads import in_turn
from brdfkit.theses.claims import Claim, verdict
from brdfkit.theses.page import Section, Table
from brdfkit.volumes.light.majorants import Majorants
from brdfkit.volumes.light.tracking import estimate_transmittance, sample_collision

SECONDS = 3
RAYS = 1 << 20
DEPTH = 2.0
MAJORANTS = 3.25, 6.5, 26.0
THROUGH, MEAN, SEEN = 0.0301974, 0.832288, 0.867546  # T, the mean place, ∫ T ds
LOW, BIASED = 1.5, 0.0838  # a majorant that is none, and what comes through then, apart
TALL = np.diag([1.0, 1.0, DEPTH, 1.0])  # from the unit cube to the medium
TEXT = f"""σ(s) = 0.25 + 1.5 s for s from 0 to {DEPTH:g}: exp(-3.5) = 0.030197 of the light comes
through, the mean place of a collision is 0.83229, and a ray of majorant σ̄ looks the volume up
σ̄ ∫ T ds = 0.86755 σ̄ times. {RAYS:,} rays; in brackets how many standard errors the mean is off. The
thesis prints no values."""


@in_turn
def run(sources, report):
    """Tracking by each majorant, and the claims on it."""
    use_variant()
    found = {}
    for done, bound in enumerate(MAJORANTS):
        found[bound] = track(bound)
        report(done + 1, len(MAJORANTS) + 1)
    rows = [(f"{b:g}", *(in_words(m, z) for m, z in f.values())) for b, f in found.items()]
    heads = "majorant", *next(iter(found.values()))
    caption = "The last: the standard deviation of ratio tracking over that of 0 or 1."
    claims = [unbiased_claim(found), cost_claim(found), ratio_claim(found), bound_claim()]
    return Section("Free paths", TEXT, claims, [Table(heads, rows, caption)])


def sigma(p, active=True):
    """σ at points of the world."""
    return 0.25 + 1.5 * p.z


def rays():
    """Along z, from where the medium begins, and a sampler for them."""
    import mitsuba as mi

    zero = dr.zeros(mi.Float, RAYS)
    sampler = mi.load_dict({"type": "independent"}, parallel=False)
    sampler.seed(0, RAYS)
    return mi.Ray3f(mi.Point3f(zero + 0.5, 0.5, 0), mi.Vector3f(0, 0, 1)), sampler


def track(bound):
    """What is measured → its mean, and how many standard errors it is off, by one majorant."""
    ray, sampler = rays()
    majorants = Majorants([[[bound]]], TALL)
    t, lookups = sample_collision(sigma, majorants, ray, 0, DEPTH, sampler)
    share, _ = estimate_transmittance(sigma, majorants, ray, 0, DEPTH, sampler)
    t, lookups, share = np.array(t, float), np.array(lookups, float), np.array(share, float)
    return {
        "comes through": compare(np.isinf(t), THROUGH),
        "by ratio tracking": compare(share, THROUGH),
        "mean place": compare(t[np.isfinite(t)], MEAN),
        "look-ups": compare(lookups, bound * SEEN),
        "error of the ratio": (share.std() / np.sqrt(THROUGH * (1 - THROUGH)), None),
    }


def compare(drawn, expected):
    """The mean, and how many standard errors it is from what is expected."""
    mean = float(np.mean(drawn))
    return mean, (mean - expected) / (np.std(drawn) / np.sqrt(len(drawn)))


def in_words(mean, z):
    """A mean, and how many standard errors it is off."""
    return f"{mean:.2f}" if z is None else f"{mean:.5f} ({z:+.1f})"


def unbiased_claim(found):
    """Whatever the majorant is."""
    off = [f[name][1] for f in found.values() for name in ("comes through", "mean place")]
    return Claim(
        "Woodcock tracking is unbiased, and independent of a rate of sampling.",
        "ch. 5",
        "no figure",
        f"{min(off):+.1f} to {max(off):+.1f} standard errors, for majorants of "
        f"{min(found):g} to {max(found):g}",
        verdict(max(map(abs, off)) < 3.5),
        "Six means; confirmed below 3.5 standard errors.",
    )


def cost_claim(found):
    """Look-ups."""
    counts = [f["look-ups"][0] for f in found.values()]
    off = max(abs(f["look-ups"][1]) for f in found.values())
    return Claim(
        "The cost of Woodcock tracking grows with the majorant.",
        "ch. 5",
        "2.8195, 5.6391, 22.556 look-ups, computed apart",
        ", ".join(f"{c:.4g}" for c in counts),
        verdict(off < 3.5),
        "So a majorant for each coarse cell takes fewer: `single_scattering` has both.",
    )


def ratio_claim(found):
    """The estimate of transmittance along a ray to the light."""
    ratios = [f["error of the ratio"][0] for f in found.values()]
    return Claim(
        "Ratio tracking needs fewer rays for the same error.",
        "ch. 5",
        "named, no figure",
        f"its standard deviation is {min(ratios):.2f} to {max(ratios):.2f} times that of 0 or 1",
        verdict(max(ratios) < 1),
        "The thesis names residual ratio tracking, without a formula. The larger the majorant, the "
        "smaller the deviation, and the more look-ups.",
    )


def bound_claim():
    """A majorant that is below σ."""
    came = printed_scheme(LOW)
    try:
        Majorants([[[LOW]]], TALL).require_extinction_below(sigma)
        said = "nothing is said"
    except BrdfkitError:
        said = "brdfkit refuses the majorant"
    return Claim(
        "The majorant has to be above σ everywhere.",
        "ch. 5",
        f"{BIASED:g} comes through at {LOW:g}, computed apart",
        f"{came:.4f} in place of {THROUGH:.4f}; {said}",
        verdict(abs(came - BIASED) < 0.001 and said.startswith("brdfkit")),
        "The printed scheme goes on with a wrong result, and nothing shows it.",
    )


def printed_scheme(bound):
    """The share that comes through by the printed scheme, which checks no majorant."""
    rng = np.random.default_rng(0)
    s, through = np.zeros(RAYS), 0
    while len(s):
        s = s - np.log1p(-rng.random(len(s))) / bound
        through += np.count_nonzero(s >= DEPTH)
        s = s[s < DEPTH]
        s = s[rng.random(len(s)) >= (0.25 + 1.5 * s) / bound]
    return through / RAYS
