"""Compares shadows by one march with those by many rays and by other methods of a single march.

The thesis shows them in Figures 6.2 to 6.6.
"""

from brdfkit.theses.balint2019 import scenes, whole_frames
from brdfkit.theses.balint2019.frame import EPSILON, RAYS, SIZE, TIMES, TRUE_RAYS, Frame
from brdfkit.theses.balint2019.grain import claim_grain
from brdfkit.theses.balint2019.ray_claims import (
    claim_accuracy,
    claim_equal_error,
    claim_growing,
    claim_identical,
    claim_less_alike,
    claim_real_time,
    claim_rival_times,
    claim_same_time,
    claim_times,
)

from brdfkit.core.jit.threads import in_turn
from brdfkit.theses.drawing import make_figure
from brdfkit.theses.page import Picture, Section, Table
from brdfkit.theses.timing import ALIKE

SECONDS = 60
SCENES = scenes.cube, scenes.simple, scenes.complicated
RADII = tuple(EPSILON)  # of the light
EQUAL_METHODS = "linear", "convex", "split"
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
what is compared is run one after the other; in brackets are 95 % intervals. Ratios of times on
another machine are called alike within a factor of {ALIKE:g}, with the whole interval."""


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
        claim_times(of_small["some"], of_small["linear"], small, "6.2, 6.3", 64, 23.46 / 1.72),
        claim_times(of_large["many"], of_large["linear"], large, "6.5, 6.6", 512, 191.5 / 2.21),
        claim_real_time(frames),
        claim_same_time(of_small["few"], of_small["linear"], small),
        claim_grain(dict(zip(RADII, (small, large), strict=True))),
        claim_growing(of_small["linear"], of_large["linear"], of_small["some"], of_large["many"]),
        claim_identical(small),
        claim_less_alike(small, large),
        claim_equal_error(found),
        claim_accuracy(found),
        claim_rival_times(frames, found),
    ]
    tables = [make_error_table(found), make_equal_table(found)]
    caption = (
        f"The cube and the light of radius {RADII[1]:g}. Below: the difference from the first, by "
        f"{TRUE_RAYS:,} other rays, ±0.3: black is too dark, white too bright."
    )
    picture = Picture("against_rays", draw_frame(large), caption)
    return Section("One march against many rays", TEXT, claims, tables, [picture])


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
    names = {"512 rays": 512, "linear": "linear", "split": "split", "3 rays": 3, "quilez": "quilez"}
    shown = {"truth": frame.truth} | {title: frame.shares[name] for title, name in names.items()}
    drawn = make_figure(9, 3.3)
    for axes, (title, share) in zip(drawn.subplots(2, len(shown)).T, shown.items(), strict=True):
        axes[0].imshow(frame.view.shade(share), cmap="gray", vmin=0, vmax=1)
        axes[0].set_title(title, size=10)
        off = frame.view.make_image(share - frame.truth, 0)
        axes[1].imshow(off, cmap="gray", vmin=-0.3, vmax=0.3)
        for a in axes:
            a.set_axis_off()
    return drawn
