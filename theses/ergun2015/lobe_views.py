"""C13: mixtures are stored for some views; what shows between them."""

import numpy as np
from brdfkit.theses.ergun2015.lit_balls import decibels, find_probes, material, render, truth

from brdfkit.core.colours import to_srgb
from brdfkit.core.jit.llvm import use_variant
from brdfkit.core.jit.threads import in_turn
from brdfkit.rendering.scene_input.environment import describe_environment
from brdfkit.rendering.scene_input.loading import find_scene
from brdfkit.rendering.scene_input.material import find_material_mask
from brdfkit.theses.claims import Claim, verdict
from brdfkit.theses.drawing import figure
from brdfkit.theses.page import Picture, Section

SECONDS = 20
SIZE, ALPHA = 256, 0.05
JUMP = 1.5  # times the differences within a view that count as a block's edge
KINDS = {"gmm, nearest view": "gmm", "gmm, between views": "gmm", "kde, between views": "kde"}
TEXT = f"""A ball of {SIZE} × {SIZE} pixels, α = {ALPHA:g}, where each point takes the lobes of the
nearest stored view, as in the thesis, or where lobes are interpolated between two views. Its
kernels have a closed form at every view; ours are stored and interpolated, too."""


@in_turn
def run(sources, report):
    """The pictures, and the claims on their edges."""
    import mitsuba as mi

    use_variant()
    name, file = next(iter(find_probes(sources).items()))
    light = mi.load_dict(describe_environment(file), parallel=False)
    bsdf = material(ALPHA)
    made = find_scene("ball")(bsdf, (SIZE, SIZE))
    halves, scene = truth(made, light)
    report(1, 2)
    reference, seen = np.mean(halves, axis=0), find_material_mask(scene, bsdf)
    pictures, views = {}, None
    for kind, method in KINDS.items():
        integrator = mi.load_dict({"type": "filtered_environment", "method": method})
        lobes = integrator.shading.fit_lobes(bsdf)
        views = nearest(scene, lobes.step) if views is None else views
        if "nearest" in kind:
            lobes.find_surrounding_views = find_nearest_view(lobes.find_surrounding_views)
        integrator.shading.lobes.make = lambda bsdf, lobes=lobes: lobes
        pictures[kind] = render(made, light, integrator)[0]
    psnrs = {kind: decibels(reference, p, seen)[0] for kind, p in pictures.items()}
    jumps = {kind: jump(p - reference, views, seen) for kind, p in pictures.items()}
    blocks, _, kernels = jumps.values()
    figures = [f"{jumps[kind]:.1f} times, {psnrs[kind]:.1f} dB" for kind in KINDS]
    claims = [
        Claim(
            "Mixtures show blocks between stored views.",
            "9.3",
            "a drawing",
            f"from pixel to pixel the error changes {figures[0]} where the view changes",
            verdict(blocks > JUMP),
            f"Times as much as within a view; confirmed above {JUMP:g}. Interpolated, it changes "
            f"{figures[1]}.",
        ),
        Claim(
            "Kernels show none.",
            "9.3",
            "a drawing",
            f"the error changes {figures[2]}",
            verdict(kernels < JUMP),
        ),
    ]
    caption = f"In {name}, from the left: the truth; {'; '.join(KINDS)}."
    picture = Picture("lobe_views", draw([reference, *pictures.values()]), caption)
    return Section("Between views", TEXT, claims, pictures=[picture])


def find_nearest_view(find_surrounding_views):
    """A function like `ViewedLobes.find_surrounding_views`, which finds only the nearest view."""
    import drjit as dr

    def found(wo):
        ((low, share), (high, _)), sin, cos = find_surrounding_views(wo)
        return [(dr.select(share > 0.5, low, high), 1.0)], sin, cos

    return found


def nearest(scene, step):
    """The number (SIZE, SIZE) of the nearest stored view at each pixel; views are `step` apart."""
    import mitsuba as mi

    place = (np.mgrid[:SIZE, :SIZE].reshape(2, -1) + 0.5) / SIZE
    at = mi.Point2f(place[1].astype(np.float32), place[0].astype(np.float32))
    ray, _ = scene.sensors()[0].sample_ray(0.0, 0.5, at, mi.Point2f(0.5))
    cos = np.array(scene.ray_intersect(ray).wi.z, float)
    return np.round(np.arccos(cos.clip(-1, 1)) / step).reshape(SIZE, SIZE)


def jump(error, views, seen):
    """The mean change of an error (height, width, 3) from a pixel to the next where the view
    changes, over that where it does not. Pairs count alike by their place on the ball: each change
    is compared to those of the pixels beside it."""
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


def draw(pictures):
    """The balls in a row."""
    drawn = figure(9, 2.4)
    for axes, pixels in zip(drawn.subplots(1, len(pictures)), pictures, strict=True):
        axes.imshow(to_srgb(pixels))
        axes.axis("off")
    return drawn
