"""An object that moves: the time to update its parts, and pictures by its parts and triangles.

The thesis claims it, and shows no scene that moves.
"""

import math

import numpy as np
from brdfkit.theses.ergun2015.convex_study import GREY, NO_COACD, SETTING, has_coacd, shown, swept

from brdfkit.core.jit.llvm import use_variant
from brdfkit.core.jit.threads import in_turn
from brdfkit.images.errors.psnr import psnr
from brdfkit.theses.claims import NOT_RUN, Claim, measure_cpu_seconds, verdict
from brdfkit.theses.drawing import figure
from brdfkit.theses.page import Picture, Section

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
def run(sources, report):
    """The times, the frames, and the claim."""
    use_variant()
    if not has_coacd():
        return Section(TITLE, TEXT, [Claim(*CLAIM, "", NOT_RUN, NO_COACD)])
    name, study = swept(sources)
    seconds = update_times(study)
    report(1, 2)
    drawn, errors = frames(study)
    parts, triangles, instance = seconds.values()
    claim = Claim(
        *CLAIM,
        f"{1e3 * parts:.1f} ms, {triangles / parts:.0f} times as fast as the tree over triangles, "
        f"{instance / parts:.1f} times as fast as a Mitsuba instance",
        verdict(parts < triangles),
        f"Seconds of CPU, the median of {MOVES} motions of {name}: {len(study.faces):,} triangles, "
        f"{len(study.convex.hulls)} parts. An instance moves with its own tree as it is, too.",
    )
    caption = (
        "By the parts (above) and by the triangles (below); PSNR "
        f"{min(errors):.1f} to {max(errors):.1f} dB."
    )
    return Section(TITLE, TEXT, [claim], pictures=[Picture("moving_parts", drawn, caption)])


def update_times(study):
    """Seconds of CPU for a rigid motion: of the parts; of Mitsuba's tree over the triangles; and
    of its small tree over instances."""
    import mitsuba as mi

    mesh = mi.load_dict({"type": "scene", "mesh": plain_mesh(study)}, parallel=False)
    group = {"type": "shapegroup", "mesh": plain_mesh(study)}
    instance = {"type": "instance", "group": {"type": "ref", "id": "group"}}
    entries = {"type": "scene", "group": group, "instance": instance}
    instance = mi.load_dict(entries, parallel=False)
    at = mi.ScalarTransform4f
    turns = [at().rotate([0, 0, 1], 360 * i / MOVES) for i in range(MOVES)]
    matrices = [np.array(turn.matrix) for turn in turns]
    moved = [placed(study.points, matrix) for matrix in matrices]
    return {
        "parts": median_seconds(lambda turn: study.convex.move("mesh", turn), matrices),
        "triangles": median_seconds(update(mesh, "mesh.vertex_positions", mi.Float), moved),
        "instance": median_seconds(update(instance, "instance.to_world", mi.Transform4f), turns),
    }


def frames(study):
    """A figure of a mesh that jumps and turns; the PSNR [dB] of each frame."""
    import mitsuba as mi

    parameters = mi.traverse(study.scene)
    key = next(key for key in parameters.keys() if key.endswith("vertex_positions"))  # noqa: SIM118
    drawn, errors = figure(8, 2.8), []
    grid = drawn.subplots(2, FRAMES)
    for column, phase in enumerate(np.arange(FRAMES) / FRAMES):
        up = mi.ScalarTransform4f().translate([0, 0, 0.6 * math.sin(math.pi * phase)])
        matrix = np.array(up.rotate([0, 0, 1], 360 * phase).matrix)
        parameters[key] = mi.Float(placed(study.points, matrix))
        parameters.update()  # for what the camera sees
        study.convex.move("mesh", matrix)
        pair = study.render(study.convex), study.render(None, study.scene)
        errors.append(psnr(pair[1], pair[0]))
        for axes, picture in zip(grid[:, column], pair, strict=True):
            axes.imshow(shown(picture, pair[1]))
            axes.axis("off")
    return drawn, errors


def plain_mesh(study):
    """The mesh by itself, without normals."""
    import mitsuba as mi

    properties = mi.Properties()
    properties["bsdf"] = mi.load_dict(GREY, parallel=False)
    mesh = mi.Mesh("mesh", len(study.points), len(study.faces), properties)
    buffers = mi.traverse(mesh)
    buffers["vertex_positions"] = study.points.astype(np.float32).ravel()
    buffers["faces"] = study.faces.astype(np.uint32).ravel()
    buffers.update()
    return mesh


def placed(points, matrix):
    """Points (n, 3) moved by a matrix (4, 4), as one array of single precision."""
    return (points @ matrix[:3, :3].T + matrix[:3, 3]).astype(np.float32).ravel()


def update(scene, key, kind):
    """A function that sets a parameter of a scene to a value and waits until rays see it."""
    import drjit as dr
    import mitsuba as mi

    parameters, ray = mi.traverse(scene), mi.Ray3f([0, 0, 9], [0, 0, -1])

    def set_to(value):
        parameters[key] = kind(value)
        parameters.update()
        dr.eval(scene.ray_test(ray))
        dr.sync_thread()

    return set_to


def median_seconds(function, values):
    """Median seconds of CPU of a call of `function` with each of the `values`."""
    return float(np.median([measure_cpu_seconds(function, value) for value in values]))
