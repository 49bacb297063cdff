"""Judges what the thesis says of one march beside many rays, and beside others of one march."""

import numpy as np
from brdfkit.theses.balint2019 import whole_frames

from brdfkit.theses.claims import NOT_RUN, UNSTATED, Claim, to_verdict
from brdfkit.theses.grid import judge_over_grid
from brdfkit.theses.timing import ALIKE, compare_times

RIVALS = "quilez", "aaltonen"
WANTED = 10  # times as fast as rays of the same error: the speed that brdfkit aims at
HARDLY = 4 / 3  # times as long: what "hardly longer" allows
FASTER = f"Confirmed if it is as fast as printed, less the factor {ALIKE:g}; faster counts as well."


def claim_times(of_rays, of_march, frame, where, rays, printed):
    """Claim how much faster frames by one march are than by so many rays."""
    ours = compare_times(of_rays, of_march)
    return Claim(
        f"One march takes less time than {rays} rays.",
        f"Figures {where}",
        f"{printed:.1f} times as fast",
        f"{ours} times as fast",
        to_verdict(ours.is_at_least(printed)),
        f"{FASTER} That many rays are far more exact: {frame.count_equal_rays('linear'):.0f} have "
        "the error of the march in this frame.",
    )


def claim_same_time(of_rays, of_march, frame):
    """Claim that three rays take as long as one march."""
    ours, printed = compare_times(of_rays, of_march), 1.77 / 1.72
    return Claim(
        "Three rays take as long as one march.",
        "Figures 6.2, 6.4",
        "1.77 and 1.72 ms",
        f"{ours} times as long, errors {frame.errors[3]:.3f} and {frame.errors['linear']:.3f}",
        to_verdict(ours.is_at_most(printed) and ours.is_at_least(printed)),
        f"Confirmed within {ALIKE:g} times of what is printed, up and down.",
    )


def claim_growing(of_small, of_large, rays_of_small, rays_of_large):
    """Claim that the time of one march hardly grows with the light's size."""
    ours, rays = compare_times(of_large, of_small), compare_times(rays_of_large, rays_of_small)
    return Claim(
        "With a larger light one march takes hardly longer.",
        "Figures 6.2, 6.5",
        f"{2.21 / 1.72:.2f} times as long at half of the ε",
        f"{ours} times as long at half of the ε",
        to_verdict(ours.high <= HARDLY),
        "Confirmed up to a third longer, which the printed times are. The rays of the same two "
        f"figures, 64 and 512, take {rays} times as long, printed {191.5 / 23.46:.1f} times.",
    )


def claim_real_time(frames):
    """State how long a frame takes here, where the thesis has a graphics chip."""
    seconds = np.median(frames["cube", whole_frames.SMALL[0], "linear"])
    size = whole_frames.SIZE
    return Claim(
        "Soft shadows are computed in real time.",
        "title, Figures 6.2, 6.5",
        "1.7 to 2.2 ms for a frame in full HD, on a graphics chip",
        f"{1e3 * seconds:.0f} ms of one CPU thread for {size} × {size} pixels",
        NOT_RUN,
        "That is of a graphics chip and its shaders; what runs here is a CPU.",
    )


def claim_identical(small):
    """State how alike the pictures by one march and by rays are for a small light."""
    whole, shadow = small.compute_psnr("linear"), small.compute_psnr("linear", dimmed=True)
    return Claim(
        "The pictures are nearly identical for the small light.",
        "6.1",
        "by eye",
        f"PSNR {whole:.1f} dB of the picture, {shadow:.1f} dB of its pixels that are not fully lit",
        UNSTATED,
        "By 40 dB, which two pictures that look alike often have, the whole picture is nearly "
        "identical, and its shadow is not.",
    )


def claim_less_alike(small, large):
    """Claim that the pictures differ more for a large light."""
    (a, b), (c, d) = (
        [frame.compute_psnr("linear", dimmed) for frame in (small, large)]
        for dimmed in (False, True)
    )
    return Claim(
        "For the large light the pictures by a march and by rays differ more than for the small.",
        "6.1",
        "by eye",
        f"PSNR {b:.1f} and {a:.1f} dB; {d:.1f} and {c:.1f} dB of pixels that are not fully lit",
        to_verdict(a > b and c > d),
        "ε is that of the figures, 1/20 for the large light, and 1/10 for the small.",
    )


def claim_equal_error(found):
    """State how much faster one march is than rays of the same error."""
    texts = []
    for method in ("linear", "convex"):
        times = [frame.compare_times_at_equal_error(method) for frame in found.values()]
        many = sum(time >= WANTED for time in times)
        texts.append(
            f"`{method}` is {min(times):.1f} to {max(times):.1f} times as fast as rays of the same "
            f"error, {WANTED} times or more on {many} of {len(times)} frames"
        )
    return Claim(
        "One march is much faster than several rays, at the price of an error.",
        "1",
        "no error is given",
        "; ".join(texts),
        UNSTATED,
        f"The {WANTED} times are a bar of brdfkit's own. Objects that are small against the light, "
        "and several in its way, are where one straight edge is far from the truth, and a few rays "
        "are enough.",
    )


def claim_accuracy(found):
    """Claim how errors compare with those of other methods of one march."""
    errors = [f.errors[m] / f.errors["linear"] for f in found.values() for m in RIVALS]
    return Claim(
        "It is much more accurate than other shadows of one march.",
        "1",
        "by eye",
        f"their errors are {min(errors):.1f} to {max(errors):.1f} times as large",
        to_verdict(min(errors) > 2),
        "Confirmed above 2 in all frames, of both. The thesis prints neither their formulas nor "
        "the hardness k; ours is k = d/R, the light's distance over its radius.",
    )


def claim_rival_times(frames, found):
    """Claim how times compare with those of other methods of one march."""
    radius, _ = whole_frames.SOLIDS
    march, *others = (frames["three_solids", radius, m] for m in ("linear", *RIVALS))
    whole = {m: [compare_times(march, other)] for m, other in zip(RIVALS, others, strict=True)}
    alone = {
        m: [compare_times(f.seconds["linear"], f.seconds[m]) for f in found.values()]
        for m in RIVALS
    }
    printed = 1.49 / 1.17
    cells = {
        (what, m): all(ratio.is_at_most(printed) for ratio in ratios[m])
        for what, ratios in (("that of whole frames", whole), ("that of shadows alone", alone))
        for m in RIVALS
    }
    ours, verdict = judge_over_grid(("time", "rival"), cells)
    values = [ratio.value for ratios in alone.values() for ratio in ratios]
    return Claim(
        "It is about as fast as they are.",
        "1, Figure 6.16 a, b",
        f"{printed:.2f} times as long, of frames",
        f"{' and '.join(str(whole[m][0]) for m in RIVALS)} times as long as {' and '.join(RIVALS)} "
        f"in frames, {min(values):.1f} to {max(values):.1f} times without eye rays and shading; "
        f"{ours}",
        verdict,
        f"As fast is up to {ALIKE:g} times the printed ratio. Eye rays and shading, which all of "
        "them share, hide in frames that the rivals' shadows take less time: these end at the "
        "first object.",
    )
