"""Defines groups of small pictures for the page `distance_fields.md`, each on one subject."""

from math import pi

from distance_field_gallery.highlights import highlights
from distance_field_gallery.stage import bulb, camera, scene

from brdfkit.distance_fields import box, capped_cone, plane, rounded_box, sphere, torus

TRUTH, RAYS = "monte_carlo", 128
TRUTHS = TRUTH, "exact"


def shadows_of(field, lamp, view, *shadows):
    """The same field with several kinds of shadows."""
    field, materials = field.made_of("all"), {"all": [0.7, 0.7, 0.7]}
    return {s: scene(field, materials, {"lamp": lamp}, view, shadow=s, rays=RAYS) for s in shadows}


def methods():
    """Shadows of each method: eight answers to how much of the lamp a point sees. `hard` looks at
    its middle; `quilez` and `aaltonen` are known from games, and make shadows too large; the others
    march along the cone to the lamp, and take for one straight edge what they meet. Such an edge
    leaves light behind what is thinner than the cone, as the column. The light that is left in full
    shadow is the error that a march may make, ε = 1/20.
    """
    cone = capped_cone((-0.7, -1.1, 0), (-0.7, -1.1, 0.9), 0.25, 0)
    column = box((0.7, 0.7, 1.6)).rotate(0.4).at(0.5, 0.7, 0.8)
    ring = torus(0.4, 0.12).at(0.4, -0.9, 0.12)
    field = sphere(0.6).at(-1, 0.3, 0.6) | column | ring | cone | plane()
    lamp, view = bulb([-4, -1, 5], 1, [22, 22, 22]), camera([1, -6, 5], [0.5, 0, 0.3], 36)
    kinds = "hard", "quilez", "aaltonen", "discrete", "linear", "convex", "split", TRUTH
    return shadows_of(field, lamp, view, *kinds)


def leaks():
    """A leak: each block hides one half of the lamp. One march knows of one edge, and lets light
    through the seam of the two shadows. `split` marches along seven narrower cones, of which each
    has its own edge [Bálint et al. 2019, figure 6.19].
    """
    block = box((1.6, 1.8, 0.8))
    field = block.at(-0.7, 0.3, 1.1) | block.at(0.7, 0.3, 2.1) | plane()
    lamp, view = bulb([0, -4, 6], 0.8, [55, 55, 55]), camera([3.5, 7, 5], [0.1, 1.3, 0.5], 36)
    return shadows_of(field, lamp, view, "hard", "linear", "split", TRUTH)


def points():
    """Pointed occluders: where a corner reaches into the cone, a straight edge takes away more
    of the lamp than the corner does. One march makes such shadows too dark around the corners
    [Bálint et al. 2019, figure 6.17].
    """
    dice = box(0.9).rotate(pi / 4).rotate(0.9553, (1, 0, 0)).at(-0.8, 0, 1.1)
    spike = capped_cone((0.9, 0, 0.4), (0.9, 0, 1.9), 0.4, 0)
    lamp, view = bulb([-3, -2, 6], 1.2, [25, 25, 25]), camera([0.4, -6, 3.6], [0.3, 0.3, 0.7], 36)
    return shadows_of(dice | spike | plane(), lamp, view, "hard", "linear", "split", TRUTH)


def blends():
    """Smooth unions: `.k(width)` blends the right side of an operator in. Each point has the
    material of the part that has the larger share of it; a cut, of what cuts.
    """
    ball, bar = sphere(0.7).made_of("ball"), rounded_box((0.6, 0.6, 2.2), 0.1).made_of("bar")
    bar = bar.rotate(pi / 2, (0, 1, 0)).rotate(-0.5).at(0, 0, 0.3)
    fields = {
        "ball | bar": ball | bar,
        "ball | bar.k(0.3)": ball | bar.k(0.3),
        "ball | bar.k(0.9)": ball | bar.k(0.9),
        "ball - bar.k(0.2)": ball - bar.k(0.2),
    }
    lights = {
        "lamp": bulb([-3, -3, 5], 0.8, [40, 38, 34]),
        "fill": bulb([5, -6, 3], 1, [4, 5, 7]),
    }
    materials, view = (
        {"ball": "red_plastic", "bar": "blasted_gold"},
        camera([0, -6, 3], [0, 0, 0.6], 30),
    )
    return {
        name: scene(field.at(0, 0, 0.75) | plane(), materials, lights, view)
        for name, field in fields.items()
    }


LESSONS = methods, leaks, points, highlights, blends
