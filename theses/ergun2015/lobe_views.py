"""Measures the edges that show in a picture where lobes are stored for a few views only."""

import numpy as np
from brdfkit.theses.ergun2015.lit_balls import (
    compute_psnr,
    find_probes,
    make_ward_bsdf,
    render_reference,
    render_scene,
)

from brdfkit.core.colours import to_srgb
from brdfkit.core.jit.llvm import use_variant
from brdfkit.core.jit.threads import in_turn
from brdfkit.rendering.scene_input.environment import describe_environment
from brdfkit.rendering.scene_input.loading import find_scene
from brdfkit.rendering.scene_input.material import find_material_mask
from brdfkit.theses.claims import Claim, to_verdict
from brdfkit.theses.drawing import make_figure
from brdfkit.theses.page import Picture, Section
from brdfkit.theses.replacing import replace_part

SECONDS = 20
SIZE, ALPHA = 256, 0.05
JUMP = 1.5  # times the change within a view: a larger change is an edge between views
KINDS = {"gmm, nearest view": "gmm", "gmm, between views": "gmm", "kde, between views": "kde"}
TEXT = f"""A ball of {SIZE} × {SIZE} pixels, α = {ALPHA:g}, where each point takes the lobes of the
nearest stored view, as in the thesis, or where lobes are interpolated between two views. Its
kernels have a closed form at every view; ours are stored and interpolated, too."""


@in_turn
def check_claims(sources, report):
    """Check the claims on the edges between stored views of lobes, and return their section."""
    import mitsuba as mi

    use_variant()
    name, file = next(iter(find_probes(sources).items()))
    light = mi.load_dict(describe_environment(file), parallel=False)
    bsdf = make_ward_bsdf(ALPHA)
    made = find_scene("ball")(bsdf, (SIZE, SIZE))
    halves, scene = render_reference(made, light)
    report(1, 2)
    reference, seen = np.mean(halves, axis=0), find_material_mask(scene, bsdf)
    pictures, views = {}, None
    for kind, method in KINDS.items():
        integrator = mi.load_dict({"type": "filtered_environment", "method": method})
        lobes = integrator.shading.fit_lobes(bsdf)
        views = find_nearest_views(scene, lobes.step) if views is None else views
        pictures[kind] = render_with_lobes(made, light, integrator, lobes, "nearest" in kind)
    psnrs = {kind: compute_psnr(reference, p, seen)[0] for kind, p in pictures.items()}
    jumps = {kind: measure_view_jumps(p - reference, views, seen) for kind, p in pictures.items()}
    blocks, _, kernels = jumps.values()
    figures = [f"{jumps[kind]:.1f} times, {psnrs[kind]:.1f} dB" for kind in KINDS]
    claims = [
        Claim(
            "Mixtures show blocks between stored views.",
            "9.3",
            "a drawing",
            f"from pixel to pixel the error changes {figures[0]} where the view changes",
            to_verdict(blocks > JUMP),
            f"Times as much as within a view; confirmed above {JUMP:g}. Interpolated, it changes "
            f"{figures[1]}.",
        ),
        Claim(
            "Kernels show none.",
            "9.3",
            "a drawing",
            f"the error changes {figures[2]}",
            to_verdict(kernels < JUMP),
        ),
    ]
    caption = f"In {name}, from the left: the truth; {'; '.join(KINDS)}."
    picture = Picture("lobe_views", draw_balls([reference, *pictures.values()]), caption)
    return Section("Between views", TEXT, claims, pictures=[picture])


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
