"""Compares stencil shadow volumes with shadow rays, section 2.1."""

import numpy as np
from brdfkit.theses.ergun2008 import by_volumes
from brdfkit.theses.ergun2008.by_volumes import (
    RAYS,
    SIZE,
    ByVolumes,
    make_bricks,
    place_eye_in_shadow,
)

from brdfkit.core.jit.llvm import use_variant
from brdfkit.core.jit.threads import in_turn
from brdfkit.core.projective.light import Light
from brdfkit.shadows.maps.scenes import SCENES, VIEWS
from brdfkit.shadows.volumes.casters import CASTERS
from brdfkit.shadows.volumes.light_volumes import METHODS
from brdfkit.shadows.volumes.mesh import Mesh
from brdfkit.shadows.volumes.silhouettes import SILHOUETTES
from brdfkit.theses.claims import Claim, to_verdict
from brdfkit.theses.drawing import make_figure
from brdfkit.theses.page import Picture, Section

SECONDS = 30
NAMES = "objects_on_a_ground", "street"
TEXT = f"""Volumes of `objects_on_a_ground` and `street`, in pictures of {SIZE} × {SIZE} pixels.
Pixels that face the light are compared to shadow rays; one that differs is wrong unless the border
of a shadow goes through it, by {RAYS} × {RAYS} more rays. `foliage` is left out: each of its
48,000 triangles has walls of its own. What goes wrong by other settings is shown on the bricks of
`objects_on_a_ground`, view V1."""


@in_turn
def check_claims(sources, report):
    """Check the claims on stencil shadow volumes; return their section of the page."""
    use_variant()
    differ, counted, done = dict.fromkeys(METHODS, 0), 0, 0
    places = [(name, view) for name in NAMES for view in VIEWS]
    for name, view in places:
        seen = ByVolumes(SCENES[name](view, 1, (by_volumes.SIZE, by_volumes.SIZE)))
        for method in METHODS:
            differ[method] += seen.count_wrong(method=method)
        counted += int(seen.facing.sum())
        report(done := done + 1, len(places) + 3)
    inside = ByVolumes(place_eye_in_shadow())
    report(done + 1, len(places) + 3)
    claims = [
        claim_exact(differ, counted, len(places)),
        claim_inside(differ, inside),
        claim_near(),
        claim_cap(inside),
        claim_far(),
        claim_length(),
        claim_silhouettes(),
    ]
    caption = (
        "The eye in a shadow: what is lit by depth-pass, depth-fail and rays. Depth-pass misses "
        "that the eye is in a volume: where its ray leaves that again all is dark, and what stands "
        "in the same shadow is lit."
    )
    return Section(
        "Stencil shadow volumes",
        TEXT,
        claims,
        [],
        [Picture("stencil", draw_methods(inside), caption)],
    )


def claim_exact(differ, counted, places):
    return Claim(
        "Stencil volumes are exact in every pixel, by depth-fail.",
        "2.1, 4.2",
        "taken for the truth",
        f"{differ['depth_fail']} of {counted:,} pixels in {places} pictures differ from rays",
        to_verdict(differ["depth_fail"] == 0),
    )


def claim_inside(differ, inside):
    shares = [inside.measure_wrong_share(method=method) for method in ("depth_pass", "depth_fail")]
    return Claim(
        "Depth-pass is right but where the eye is in a volume; depth-fail is right there, too.",
        "2.1.2, 2.1.9",
        "the statement",
        f"outside {differ['depth_pass']} pixels differ; inside {100 * shares[0]:.1f} % by "
        f"depth-pass, {100 * shares[1]:.1f} % by depth-fail",
        to_verdict(differ["depth_pass"] == 0 and shares[0] > 0.1 and shares[1] == 0),
        "So where a camera only looks from above, depth-pass is enough, and not depth-fail, as is "
        "printed in 2.1.10.",
    )


def claim_near():
    cut = ByVolumes(make_bricks(near_clip=9.0))
    shares = [cut.measure_wrong_share(method=method) for method in ("depth_pass", "depth_fail")]
    return Claim(
        "Depth-pass fails where the near plane cuts a volume.",
        "2.1.7",
        "a picture",
        f"{100 * shares[0]:.1f} % of the pixels; depth-fail {100 * shares[1]:.1f} %",
        to_verdict(shares[0] > 0 == shares[1]),
    )


def claim_cap(inside):
    seen = ByVolumes(make_bricks(near_clip=9.0)), inside
    shares = [each.measure_wrong_share(method="depth_pass", near_cap=True) for each in seen]
    return Claim(
        "A cap on the near plane leaves cracks, so that depth-pass is not mended.",
        "2.1.7",
        "the statement",
        f"{100 * shares[0]:.1f} % of the pixels where the plane cuts a volume, and "
        f"{100 * shares[1]:.1f} % with the eye in one",
        to_verdict(max(shares) > 0),
        "By brdfkit's cap, which is another than the thesis's: no face is clipped or projected, "
        "and the light sees the casters through the near plane.",
    )


def claim_far():
    cut = ByVolumes(make_bricks(far_clip=14.0))
    shares = [cut.measure_wrong_share(far_plane=plane) for plane in ("finite", "infinite")]
    return Claim(
        "Depth-fail fails where the far plane cuts a volume, and a plane at infinity mends it.",
        "2.1.7, 2.1.8",
        "a picture",
        f"{100 * shares[0]:.1f} % of the pixels, and {100 * shares[1]:.1f} %",
        to_verdict(shares[0] > 0 == shares[1]),
    )


def claim_length():
    seen, lengths = ByVolumes(make_bricks()), (0.5, 2.0, 50.0)
    shares = [seen.measure_wrong_share(length=length) for length in lengths]
    ours = (f"{100 * s:.1f} % at {length:g}" for s, length in zip(shares, lengths, strict=True))
    return Claim(
        "Volumes that end too soon lose shadows; a long one is enough.",
        "2.1.1",
        "a picture",
        ", ".join(ours),
        to_verdict(shares[0] > shares[1] > shares[2] == 0),
        "Pixels that are wrong, by the length of the walls; bricks are up to 2 high.",
    )


def claim_silhouettes():
    import mitsuba as mi

    cube = Mesh.from_shape(mi.load_dict({"type": "cube"}))
    found = {
        name: [
            len(way(cube, CASTERS["light_facing"](cube, Light(np.array([*direction, 0.0]))))[0])
            for direction in ((0, 0, 1), (1, 1, 1))
        ]
        for name, way in SILHOUETTES.items()
    }
    one, other = found.values()
    return Claim(
        "Both ways find the silhouette of a cube lit along a face's normal, and along a diagonal.",
        "2.1.5",
        "4 and 6 edges",
        f"{one[0]} and {one[1]} edges" + ("" if one == other else f"; {other[0]} and {other[1]}"),
        to_verdict(one == other == [4, 6]),
        arithmetic=True,
    )


def draw_methods(inside):
    """Draw the lit pixels by both methods of counting, and by rays."""
    drawn = make_figure(7.5, 2.7)
    pictures = {
        "depth-pass": inside.compute_lit(method="depth_pass"),
        "depth-fail": inside.compute_lit(method="depth_fail"),
        "rays": inside.exact,
    }
    for axes, (name, lit) in zip(drawn.subplots(1, 3), pictures.items(), strict=True):
        picture = inside.view.seen.compute_picture(lit * 0.9 + 0.1)
        axes.imshow((picture / picture.max()).clip(0, 1) ** (1 / 2.2))
        axes.set_title(name, size=10)
        axes.set_axis_off()
    return drawn
