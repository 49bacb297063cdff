"""Measures the edges that show in a picture where lobes are stored for a few views only."""

import numpy as np
from brdfkit.theses.ergun2015.lit_balls import (
    compute_psnr,
    find_probes,
    make_ward_bsdf,
    render_reference,
    render_scene,
)
from brdfkit.theses.ergun2015.printed_lobes import PrintedLobes

from brdfkit.core.colours import to_srgb
from brdfkit.core.jit.llvm import use_variant
from brdfkit.core.jit.threads import in_turn
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
COUNT = 32  # kernels and lobes
JUMP = 1.5  # times the change within a view: a larger change is an edge between views
KINDS = {
    "gmm, nearest view": "gmm",
    "gmm, between views": "gmm",
    "kde, between views": "kde",
    "kde, printed": "kde",
}
BLOCKS, BETWEEN, KERNELS, PRINTED = KINDS
SHOWN = 0.05  # the roughness in the figure
TEXT = f"""A ball of {SIZE} × {SIZE} pixels in each map, of several roughnesses α, where each point
takes the lobes of the nearest stored view, as in the thesis, or where lobes are interpolated
between two views. Mixtures are brdfkit's, each fitted from its neighbour; the thesis fits them
apart, so that its edges can only be harder. Its kernels, *printed*, have a closed form at every
view; brdfkit's are stored and interpolated, too. The numbers are how many times as much the error
changes from pixel to pixel where the view changes as within a view; above {JUMP:g} there is an
edge."""


@in_turn
def check_claims(sources, report):
    """Check the claims on the edges between stored views of lobes, and return their section."""
    use_variant()
    probes, jumps, rows, shown = find_probes(sources), {}, [], []
    for alpha in ALPHAS:
        bsdf = make_ward_bsdf(alpha)
        made, lobes = find_scene("ball")(bsdf, (SIZE, SIZE)), fit_kinds(bsdf)
        for name, file in probes.items():
            reference, pictures, found = measure_ball(made, bsdf, file, lobes)
            jumps[name, f"{alpha:g}"] = {kind: jump for kind, (jump, _) in found.items()}
            rows.append((name, f"{alpha:g}", *(f"{j:.1f} / {d:.1f}" for j, d in found.values())))
            if alpha == SHOWN and not shown:
                shown = [reference, *pictures.values()]
            report(len(rows), len(ALPHAS) * len(probes))
    claims = [
        claim_edges("Mixtures show blocks between stored views.", jumps, BLOCKS, True),
        claim_edges("Kernels show none: the thesis's form.", jumps, PRINTED, False),
        claim_edges("Kernels show none: brdfkit's form.", jumps, KERNELS, False),
    ]
    table = Table(("map", "α", *KINDS), rows,
                  "Changes of the error [times] / PSNR [dB].")  # fmt: skip
    first = next(iter(probes))
    caption = f"In {first}, α = {SHOWN:g}, from the left: the truth; {'; '.join(KINDS)}."
    pictures = [Picture("lobe_views", draw_balls(shown), caption)]
    return Section("Between views", TEXT, claims, [table], pictures)


def fit_kinds(bsdf):
    """Return the lobes that are fitted to a BSDF for each kind of picture."""
    fitted = {m: make_integrator(m).shading.fit_lobes(bsdf) for m in set(KINDS.values())}
    found = {kind: fitted[method] for kind, method in KINDS.items()}
    return found | {PRINTED: PrintedLobes(COUNT).fit_lobes(bsdf)}


def make_integrator(method):
    """Return the integrator by a method."""
    import mitsuba as mi

    return mi.load_dict({"type": "filtered_environment", "method": method})


def measure_ball(made, bsdf, file, lobes):
    """Return the truth, the picture of each kind, and by kind its jump and PSNR [dB].

    made : the dictionary of the ball's scene.
    file : the environment map.
    lobes : the lobes of each kind.
    """
    import mitsuba as mi

    light = mi.load_dict(describe_environment(file), parallel=False)
    halves, scene = render_reference(made, light)
    reference, seen = np.mean(halves, axis=0), find_material_mask(scene, bsdf)
    pictures = {
        kind: render_with_lobes(made, light, make_integrator(method), lobes[kind], kind == BLOCKS)
        for kind, method in KINDS.items()
    }
    views = find_nearest_views(scene, lobes[BLOCKS].step)
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
    found, between = ([by[k] for by in jumps.values()] for k in (kind, BETWEEN))
    why = (
        f"Mixtures that are interpolated: {min(between):.1f} to {max(between):.1f} times."
        if kind == BLOCKS
        else ""
    )
    figures = f"{ours}; {min(found):.1f} to {max(found):.1f} times"
    return Claim(says, "9.3", "a drawing", figures, verdict, why)


def render_with_lobes(made, light, integrator, lobes, nearest):
    """Render a scene with `lobes` for its material, by the `nearest` view or between views."""
    find = lobes.find_surrounding_views
    with (
        replace_part(integrator.shading.lobes, "make", lambda bsdf: lobes),
        replace_part(
            lobes, "find_surrounding_views", select_nearest_view(find) if nearest else find
        ),
    ):
        return render_scene(made, light, integrator)[0]


def select_nearest_view(find_surrounding_views):
    """Return a function like `find_surrounding_views` that gives all weight to the nearest view."""
    import drjit as dr

    def found(wo):
        ((low, share), (high, _)), sin, cos = find_surrounding_views(wo)
        return [(dr.select(share > 0.5, low, high), 1.0)], sin, cos

    return found


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
    """Draw the pictures of balls in a row."""
    drawn = make_figure(9, 2.4)
    for axes, pixels in zip(drawn.subplots(1, len(pictures)), pictures, strict=True):
        axes.imshow(to_srgb(pixels))
        axes.axis("off")
    return drawn
