"""Reproduces Figure 4.1, the distribution of depths on shadow maps of six projections."""

from itertools import product

import numpy as np
from brdfkit.theses.ergun2008.projection_claims import NEARS, OURS, THESIS, judge
from brdfkit.theses.ergun2008.thesis_forms import BY_NEAR, make_thesis_forms
from brdfkit.theses.ergun2008.views import PROJECTIONS, SCENES, load_placements

from brdfkit.core.jit.llvm import use_variant
from brdfkit.core.jit.threads import in_turn
from brdfkit.shadows.maps.scenes import VIEWS
from brdfkit.shadows.maps.techniques import make_techniques
from brdfkit.theses.claims import Claim
from brdfkit.theses.drawing import COLOURS, make_figure, style_axes
from brdfkit.theses.page import Picture, Section, Table

SECONDS = 4
SCENE = "objects_on_a_ground"  # whose curves are drawn
NEARLY = 0.01, 0.05, 0.1  # unevenness of depths, below which curves count as nearly straight
SETTINGS = {OURS: ("scene", "view"), THESIS: ("scene", "view", "near plane")}
FORMS = (OURS,), *((THESIS, near) for near in NEARS)
ALIKE = "uniform", "focused", "perspective", "light_space_perspective"
WORSE = "trapezoidal", "plane_optimal"
TEXT = f"""Of random points in all that a view shows and what may shadow it, as far as they are on
the map: the depth there over the way of the light. *Unevenness* is the share of the spread of
depths that is no straight line; the uniform and the focused projection have straight lines, for the
light is directional. The curves of the thesis are in a picture that is not at hand, of an untold
scene and view. So its claims are tried for all scenes, light 1 × views, and for the thesis's forms
of Table 1 × its near planes. *Nearly* means an unevenness below
{", ".join(f"{share:g}" for share in NEARLY)}."""


@in_turn
def check_claims(sources, report):
    """Check the claims on depths on shadow maps of six projections; return their section."""
    use_variant()
    uneven, drawn, on_rays = {OURS: {}, THESIS: {}}, {}, []
    for done, scene in enumerate(SCENES):
        for view, placement in load_placements(scene).items():
            spread = spread_points(placement.relevant_body.corners)
            ray = sample_middle_ray(placement)
            for form, *near in FORMS:
                projections = make_projections(placement, *near)
                curves = {name: find_depths(each, spread) for name, each in projections.items()}
                found = {name: measure_unevenness(*curve) for name, curve in curves.items()}
                uneven[form][scene, view, *near] = found
                on_rays += [measure_unevenness(*find_depths(p, ray)) for p in projections.values()]
                if (scene, view) == (SCENE, "V1"):
                    drawn[describe_form(form, *near)] = curves
        report(done + 1, len(SCENES))
    caption = f"`{SCENE}`, view V1. The number in brackets is the near plane, see Table 1."
    pictures = [Picture("depth_curves", draw_depth_curves(drawn), caption)]
    claims = [claim_alike(uneven, max(on_rays)), claim_worse(uneven)]
    return Section("Depth curves", TEXT, claims, [make_table(uneven)], pictures)


def sample_depth_curve(projection, corners):
    """Return the length of the light's way to random points on a map, and their depth there.

    projection : the `Projection` of the map.
    corners : the corners (n, 3) of the convex body that contains the points.
    """
    return find_depths(projection, spread_points(corners))


def find_depths(projection, points):
    """Return the length of the light's way to those of the points (n, 3) on a map, and the depth.

    The depth is that on the map; points beside the map are left out.
    """
    x, y, depth = projection.project(*points.T)
    on_map = projection.is_projectable(*points.T) & (np.abs([x, y]).max(axis=0) <= 1 + 1e-9)
    return projection.light.path_length(*points[on_map].T), depth[on_map]


def sample_middle_ray(placement):
    """Return points (n, 3) of the ray of light through the middle of what a view shows.

    They are all within what it shows and what may shadow it.
    """
    body, middle = placement.relevant_body, placement.visible_body.centroid
    way = np.array(placement.light.direction(*middle))
    speeds, gaps = body.planes[:, :3] @ way, -body.planes[:, :3] @ middle - body.planes[:, 3]
    ends = [np.min(gaps[side] / np.abs(speeds[side])) for side in (speeds < 0, speeds > 0)]
    return middle + np.linspace(-ends[0], ends[1], 100)[:, None] * way


def spread_points(corners, count=1000, seed=0):
    """Return random points (count, 3) of the convex body with some corners (n, 3)."""
    return np.random.default_rng(seed).dirichlet(np.full(len(corners), 0.3), count) @ corners


def measure_unevenness(before, after):
    """Return the share, in [0, 1], of the spread of depths that is no straight line of the ways.

    It is 0 if equal lengths along the light have equal depths all over the map.
    """
    line = np.polynomial.Polynomial.fit(before, after, 1)
    return np.std(after - line(before)) / np.std(after)


def make_projections(placement, near=None):
    """Return the six projections by name: ours, or the thesis's with a near plane of `NEARS`."""
    projections = {
        name: make_techniques({"projection": name}, {})["projection"](placement)
        for name in PROJECTIONS
    }
    return projections | make_thesis_forms(placement, NEARS[near]) if near else projections


def describe_form(form, near=None):
    return f"{form} ({near})" if near else form


def claim_alike(uneven, on_rays):
    alike = {
        form: {
            (*where, f"{nearly:g}"): max(its[name] for name in ALIKE) < nearly
            for (where, its), nearly in product(cells.items(), NEARLY)
        }
        for form, cells in uneven.items()
    }
    settings = {form: (*names, "bound of nearly") for form, names in SETTINGS.items()}
    ours, verdict = judge(alike, bool, settings)
    most = {
        form: [max(its[name] for its in cells.values()) for name in ALIKE[2:]]
        for form, cells in uneven.items()
    }
    return Claim(
        "Uniform, focused, PSM and LiSPSM have nearly the same curves.",
        "Figure 4.1",
        "a picture",
        f"{ours}; the thesis's PSM and LiSPSM up to {most[THESIS][0]:.2f} and "
        f"{most[THESIS][1]:.2f} uneven, ours {most[OURS][0]:.2f} and {most[OURS][1]:.2f}",
        verdict,
        "Depth on a map in the picture's own space is as 1/z where the light is before or behind "
        "the eye; LiSPSM divides it by the distance from the apex. On a single ray of sunlight all "
        f"six are straight, TSM and POSM, too (at most {on_rays:.0e} uneven): a matrix divides all "
        "points of a ray alike. So only points all over the map tell projections apart.",
    )


def claim_worse(uneven):
    def is_worse(its, rivals):
        return min(its[name] for name in WORSE) > max(its[name] for name in rivals)

    others = [name for name in PROJECTIONS if name not in WORSE]
    without_psm = [name for name in others if name != "perspective"]
    ours, verdict = judge(uneven, lambda its: is_worse(its, others), SETTINGS)
    rest, rest_verdict = judge(uneven, lambda its: is_worse(its, without_psm), SETTINGS)
    return Claim(
        "TSM and POSM distort depth more than the other four.",
        "Figure 4.1",
        "a picture",
        ours,
        verdict,
        f"But for PSM: {rest_verdict}; {rest}.",
    )


def make_table(uneven):
    """Return a table of the unevenness in each scene, of the least and the most uneven view."""
    rows = []
    for (form, *near), name in product(FORMS, PROJECTIONS):
        if near and name not in BY_NEAR:
            continue
        views = [[uneven[form][scene, view, *near][name] for view in VIEWS] for scene in SCENES]
        cells = (f"{min(values):.3f} to {max(values):.3f}" for values in views)
        rows.append((PROJECTIONS[name], describe_form(form, *near), *cells))
    caption = "Least and largest unevenness of depths over the views; light 1."
    return Table(("projection", "form", *SCENES), rows, caption)


def draw_depth_curves(drawn):
    """Draw the depth on the map over the way of the light, a panel for each form."""
    figure = make_figure(11, 3.6)
    for axes, (form, curves) in zip(figure.subplots(1, len(drawn)), drawn.items(), strict=True):
        for (name, (way, depth)), colour in zip(curves.items(), COLOURS, strict=False):
            way, depth = ((its - its.min()) / np.ptp(its) for its in (way, depth))
            axes.plot(way, depth, ".", ms=2, color=colour, label=PROJECTIONS[name])
        style_axes(axes, form, "depth on the map")
        axes.set_xlabel("way of the light")
    lines = axes.get_legend_handles_labels()
    figure.legend(*lines, loc="outside lower center", ncols=3, frameon=False, markerscale=4)
    return figure
