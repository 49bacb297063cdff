"""Reproduces Figure 4.1, the distribution of depths on shadow maps of six projections."""

import numpy as np
from brdfkit.theses.ergun2008.views import PROJECTIONS, View

from brdfkit.core.jit.llvm import use_variant
from brdfkit.core.jit.threads import in_turn
from brdfkit.shadows.maps.scenes import VIEWS
from brdfkit.shadows.maps.techniques import make_techniques
from brdfkit.theses.claims import Claim, to_verdict
from brdfkit.theses.drawing import COLOURS, make_figure, style_axes
from brdfkit.theses.page import Picture, Section, Table

SECONDS = 2
SCENE = "objects_on_a_ground"
UNEVEN = 0.01  # unevenness of depths, below which curves count as straight
TEXT = f"""Of points in all that a view of `{SCENE}` shows and what may shadow it: the depth on the
map over the way of the light. *Unevenness* is the share of the spread of depths that is no straight
line. The curves of the thesis are in a picture that is not at hand."""


@in_turn
def check_claims(sources, report):
    """Check the claims on depths on shadow maps of six projections; return their section."""
    use_variant()
    curves = {view: sample_curves(View.load(SCENE, view, 1).placement) for view in VIEWS}
    uneven = {
        name: [measure_unevenness(*curves[view][name]) for view in VIEWS] for name in PROJECTIONS
    }
    rows = [
        (PROJECTIONS[name], *(f"{value:.3f}" for value in values))
        for name, values in uneven.items()
    ]
    table = Table(("projection", *VIEWS), rows, "Unevenness of depths, light 1.")
    claims = [claim_even(uneven), claim_worse(uneven)]
    return Section(
        "Depth curves",
        TEXT,
        claims,
        [table],
        [Picture("depth_curves", draw_depth_curves(curves["V1"]))],
    )


def sample_depth_curve(projection, corners, count=1000, seed=0):
    """Return the length of the light's way (count,) to random points, and their depth on the map
    (count,).

    projection : the `Projection` of the map.
    corners : the corners (n, 3) of the convex body that contains the points.
    """
    points = np.random.default_rng(seed).dirichlet(np.full(len(corners), 0.3), count) @ corners
    return projection.light.path_length(*points.T), projection.project(*points.T)[2]


def measure_unevenness(before, after):
    """Return the share, in [0, 1], of the spread of depths that is no straight line of the ways.

    It is 0 if equal lengths along the light have equal depths all over the map.
    """
    line = np.polynomial.Polynomial.fit(before, after, 1)
    return np.std(after - line(before)) / np.std(after)


def sample_curves(placement):
    """Return the ways of light and the depths on the map, for each projection."""
    return {
        name: sample_depth_curve(
            make_techniques({"projection": name}, {})["projection"](placement),
            placement.relevant_body.corners,
        )
        for name in PROJECTIONS
    }


def claim_even(uneven):
    most = {name: max(values) for name, values in uneven.items()}
    names = "uniform", "focused", "perspective", "light_space_perspective"
    return Claim(
        "Uniform, focused, PSM and LiSPSM have nearly the same curves.",
        "Figure 4.1",
        "a picture",
        ", ".join(f"{name} up to {most[name]:.2f}" for name in names) + " uneven",
        to_verdict(all(most[name] < UNEVEN for name in names)),
        "Depth on a map in the picture's own space is as 1/z where the light is before or behind "
        "the eye; LiSPSM divides it by the distance from the apex. Confirmed where all are below "
        f"{UNEVEN:g}.",
    )


def claim_worse(uneven):
    worse = min(max(uneven[name]) for name in ("trapezoidal", "plane_optimal"))
    others = {n: max(v) for n, v in uneven.items() if n not in ("trapezoidal", "plane_optimal")}
    worst = max(others, key=others.get)
    return Claim(
        "TSM and POSM distort depth more than the other four.",
        "Figure 4.1",
        "a picture",
        f"TSM {max(uneven['trapezoidal']):.2f}, POSM {max(uneven['plane_optimal']):.2f}, of the "
        f"others {worst} {others[worst]:.2f} at most",
        to_verdict(worse > others[worst]),
        "By the largest unevenness over the views. Without PSM it holds."
        if worst == "perspective" and worse > sorted(others.values())[-2]
        else "By the largest unevenness over the views.",
    )


def draw_depth_curves(curves):
    """Draw the depth on the map over the way of the light, in view V1."""
    drawn = make_figure(7.5, 3.4)
    axes = drawn.subplots()
    for (name, (way, depth)), colour in zip(curves.items(), COLOURS, strict=False):
        way = (way - way.min()) / np.ptp(way)
        axes.plot(way, depth, ".", ms=2, color=colour, label=PROJECTIONS[name])
    style_axes(axes, "view V1", "depth on the map")
    axes.set_xlabel("way of the light")
    drawn.legend(loc="outside right center", frameon=False, fontsize=8, markerscale=4)
    return drawn
