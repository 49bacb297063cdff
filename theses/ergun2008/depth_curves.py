"""Figure 4.1: how six projections spread depth."""

import numpy as np
from brdfkit.theses.ergun2008.views import PROJECTIONS, View

from brdfkit.core.jit.llvm import use_variant
from brdfkit.core.jit.threads import in_turn
from brdfkit.shadows.maps.scenes import VIEWS
from brdfkit.shadows.maps.techniques import make_techniques
from brdfkit.theses.claims import Claim, verdict
from brdfkit.theses.drawing import COLOURS, figure, tidy
from brdfkit.theses.page import Picture, Section, Table

SECONDS = 2
SCENE = "objects_on_a_ground"
UNEVEN = 0.01
TEXT = f"""Of points in all that a view of `{SCENE}` shows and what may shadow it: the depth on the
map over the way of the light. *Unevenness* is the share of the spread of depths that is no straight
line. The curves of the thesis are in a picture that is not at hand."""


@in_turn
def run(sources, report):
    """The curves, and the claims on them."""
    use_variant()
    curves = {view: curves_of(View.of(SCENE, view, 1).placement) for view in VIEWS}
    uneven = {name: [unevenness(*curves[view][name]) for view in VIEWS] for name in PROJECTIONS}
    rows = [
        (PROJECTIONS[name], *(f"{value:.3f}" for value in values))
        for name, values in uneven.items()
    ]
    table = Table(("projection", *VIEWS), rows, "Unevenness of depths, light 1.")
    claims = [even_claim(uneven), worse_claim(uneven)]
    return Section(
        "Depth curves", TEXT, claims, [table], [Picture("depth_curves", draw(curves["V1"]))]
    )


def depth_curve(projection, corners, count=1000, seed=0):
    """Return how far light has come (count,), and its depth on the map (count,), at random points.

    projection : a `Projection`.
    corners : (n, 3), of the convex body that has the points.
    """
    points = np.random.default_rng(seed).dirichlet(np.full(len(corners), 0.3), count) @ corners
    return projection.light.path_length(*points.T), projection.project(*points.T)[2]


def unevenness(before, after):
    """Return the share, in [0, 1], of the spread of depths that is no straight line of the ways.

    0 if equal lengths along the light have equal depths all over the map.
    """
    line = np.polynomial.Polynomial.fit(before, after, 1)
    return np.std(after - line(before)) / np.std(after)


def curves_of(placement):
    """Projection → (ways, depths)."""
    return {
        name: depth_curve(
            make_techniques({"projection": name}, {})["projection"](placement),
            placement.body.corners,
        )
        for name in PROJECTIONS
    }


def even_claim(uneven):
    most = {name: max(values) for name, values in uneven.items()}
    names = "uniform", "focused", "perspective", "light_space_perspective"
    return Claim(
        "Uniform, focused, PSM and LiSPSM have nearly the same curves.",
        "Figure 4.1",
        "a picture",
        ", ".join(f"{name} up to {most[name]:.2f}" for name in names) + " uneven",
        verdict(all(most[name] < UNEVEN for name in names)),
        "Depth on a map in the picture's own space is as 1/z where the light is before or behind "
        "the eye; LiSPSM divides it by the distance from the apex. Confirmed where all are below "
        f"{UNEVEN:g}.",
    )


def worse_claim(uneven):
    worse = min(max(uneven[name]) for name in ("trapezoidal", "plane_optimal"))
    others = {n: max(v) for n, v in uneven.items() if n not in ("trapezoidal", "plane_optimal")}
    worst = max(others, key=others.get)
    return Claim(
        "TSM and POSM distort depth more than the other four.",
        "Figure 4.1",
        "a picture",
        f"TSM {max(uneven['trapezoidal']):.2f}, POSM {max(uneven['plane_optimal']):.2f}, of the "
        f"others {worst} {others[worst]:.2f} at most",
        verdict(worse > others[worst]),
        "By the largest unevenness over the views. Without PSM it holds."
        if worst == "perspective" and worse > sorted(others.values())[-2]
        else "By the largest unevenness over the views.",
    )


def draw(curves):
    """Mean depth over the way, of V1."""
    drawn = figure(7.5, 3.4)
    axes = drawn.subplots()
    for (name, (way, depth)), colour in zip(curves.items(), COLOURS, strict=False):
        way = (way - way.min()) / np.ptp(way)
        axes.plot(way, depth, ".", ms=2, color=colour, label=PROJECTIONS[name])
    tidy(axes, "view V1", "depth on the map")
    axes.set_xlabel("way of the light")
    drawn.legend(loc="outside right center", frameon=False, fontsize=8, markerscale=4)
    return drawn
