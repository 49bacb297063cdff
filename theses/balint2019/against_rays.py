"""Compares shadows by one march with those by many rays and by other methods of a single march.

The thesis shows them in Figures 6.2 to 6.6.
"""

from brdfkit.theses.balint2019 import scenes, whole_frames
from brdfkit.theses.balint2019.frame import EPSILON, RAYS, SIZE, TIMES, TRUE_RAYS, Frame

from brdfkit.core.jit.threads import in_turn
from brdfkit.theses.claims import UNSTATED, Claim, to_verdict
from brdfkit.theses.drawing import make_figure
from brdfkit.theses.page import Picture, Section, Table
from brdfkit.theses.timing import ALIKE, compare_times

SECONDS = 60
SCENES = scenes.cube, scenes.simple, scenes.complicated
RADII = tuple(EPSILON)  # of the light
RIVALS = "quilez", "aaltonen"
EQUAL_METHODS = "linear", "convex", "split"
EQUAL = 40  # dB: two pictures with a higher PSNR are called nearly identical
WANTED = 10  # times as fast as rays of the same error: the speed that brdfkit aims at
TEXT = f"""Pictures of {SIZE} × {SIZE} pixels. Each is as wide as one of the thesis's frames, which
are in full HD, and so are the empty balls, half a pixel or less; in pixels as coarse as these,
balls blur shadows most. Errors are those of the share times the cosine to the light, as they are
seen: root mean squares over all points that the camera sees, most of them fully lit, from the share
of {TRUE_RAYS:,} other rays that lead from the point itself to the spherical light. ε is that of the
figures, 1/10 for the light of radius 0.2 and 1/20 for 1. The thesis does not say which march they
are of; here it is `linear`, from the surface.

The thesis prints times of frames. So claims on times compare frames of ours, {whole_frames.SIZE} ×
{whole_frames.SIZE} pixels with eye rays, normals and grey shading; the tables have those of the
shadows alone. All are CPU seconds in one thread, {whole_frames.TIMES} and {TIMES} turns, in which
what is compared is run one after the other; in brackets are 95 % intervals. On another machine
ratios agree within a factor of {ALIKE:g}, with the whole interval: that much more or less than
printed is *confirmed*."""
TIMES_WHY = f"Confirmed within {ALIKE:g} times of what is printed."


@in_turn
def check_claims(sources, report):
    """Check the claims on one march and many rays; return their section of the page."""
    found = {}
    for done, (scene, radius) in enumerate((s, r) for s in SCENES for r in RADII):
        found[scene.__name__, radius] = Frame(scene, radius)
        report(done + 1, len(SCENES) * len(RADII))
    small, large = (found[SCENES[0].__name__, radius] for radius in RADII)
    frames = whole_frames.measure_frames()
    of_small, of_large = (
        {name: frames["cube", radius, name] for name in ("linear", *rays)}
        for radius, rays in zip(RADII, (("few", "some"), ("many",)), strict=True)
    )
    claims = [
        claim_times(of_small["some"], of_small["linear"], "6.2, 6.3", 64, 23.46 / 1.72),
        claim_times(of_large["many"], of_large["linear"], "6.5, 6.6", 512, 191.5 / 2.21),
        claim_same_time(of_small["few"], of_small["linear"], small),
        claim_growing(of_small["linear"], of_large["linear"]),
        claim_identical(small, large),
        claim_equal_error(found),
        claim_accuracy(found),
        claim_rival_times(frames, found),
    ]
    tables = [make_error_table(found), make_equal_table(found)]
    caption = (
        f"The cube and the light of radius {RADII[1]:g}. Below: the difference from the first, "
        "±0.3: black is too dark, white too bright."
    )
    picture = Picture("against_rays", draw_frame(large), caption)
    return Section("One march against many rays", TEXT, claims, tables, [picture])


def claim_times(of_rays, of_march, where, rays, printed):
    """Claim how much faster frames by one march are than by so many rays."""
    ours = compare_times(of_rays, of_march)
    return Claim(
        f"One march takes less time than {rays} rays.",
        f"Figures {where}",
        f"{printed:.1f} times as fast",
        f"{ours} times as fast",
        to_verdict(ours.is_at_least(printed)),
        TIMES_WHY,
    )


def claim_same_time(of_rays, of_march, frame):
    """Claim that three rays take as long as one march."""
    ours = compare_times(of_rays, of_march)
    return Claim(
        "Three rays take as long as one march, and are grainy.",
        "Figures 6.2, 6.4",
        "1.77 and 1.72 ms",
        f"{ours} times as long, errors {frame.errors[3]:.3f} and {frame.errors['linear']:.3f}",
        to_verdict(
            ours.is_at_most(1.77 / 1.72)
            and ours.is_at_least(1.77 / 1.72)
            and frame.errors[3] > frame.errors["linear"]
        ),
        TIMES_WHY,
    )


def claim_growing(of_small, of_large):
    """Claim that the time hardly grows with the light's size."""
    ours = compare_times(of_large, of_small)
    return Claim(
        "With a larger light one march takes hardly longer.",
        "Figures 6.2, 6.5",
        f"{2.21 / 1.72:.2f} times as long at half of the ε",
        f"{ours} times",
        to_verdict(ours.is_at_most(2.21 / 1.72)),
        TIMES_WHY,
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
    texts = []
    for method in ("linear", "convex"):
        times = [frame.compare_times_at_equal_error(method) for frame in found.values()]
        many = sum(time >= WANTED for time in times)
        texts.append(
            f"`{method}` is {min(times):.0f} to {max(times):.0f} times as fast as rays of the same "
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
    errors = [min(f.errors[m] for m in RIVALS) / f.errors["linear"] for f in found.values()]
    return Claim(
        "It is much more accurate than other shadows of one march.",
        "1",
        "by eye",
        f"their errors are {min(errors):.1f} to {max(errors):.1f} times as large",
        to_verdict(min(errors) > 2),
        "Confirmed above 2.",
    )


def claim_rival_times(frames, found):
    """Claim how times compare with those of other methods of one march."""
    radius, _ = whole_frames.SOLIDS
    march, *others = (frames["three_solids", radius, m] for m in ("linear", *RIVALS))
    ours = [compare_times(march, other) for other in others]
    alone = [1 / f.compare_times(m) for f in found.values() for m in RIVALS]
    return Claim(
        "It is about as fast as they are.",
        "1, Figure 6.16 a, b",
        f"{1.49 / 1.17:.2f} times as long",
        f"{' and '.join(map(str, ours))} times as long as {' and '.join(RIVALS)}",
        to_verdict(all(ratio.is_at_most(1.49 / 1.17) for ratio in ours)),
        f"{TIMES_WHY} Without eye rays and shading, in the scenes of the table, it takes "
        f"{min(alone):.1f} to {max(alone):.1f} times as long: the others end at the first object.",
    )


def make_error_table(found):
    """Return a table of errors, and of times relative to those of `linear`."""
    names = "linear", "convex", "split", "quilez", "aaltonen", 3, 16, 64, 512
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
                for m in EQUAL_METHODS
            ),
        )
        for (scene, radius), f in found.items()
    ]
    caption = "How many rays have the same error, and how many times as long their shadows take."
    return Table(("", *EQUAL_METHODS), rows, caption)


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
