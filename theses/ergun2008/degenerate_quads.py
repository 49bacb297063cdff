"""Makes shadow volumes as a vertex program does, section 2.1.11, and counts their quads."""

from itertools import product
from typing import NamedTuple

import numpy as np
from brdfkit.theses.ergun2008 import by_volumes
from brdfkit.theses.ergun2008.by_volumes import ByVolumes

from brdfkit.core.errors import BrdfkitError
from brdfkit.core.jit.llvm import use_variant
from brdfkit.core.jit.threads import in_turn
from brdfkit.core.projective.light import Light
from brdfkit.shadows.maps.scenes import SCENES, VIEWS
from brdfkit.shadows.volumes import light_volumes
from brdfkit.shadows.volumes.casters import is_facing_light
from brdfkit.shadows.volumes.mesh import Mesh
from brdfkit.shadows.volumes.volume import (
    Faces,
    Volume,
    extrude_points,
    make_shadow_volume,
    make_triangular_faces,
    to_homogeneous,
)
from brdfkit.theses.claims import Claim, to_verdict
from brdfkit.theses.page import Section, Table
from brdfkit.theses.replacing import replace_part

SECONDS = 12
NAMES = "objects_on_a_ground", "street"  # scenes whose pictures are compared with rays
AROUND = 8, 16, 32, 64, 128  # sides of round meshes, whose quads are counted
SUN = Light(np.array([0.36, 0.48, 0.8, 0]))  # of the round meshes
OPEN = "cylinder", "disk"  # shapes without an inside
FINE = "sphere"  # shapes of so many triangles that they are only counted
TEXT = f"""A vertex program of 2008 cannot make vertices. So a mesh gets all that a volume may need
before: each triangle has corners of its own, with the normal of its plane, and each edge a quad
between its two triangles, of no width. The program moves corners that face away from the light to
infinity, and quads on the silhouette open to walls. So a mesh of F triangles becomes 4 F triangles
with 3 F corners, whatever the light. Ours has walls of the silhouette alone, and as its cap the
triangles that face the light. `{"` and `".join(NAMES)}` without open shapes, and balls of more and
more triangles, in the sun; a quad counts as two triangles. Pictures of {by_volumes.SIZE} ×
{by_volumes.SIZE} pixels, without the round shapes, are compared with rays as above."""


class Count(NamedTuple):
    """How much is drawn of volumes.

    quads : the quads of the vertex program. open : those that become walls.
    silhouette : the walls of ours.
    theirs, ours : triangles of the vertex program, and of ours.
    """

    quads: int
    open: int
    silhouette: int
    theirs: int
    ours: int


@in_turn
def check_claims(sources, report):
    """Check the claims on shadow volumes of a vertex program, and return their section."""
    use_variant()
    places, wrong, pixels = list(product(NAMES, VIEWS)), 0, 0
    for done, (name, view) in enumerate(places):
        seen = ByVolumes(make_scene_without((*OPEN, FINE), name, view))
        seen.meshes = keep_closed(seen.meshes)
        with replace_part(light_volumes, "make_shadow_volume", make_volume_of_quads):
            wrong += seen.count_wrong()
        pixels += int(seen.facing.sum())
        report(done + 1, len(places) + 1)
    counts = {name: count_scene(make_scene_without(OPEN, name)) for name in NAMES}
    balls = {around: count_mesh(make_ball(around), SUN) for around in AROUND}
    rows = {**counts, **{f"ball, {around} around": its for around, its in balls.items()}}
    head = "meshes", "quads", "of these open", "walls, ours", "triangles", "triangles, ours"
    table = Table(head, [(name, *(f"{n:,}" for n in count)) for name, count in rows.items()])
    claims = [claim_exact(wrong, pixels, len(places)), claim_open(rows), claim_waste(rows, balls)]
    return Section("Shadow volumes of a vertex program", TEXT, claims, [table])


def make_scene_without(kinds, name, view="V1"):
    """Return the dictionary of a scene without some kinds of shapes."""
    found = SCENES[name](view, 1, (by_volumes.SIZE, by_volumes.SIZE))
    return {name: its for name, its in found.items() if name == "type" or its["type"] not in kinds}


def make_volume_of_quads(mesh, light):
    """Return the shadow `Volume` of a closed mesh as a vertex program makes it.

    Its walls are the quads of all edges; those between two triangles that both face the light, or
    both face away from it, have no width.
    """
    edges, first, second = mesh.shared_edges
    facing = is_facing_light(mesh, light)
    near, far = to_homogeneous(mesh.points), extrude_points(mesh.points, light, 0.0)
    # A corner of a quad belongs to one of its triangles, and goes where that triangle goes
    sides = [
        np.where(facing[its][:, None, None], near[edges], far[edges]) for its in (first, second)
    ]
    walls = np.stack([sides[0][:, 1], sides[0][:, 0], sides[1][:, 0], sides[1][:, 1]], axis=1)
    # The plane of a face is that of its first corners, and under the sun the far ones coincide
    walls[~facing[first]] = np.roll(walls[~facing[first]], 2, axis=1)
    front = make_triangular_faces(near[mesh.triangles[facing]])
    back = make_triangular_faces(far[mesh.triangles[~facing]])
    return Volume(*(Faces(corners, np.ones(len(corners), int)) for corners in (walls, front, back)))


def keep_closed(meshes):
    """Return those of the meshes that are closed."""
    closed = []
    for mesh in meshes:
        try:
            _ = mesh.shared_edges
        except BrdfkitError:
            continue
        closed.append(mesh)
    return closed


def count_mesh(mesh, light):
    """Return the `Count` of a mesh in a light."""
    walls = make_volume_of_quads(mesh, light).walls.corners
    is_open = np.any(walls[:, [0, 1]] != walls[:, [3, 2]], axis=(1, 2))
    ours = make_shadow_volume(mesh, light, "light_facing")
    drawn = 2 * len(ours.walls.times) + len(ours.front.times) + len(ours.back.times)
    theirs = len(mesh.triangles) + 2 * len(walls)
    return Count(len(walls), int(is_open.sum()), len(ours.walls.times), theirs, drawn)


def count_scene(description):
    """Return the `Count` of all closed meshes of a scene's dictionary in its sun."""
    import mitsuba as mi

    scene = mi.load_dict(description, parallel=False)
    (emitter,) = scene.emitters()
    light = Light.from_emitter(emitter)
    meshes = keep_closed([Mesh.from_shape(shape) for shape in scene.shapes()])
    return Count(*np.sum([count_mesh(mesh, light) for mesh in meshes], axis=0).tolist())


def make_ball(around):
    """Return a closed mesh of a ball, with `around` sides along its equator."""
    from scipy.spatial import ConvexHull

    up, turn = np.meshgrid(np.arange(1, around // 2), np.arange(around))
    turn = (
        2 * np.pi * (turn.ravel() + up.ravel() / 2) / around
    )  # rows are turned against each other
    up = np.pi * up.ravel() / (around // 2)
    circle = np.column_stack([np.sin(up) * np.cos(turn), np.sin(up) * np.sin(turn), np.cos(up)])
    points = np.vstack([circle, [[0, 0, 1], [0, 0, -1]]])
    hull = ConvexHull(points)
    triangles = hull.simplices.copy()
    a, b, c = points[triangles].transpose(1, 0, 2)
    inwards = np.einsum("ij,ij->i", np.cross(b - a, c - a), hull.equations[:, :3]) < 0
    triangles[inwards] = triangles[inwards][:, ::-1]
    return Mesh("ball", points, triangles)


def claim_exact(wrong, pixels, places):
    return Claim(
        "Quads of no width that a vertex program opens give right volumes.",
        "2.1.11",
        "the statement",
        f"{wrong} of {pixels:,} pixels in {places} pictures differ from rays, by depth-fail",
        to_verdict(wrong == 0),
    )


def claim_open(rows):
    shares = [count.open / count.quads for count in rows.values()]
    same = all(count.open == count.silhouette for count in rows.values())
    return Claim(
        "Only the quads of silhouettes open.",
        "2.1.11",
        "the statement",
        f"{100 * min(shares):.1f} to {100 * max(shares):.1f} % of the quads; "
        f"{'as many as' if same else 'not as many as'} edges of silhouettes",
        to_verdict(same),
        "Counted by edge toggling, which knows nothing of quads.",
        arithmetic=True,
    )


def claim_waste(rows, balls):
    fewest, most = (f"{balls[around].quads:,}" for around in (AROUND[0], AROUND[-1]))
    wasted = [1 - count.open / count.quads for count in balls.values()]
    more = [count.theirs / count.ours for count in rows.values()]
    return Claim(
        "With meshes of many triangles most of the program's work is wasted.",
        "2.1.11",
        "no figure",
        f"{100 * wasted[0]:.0f} % of a ball's {fewest} quads, {100 * wasted[-1]:.1f} % of {most}; "
        f"{min(more):.1f} to {max(more):.1f} times as many triangles as ours",
        to_verdict(bool(np.all(np.diff(wasted) > 0)) and wasted[-1] > 0.9 and min(more) > 1),
        "By counted work. Whether the processor or the program is faster then, as it says, depends "
        "on hardware of 2008, and was not run. Confirmed where the share grows at every step, to "
        "over 90 %.",
        arithmetic=True,
    )
