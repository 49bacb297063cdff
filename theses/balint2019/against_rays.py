"""Compares shadows by one march with those by many rays and by other methods of a single march.

The thesis shows them in Figures 6.2 to 6.6.
"""

from brdfkit.theses.balint2019 import scenes
from brdfkit.theses.balint2019.frame import EPSILON, RAYS, SIZE, TIMES, TRUE_RAYS, Frame

from brdfkit.core.jit.threads import in_turn
from brdfkit.theses.claims import UNSTATED, Claim, to_verdict
from brdfkit.theses.drawing import make_figure
from brdfkit.theses.page import Picture, Section, Table

SECONDS = 60
SCENES = scenes.cube, scenes.simple, scenes.complicated
RADII = tuple(EPSILON)  # of the light
EQUAL = 40  # dB: two pictures with a higher PSNR are called nearly identical
LIKE = 1.5  # two times are called alike up to this ratio
WANTED = 10  # times as fast as rays of the same error: the speed that brdfkit aims at
TEXT = f"""Pictures of {SIZE} × {SIZE} pixels. Errors are root mean squares over all points that the
camera sees, most of them fully lit, from the share by {TRUE_RAYS:,} rays; times are those of the
shadows alone, the least of {TIMES}. ε is that of the figures, 1/10 for the light of radius 0.2 and
1/20 for 1. The thesis does not say which march they are of; here it is `linear`, from the
surface."""


@in_turn
def check_claims(sources, report):
    """Check the claims on one march and many rays; return their section of the page."""
    found = {}
    for done, (scene, radius) in enumerate((s, r) for s in SCENES for r in RADII):
        found[scene.__name__, radius] = Frame(scene, radius)
        report(done + 1, len(SCENES) * len(RADII))
    small, large = (found[SCENES[0].__name__, radius] for radius in RADII)
    claims = [
        claim_times(small, "6.2, 6.3", 64, 23.46 / 1.72),
        claim_times(large, "6.5, 6.6", 512, 191.5 / 2.21),
        claim_same_time(small),
        claim_growing(small, large),
        claim_identical(small, large),
        claim_equal_error(found),
        *claim_rivals(found),
    ]
    tables = [make_error_table(found), make_equal_table(found)]
    caption = (
        f"The cube and the light of radius {RADII[1]:g}. Below: the difference from the first, "
        "±0.3: black is too dark, white too bright."
    )
    picture = Picture("against_rays", draw_frame(large), caption)
    return Section("One march against many rays", TEXT, claims, tables, [picture])


def claim_times(frame, where, rays, printed):
    """Claim how much faster one march is than so many rays."""
    return Claim(
        f"One march takes less time than {rays} rays.",
        f"Figures {where}",
        f"{printed:.1f} times as fast, with all else in the frame",
        f"{frame.compare_times(rays):.0f} times as fast, the shadows alone",
        to_verdict(frame.compare_times(rays) >= printed),
    )


def claim_same_time(frame):
    """Claim that three rays take as long as one march."""
    ours = frame.compare_times(3)
    return Claim(
        "Three rays take as long as one march, and are grainy.",
        "Figures 6.2, 6.4",
        "1.77 and 1.72 ms",
        f"{ours:.1f} times as long, errors {frame.errors[3]:.3f} and {frame.errors['linear']:.3f}",
        to_verdict(1 / LIKE < ours < LIKE and frame.errors[3] > frame.errors["linear"]),
        f"Confirmed up to {LIKE:g} times.",
    )


def claim_growing(small, large):
    """Claim that the time hardly grows with the light's size."""
    ours = large.seconds["linear"] / small.seconds["linear"]
    return Claim(
        "With a larger light one march takes hardly longer.",
        "Figures 6.2, 6.5",
        f"{2.21 / 1.72:.2f} times as long at half of the ε",
        f"{ours:.2f} times",
        to_verdict(ours < LIKE),
        f"Confirmed below {LIKE:g}.",
    )


def claim_identical(small, large):
    """Claim that pictures by one march and by rays are nearly identical."""
    a, b = (frame.compute_psnr("linear") for frame in (small, large))
    return Claim(
        "The pictures are nearly identical for the small light, and less so for the large one.",
        "6.1",
        "by eye",
        f"PSNR {a:.1f} and {b:.1f} dB",
        to_verdict(a >= EQUAL and a > b),
        f"Confirmed from {EQUAL} dB on.",
    )


def claim_equal_error(found):
    """State how much faster one march is than rays of the same error."""
    times = {name: frame.compare_times_at_equal_error("linear") for name, frame in found.items()}
    good = [f"{scene} {radius:g}" for (scene, radius), t in times.items() if t >= WANTED]
    return Claim(
        "One march is much faster than several rays, at the price of an error.",
        "1",
        "no error is given",
        f"{min(times.values()):.0f} to {max(times.values()):.0f} times as fast as rays of the same "
        f"error; {WANTED} times or more on {len(good)} of {len(times)} frames"
        + (f": {', '.join(good)}" if good else ""),
        UNSTATED,
        f"The {WANTED} times are a bar of brdfkit's own. Objects that are small against the light, "
        "and several in its way, are where one straight edge is far from the truth, and a few rays "
        "are enough.",
    )


def claim_rivals(found):
    """Claim how errors and times compare with those of other methods of one march."""
    rivals = "quilez", "aaltonen"
    errors = [min(f.errors[m] for m in rivals) / f.errors["linear"] for f in found.values()]
    times = [f.seconds["linear"] / f.seconds[m] for f in found.values() for m in rivals]
    return [
        Claim(
            "It is much more accurate than other shadows of one march.",
            "1",
            "by eye",
            f"their errors are {min(errors):.1f} to {max(errors):.1f} times as large",
            to_verdict(min(errors) > 2),
            "Confirmed above 2.",
        ),
        Claim(
            "It is about as fast as they are.",
            "1, Figure 6.16 a, b",
            f"{1.49 / 1.17:.2f} times as long, of frames",
            f"{min(times):.1f} to {max(times):.1f} times as long, the shadows alone",
            to_verdict(max(times) < LIKE),
            f"Confirmed below {LIKE:g}. They end at the first object that the ray meets.",
        ),
    ]


def make_error_table(found):
    """Return a table of errors, and of times relative to those of `linear`."""
    names = "linear", "split", "quilez", "aaltonen", 3, 16, 64, 512
    rows = [
        (
            f"{n} rays" if n in RAYS else n,
            *(f"{f.errors[n]:.4f} ({f.compare_times(n):.1f})" for f in found.values()),
        )
        for n in names
    ]
    heads = "", *(f"{scene} {radius:g}" for scene, radius in found)
    caption = (
        "Errors, and in brackets times over those of `linear`, by scene and radius of the light."
    )
    return Table(heads, rows, caption)


def make_equal_table(found):
    """Return a table of the rays with equal error, and their times."""
    rows = [
        (
            f"{scene} {radius:g}",
            *(
                f"{f.count_equal_rays(m):.0f} rays, {f.compare_times_at_equal_error(m):.1f}"
                for m in ("linear", "split")
            ),
        )
        for (scene, radius), f in found.items()
    ]
    caption = "How many rays have the same error, and how many times as long they take."
    return Table(("", "linear", "split"), rows, caption)


def draw_frame(frame):
    """Draw pictures by some methods, and the difference of each from the first."""
    shown = {"512 rays": 512, "linear": "linear", "split": "split", "3 rays": 3, "quilez": "quilez"}
    drawn = make_figure(9, 3.9)
    first = frame.shares[512]
    for axes, (title, name) in zip(drawn.subplots(2, len(shown)).T, shown.items(), strict=True):
        axes[0].imshow(frame.view.shade(frame.shares[name]), cmap="gray", vmin=0, vmax=1)
        axes[0].set_title(title, size=10)
        off = frame.view.make_image(frame.shares[name] - first, 0)
        axes[1].imshow(off, cmap="gray", vmin=-0.3, vmax=0.3)
        for a in axes:
            a.set_axis_off()
    return drawn
