"""Compares single scattering of brdfkit with Mitsuba's `volpath` in ten settings."""

import numpy as np
from brdfkit.theses.lesar2018.volpath_settings import compute_z_scores, make_settings, render_passes

from brdfkit.core.jit.llvm import use_variant
from brdfkit.core.jit.threads import in_turn, use_one_thread
from brdfkit.theses.claims import UNSTATED, Claim, to_verdict
from brdfkit.theses.page import Section, Table

SECONDS = 70
SPP, PASSES = 1024, 12
INTEGRATORS = "single_scattering", "volpath"
SIGNIFICANT = 4.0  # of 120 z-scores, one is larger by chance in one of 130 such tables
FASTER = 8  # times as fast as `volpath`: the speed that brdfkit aims at
TEXT = f"""Pictures of 16 × 16 pixels in {PASSES} passes of {SPP:,} samples, and `volpath` with the
same `max_depth`. A z-score is that of the mean of a quarter of a picture, in one channel. The speed
is that at equal variance: the ratio of variance times the seconds of CPU of the fastest pass, in
one thread. The thesis compares itself with no other renderer."""


@in_turn
def check_claims(sources, report):
    """Check the claims on single scattering and Mitsuba's `volpath`, and return their section."""
    use_variant()
    z, speed = {}, {}
    for name, scene in make_settings().items():
        with use_one_thread():
            both = [
                render_passes(scene, kind, SPP, PASSES, i * PASSES)
                for i, kind in enumerate(INTEGRATORS)
            ]
        z[name] = np.ravel(compute_z_scores(*(found for found, _ in both)))
        ours, theirs = (found.var(axis=0, ddof=1).mean() * s.min() for found, s in both)
        speed[name] = theirs / ours
        report(len(z), 10)
    rows = [
        (
            name,
            f"{z[name].min():+.1f} to {z[name].max():+.1f}",
            f"{np.sqrt(np.mean(z[name] ** 2)):.2f}",
            f"{speed[name]:.1f}",
        )
        for name in z
    ]
    heads = "setting", "z-scores", "root mean square", "times as fast"
    table = Table(heads, rows, "Speed at equal variance.")
    return Section("Against volpath", TEXT, [claim_unbiased(z), claim_speed(speed)], [table])


def claim_unbiased(z):
    """Claim that both integrators have equal means, by z-scores of parts of pictures."""
    found = np.concatenate(list(z.values()))
    return Claim(
        "The method is unbiased.",
        "ch. 5, 8",
        "no figure; volpath, in ten settings",
        f"{len(found)} z-scores of {found.min():+.1f} to {found.max():+.1f}, root mean square "
        f"{np.sqrt(np.mean(found**2)):.2f}",
        to_verdict(np.abs(found).max() < SIGNIFICANT),
        f"Confirmed below {SIGNIFICANT:g}; of right methods the root mean square is near 1. Three "
        "channels each of 40 parts of pictures: in grey media they are not independent.",
    )


def claim_speed(speed):
    """State the speed at equal variance."""
    fast = [name for name, s in speed.items() if s >= FASTER]
    slowest = min(speed, key=speed.get)
    return Claim(
        "Woodcock tracking with importance sampling is fast.",
        "ch. 8",
        f"no figure; brdfkit's own bar is {FASTER} times as fast as volpath",
        f"{speed[slowest]:.1f} ({slowest}) to {max(speed.values()):.1f} times, "
        f"{len(fast)} of {len(speed)} reach {FASTER}",
        UNSTATED,
        "At equal variance. In nine settings light is scattered once. Where the medium is "
        "constant, `single_scattering` inverts the density of a collision, and tracks nothing.",
    )
