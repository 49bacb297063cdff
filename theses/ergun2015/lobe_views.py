"""Measures the edges that show in a picture where lobes are stored for a few views only."""

import numpy as np
from brdfkit.theses.ergun2015.lit_balls import (
    compute_psnr,
    find_probes,
    make_ward_bsdf,
    render_reference,
    render_scene,
)
from brdfkit.theses.ergun2015.printed_lobes import LOBES as COUNT
from brdfkit.theses.ergun2015.printed_lobes import VIEWS, PrintedLobes, PrintedMixtures

from brdfkit.core.colours import to_srgb
from brdfkit.core.jit.llvm import use_variant
from brdfkit.core.jit.threads import in_turn
from brdfkit.lighting.spherical_gaussians.lobe_table import LARGEST_THETA_O
from brdfkit.rendering.scene_input.environment import describe_environment
from brdfkit.rendering.scene_input.loading import find_scene
from brdfkit.rendering.scene_input.material import find_material_mask
from brdfkit.theses.claims import Claim
from brdfkit.theses.drawing import make_figure
from brdfkit.theses.grid import judge_over_grid
from brdfkit.theses.page import Picture, Section, Table
from brdfkit.theses.replacing import replace_part

SECONDS = 120
SIZE = 256
ALPHAS = 0.01, 0.05, 0.1, 0.2
JUMP = 1.5  # times the change within a view: a larger change is an edge between views
KINDS = "gmm, printed", "gmm, between views", "kde, printed", "kde, between views"
BLOCKS, BETWEEN, PRINTED, KERNELS = KINDS
SHOWN = 0.05  # the roughness in the figure
DIFFERENCE = 10  # the factor by which the figure enlarges differences
TEXT = f"""A ball of {SIZE} × {SIZE} pixels in each map, of several roughnesses α. *Printed*: as in
the thesis, mixtures are fitted apart at {VIEWS} views, of which a point takes the nearest, and
{COUNT} kernels have a closed form at every view. brdfkit's mixtures and kernels are interpolated
between stored views. The numbers are how many times as much the error changes from pixel to pixel
where the view changes as within a view; above {JUMP:g} there is an edge. The thesis judges by eye:
{JUMP:g} is ours, set when one ball had shown 2.6 for mixtures and 0.8 for kernels."""


@in_turn
def check_claims(sources, report):
    """Check the claims on the edges between stored views of lobes, and return their section."""
    use_variant()
    probes, jumps, rows, shown = find_probes(sources), {}, [], []
    for alpha in ALPHAS:
        bsdf = make_ward_bsdf(alpha)
        made, shadings = find_scene("ball")(bsdf, (SIZE, SIZE)), make_shadings()
        for name, file in probes.items():
            reference, pictures, found = measure_ball(made, bsdf, file, shadings)
            jumps[name, f"{alpha:g}"] = {kind: jump for kind, (jump, _) in found.items()}
            rows.append((name, f"{alpha:g}", *(f"{j:.1f} / {d:.1f}" for j, d in found.values())))
            if alpha == SHOWN and not shown:
                shown = [reference, *pictures.values()]
            report(len(rows), len(ALPHAS) * len(probes))
    claims = [
        claim_edges(
            "Mixtures show blocks between stored views: the thesis's form.", jumps, BLOCKS, True
        ),
        claim_edges(
            "Mixtures show blocks between stored views: brdfkit's form.", jumps, BETWEEN, True
        ),
        claim_edges("Kernels show none: the thesis's form.", jumps, PRINTED, False),
        claim_edges("Kernels show none: brdfkit's form.", jumps, KERNELS, False),
    ]
    table = Table(("map", "α", *KINDS), rows,
                  "Changes of the error [times] / PSNR [dB].")  # fmt: skip
    first = next(iter(probes))
    caption = f"In {first}, α = {SHOWN:g}; below {DIFFERENCE} times the difference from the truth."
    pictures = [Picture("lobe_views", draw_balls(shown), caption)]
    return Section("Between views", TEXT, claims, [table], pictures)


def make_shadings():
    """Return what lights the pictures of each kind, which fits lobes once for a BSDF."""
    ours = {
        kind: make_integrator(method).shading
        for kind, method in ((BETWEEN, "gmm"), (KERNELS, "kde"))
    }
    printed = {BLOCKS: PrintedMixtures(), PRINTED: PrintedLobes(COUNT)}
    return {kind: (printed | ours)[kind] for kind in KINDS}


def make_integrator(method="gmm"):
    """Return the integrator by a method."""
    import mitsuba as mi

    return mi.load_dict({"type": "filtered_environment", "method": method})


def measure_ball(made, bsdf, file, shadings):
    """Return the truth, the picture of each kind, and by kind its jump and PSNR [dB].

    made : the dictionary of the ball's scene.
    file : the environment map.
    shadings : what lights the pictures of each kind.
    """
    import mitsuba as mi

    light = mi.load_dict(describe_environment(file), parallel=False)
    halves, scene = render_reference(made, light)
    reference, seen = np.mean(halves, axis=0), find_material_mask(scene, bsdf)
    pictures = {kind: render_by(made, light, shading) for kind, shading in shadings.items()}
    views = find_nearest_views(scene, LARGEST_THETA_O / (VIEWS - 1))
    found = {
        kind: (
            measure_view_jumps(picture - reference, views, seen),
            compute_psnr(reference, picture, seen)[0],
        )
        for kind, picture in pictures.items()
    }
    return reference, pictures, found


def claim_edges(says, jumps, kind, expected):
    """Claim that pictures of a kind have edges between views, or have none, by `expected`."""
    ours, verdict = judge_over_grid(
        ("map", "α"), {cell: bool((by[kind] > JUMP) == expected) for cell, by in jumps.items()}
    )
    found = [by[kind] for by in jumps.values()]
    figures = f"{ours}; {min(found):.1f} to {max(found):.1f} times"
    return Claim(says, "9.3", "a drawing", figures, verdict)


def render_by(made, light, shading):
    """Render a scene whose surfaces are lit by a `shading`."""
    integrator = make_integrator()
    integrator.shading = shading
    with replace_part(shading, "radiance"):
        return render_scene(made, light, integrator)[0]


def find_nearest_views(scene, step):
    """Return the number of the nearest stored view at each pixel (SIZE, SIZE).

    Stored views are `step` apart [radians].
    """
    import mitsuba as mi

    place = (np.mgrid[:SIZE, :SIZE].reshape(2, -1) + 0.5) / SIZE
    at = mi.Point2f(place[1].astype(np.float32), place[0].astype(np.float32))
    ray, _ = scene.sensors()[0].sample_ray(0.0, 0.5, at, mi.Point2f(0.5))
    cos = np.array(scene.ray_intersect(ray).wi.z, float)
    return np.round(np.arccos(cos.clip(-1, 1)) / step).reshape(SIZE, SIZE)


def measure_view_jumps(error, views, seen):
    """Return the change of an error between pixels where the view changes, over that elsewhere.

    `error` is (height, width, 3). Each change is compared with those of pixels beside it, so that
    all places on the ball count alike.
    """
    error = error.mean(axis=-1)
    changed, kept = [], []
    for axis in (0, 1):
        change = np.abs(np.diff(error, axis=axis))
        edge = np.diff(views, axis=axis) != 0
        first, last = (np.take(seen, range(k, SIZE - 1 + k), axis=axis) for k in (0, 1))
        within = first & last
        beside = within & ~edge & (np.roll(edge, 2, axis) | np.roll(edge, -2, axis))
        changed.append(change[within & edge])
        kept.append(change[beside])
    return float(np.concatenate(changed).mean() / np.concatenate(kept).mean())


def draw_balls(pictures):
    """Draw the pictures of balls in a row, the truth first, and below their differences from it."""
    drawn = make_figure(10, 4.4)
    middle = slice(SIZE // 8, SIZE - SIZE // 8)  # around the ball
    grid = drawn.subplots(2, len(pictures))
    for axes in grid.flat:
        axes.axis("off")
    for (above, below), head, pixels in zip(grid.T, ("truth", *KINDS), pictures, strict=True):
        above.set_title(head, size=9)
        above.imshow(to_srgb(pixels)[middle, middle])
        if head != "truth":
            difference = DIFFERENCE * np.abs(pixels - pictures[0])
            below.imshow(to_srgb(difference)[middle, middle])
    return drawn
