"""Judges what the thesis says of its shaded pictures, Figure 6.16, and of their times."""

import numpy as np
from brdfkit.theses.balint2019.measuring import compute_rms
from brdfkit.theses.balint2019.model_errors import CLEAR, SHADE
from brdfkit.theses.balint2019.ray_claims import FASTER

from brdfkit.theses.claims import UNSTATED, Claim, to_verdict
from brdfkit.theses.timing import compare_times

RIVALS = {"quilez": "a", "aaltonen": "a'"}


def claim_dark(pictures):
    """Claim that shadows of the rivals are too large, by pictures of Figure 6.16."""
    b, *others = (np.mean(pictures[n] - pictures["c"]) for n in ("b", *RIVALS.values()))
    ours = " and ".join(f"{a:+.4f} ({m})" for a, m in zip(others, RIVALS, strict=True))
    return Claim(
        "The shadows of Quílez's and Aaltonen's method are too large.",
        "Figure 6.16 a",
        "a picture",
        f"mean radiance {ours} against the share by rays; {b:+.4f} of one march",
        to_verdict(all(a < -2 * abs(b) for a in others)),
        "Confirmed where both are darker by twice what one march is off.",
    )


def claim_near(pictures):
    """Claim that one march is far closer to rays than its rivals, by pictures of Figure 6.16."""
    b, *others = (compute_rms(pictures[n] - pictures["c"]) for n in ("b", *RIVALS.values()))
    ours = " and ".join(f"{a:.4f} ({m})" for a, m in zip(others, RIVALS, strict=True))
    return Claim(
        "One march is far closer to the share by rays than they are.",
        "Figure 6.16 a-c",
        "pictures",
        f"errors {b:.4f} against {ours}",
        to_verdict(b < min(others) / 2),
        "Confirmed below half of both.",
    )


def claim_more_leaks(pictures):
    """Claim that one march lets more light through between objects than rays for the share."""
    bare = np.maximum(pictures["none"], 1e-6)
    march, rays = pictures["b"] / bare, pictures["c"] / bare
    dark = (rays < SHADE) & (pictures["none"] > SHADE)
    most, mean = march[dark].max(initial=0), march[dark].mean() - rays[dark].mean()
    return Claim(
        "One march leaks more light between the objects than rays for the share.",
        "Figure 6.16 b, c",
        "pictures",
        f"up to {most:.2f} of the light is seen where by rays hardly any is, {mean:.3f} more in "
        "the mean",
        to_verdict(most > CLEAR),
        f"Where by rays less than {SHADE:g} of the light arrives; confirmed where more than "
        f"{CLEAR:g} of it is seen.",
    )


def claim_same_leak(errors):
    """Claim that samples decided by a march have the errors of one march."""
    b, c, d = (compute_rms(errors[name]) for name in "bcd")
    return Claim(
        "Samples that a march decides have the errors of one march.",
        "Figure 6.16 d, e",
        "the same leak",
        f"errors {d:.4f} and {b:.4f}; of rays for the share {c:.4f}",
        to_verdict(0.5 < d / b < 1.5),
        "Confirmed from 0.5 to 1.5 times. What is left of c is the BSDF, taken at the middle of "
        "the light.",
    )


def claim_rectangle(errors, few):
    """State how exact samples that a march decides are under a rectangle."""
    f, g, h, e = (compute_rms(errors[name]) for name in ("f", "g", "h", "rays"))
    return Claim(
        "Lights of another shape can be used, by the sphere about them.",
        "5, Figure 6.16 f-h",
        "pictures of a rectangle, and no error",
        f"errors {f:.4f} by a march and {e:.4f} by rays with the same samples, {h:.4f} and {g:.4f} "
        f"with {few}",
        UNSTATED,
        "So samples by a march are about as far off as a third as many by rays: it is the model "
        "that errs, and more samples help little.",
    )


def claim_times(name, what, printed, seconds):
    """Claim how many times as long another picture of Figure 6.16 takes as the one by one march."""
    ours = compare_times(seconds[name], seconds["b"])
    bare, of_march, other = (np.median(seconds[n]) for n in ("none", "b", name))
    alone = (other - bare) / (of_march - bare)
    return Claim(
        f"One march is {printed:.0f} times as fast as {what}.",
        f"Figure 6.16 b, {name}",
        f"{printed:.1f} times as fast",
        f"{ours} times as fast",
        to_verdict(ours.is_at_least(printed)),
        f"{FASTER} It is faster, but not by that much: without shadows the picture takes "
        f"{bare / of_march:.1f} of the time of b already. Less that time, b is about {alone:.0f} "
        "times as fast.",
    )


def claim_faster(march, rays, printed, seconds, what):
    """Claim that samples by a march take less time than samples by rays."""
    ours = compare_times(seconds[rays], seconds[march])
    return Claim(
        f"{what} by a march take less time than by rays.",
        f"Figure 6.16 {min(march, rays)}, {max(march, rays)}",
        f"{printed:.2f} times as fast",
        f"{ours} times as fast",
        to_verdict(ours.is_at_least(printed)),
        FASTER,
    )
