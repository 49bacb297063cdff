"""Measures how fast the convex parts of a moving object are updated, and compares its pictures.

The thesis claims that this is fast, and shows no scene that moves.
"""

import math
from itertools import cycle

import numpy as np
from brdfkit.theses.ergun2015.convex_study import (
    GREY,
    NO_COACD,
    SETTING,
    can_decompose,
    make_swept_study,
    to_screen_values,
)

from brdfkit.core.jit.llvm import use_variant
from brdfkit.core.jit.threads import in_turn
from brdfkit.images.errors.psnr import psnr
from brdfkit.theses.claims import NOT_RUN, Claim, to_verdict
from brdfkit.theses.drawing import make_figure
from brdfkit.theses.page import Picture, Section
from brdfkit.theses.timing import compare_times, measure_in_turns

SECONDS = 30
MOVES, FRAMES = 20, 6
TITLE = "An object that moves"
CLAIM = (
    "A tree over convex parts is updated sooner than one over triangles.",
    "10",
    "no figure",
)
TEXT = f"""A rigid motion changes one transform and a small tree. {SETTING}"""


@in_turn
def check_claims(sources, report):
    """Check the claims on the time to move convex parts; return their section of the page."""
    use_variant()
    if not can_decompose():
        return Section(TITLE, TEXT, [Claim(*CLAIM, "", NOT_RUN, NO_COACD)])
    name, study = make_swept_study(sources)
    seconds = measure_update_times(study)
    report(1, 2)
    drawn, errors = draw_frames(study)
    triangles, instance = (
        compare_times(seconds[rival], seconds["parts"]) for rival in ("triangles", "instance")
    )
    claim = Claim(
        *CLAIM,
        f"{1e3 * np.median(seconds['parts']):.1f} ms, {triangles} times as fast as the tree over "
        f"triangles, {instance} times as fast as a Mitsuba instance",
        to_verdict(triangles.low > 1),
        f"Seconds of CPU in one thread, in turns, for {MOVES} motions of {name}: "
        f"{len(study.faces):,} triangles, {len(study.convex.hulls)} parts; in brackets are 95 % "
        "intervals. An instance moves with its own tree as it is, too.",
    )
    caption = (
        "By the parts (above) and by the triangles (below); PSNR "
        f"{min(errors):.1f} to {max(errors):.1f} dB."
    )
    return Section(TITLE, TEXT, [claim], pictures=[Picture("moving_parts", drawn, caption)])


def measure_update_times(study):
    """Return the CPU seconds (MOVES,) of a rigid motion for convex parts and two rivals.

    The rivals are Mitsuba's tree over the triangles and its small tree over instances.
    """
    import mitsuba as mi

    mesh = mi.load_dict({"type": "scene", "mesh": make_plain_mesh(study)}, parallel=False)
    group = {"type": "shapegroup", "mesh": make_plain_mesh(study)}
    instance = {"type": "instance", "group": {"type": "ref", "id": "group"}}
    entries = {"type": "scene", "group": group, "instance": instance}
    instance = mi.load_dict(entries, parallel=False)
    at = mi.ScalarTransform4f
    turns = [at().rotate([0, 0, 1], 360 * i / MOVES) for i in range(MOVES)]
    matrices = [np.array(turn.matrix) for turn in turns]
    moved = [move_points(study.points, matrix) for matrix in matrices]
    set_points = make_updater(mesh, "mesh.vertex_positions", mi.Float)
    set_transform = make_updater(instance, "instance.to_world", mi.Transform4f)
    return measure_in_turns(
        {
            "parts": take_each(lambda matrix: study.convex.move("mesh", matrix), matrices),
            "triangles": take_each(set_points, moved),
            "instance": take_each(set_transform, turns),
        },
        MOVES,
    )


def take_each(function, values):
    """Return a function that calls `function` with the next of the `values`, over and over."""
    following = cycle(values)
    return lambda: function(next(following))


def draw_frames(study):
    """Draw frames of a mesh that jumps and turns; return the figure and each frame's PSNR [dB]."""
    import mitsuba as mi

    parameters = mi.traverse(study.scene)
    key = next(key for key in parameters.keys() if key.endswith("vertex_positions"))  # noqa: SIM118
    drawn, errors = make_figure(8, 2.8), []
    grid = drawn.subplots(2, FRAMES)
    for column, phase in enumerate(np.arange(FRAMES) / FRAMES):
        up = mi.ScalarTransform4f().translate([0, 0, 0.6 * math.sin(math.pi * phase)])
        matrix = np.array(up.rotate([0, 0, 1], 360 * phase).matrix)
        parameters[key] = mi.Float(move_points(study.points, matrix))
        parameters.update()  # the camera sees the triangles, whichever shadows are rendered
        study.convex.move("mesh", matrix)
        pair = study.render(study.convex), study.render(None, study.scene)
        errors.append(psnr(pair[1], pair[0]))
        for axes, picture in zip(grid[:, column], pair, strict=True):
            axes.imshow(to_screen_values(picture, pair[1]))
            axes.axis("off")
    return drawn, errors


def make_plain_mesh(study):
    """Return the mesh alone, without normals, which an update would compute again."""
    import mitsuba as mi

    properties = mi.Properties()
    properties["bsdf"] = mi.load_dict(GREY, parallel=False)
    mesh = mi.Mesh("mesh", len(study.points), len(study.faces), properties)
    buffers = mi.traverse(mesh)
    buffers["vertex_positions"] = study.points.astype(np.float32).ravel()
    buffers["faces"] = study.faces.astype(np.uint32).ravel()
    buffers.update()
    return mesh


def move_points(points, matrix):
    """Return points (n, 3) moved by a matrix (4, 4), as one array of single precision."""
    return (points @ matrix[:3, :3].T + matrix[:3, 3]).astype(np.float32).ravel()


def make_updater(scene, key, kind):
    """Return a function that sets a parameter of a scene and waits until rays see it."""
    import drjit as dr
    import mitsuba as mi

    parameters, ray = mi.traverse(scene), mi.Ray3f([0, 0, 9], [0, 0, -1])

    def set_to(value):
        parameters[key] = kind(value)
        parameters.update()
        dr.eval(scene.ray_test(ray))
        dr.sync_thread()

    return set_to
