"""Shadow maps that share a scene: where its parts are, that they are all of it, and what they gain.

What parts gain is checked in the street, which is seen from 3 m on to 60 times as far.
"""

from dataclasses import replace
from functools import cache

import drjit as dr
import mitsuba as mi
import numpy as np
import pytest
from shadow_scenes import LIGHTS, objects_on_a_ground, seen_from

from brdfkit.core.errors import BrdfkitError
from brdfkit.core.projective.camera import Camera
from brdfkit.shadows.maps.light_shadow import LightShadow
from brdfkit.shadows.maps.partitions import adaptive, tiled
from brdfkit.shadows.maps.partitions.stable_cascades import snap_projection
from brdfkit.shadows.maps.placement import Placement
from brdfkit.shadows.maps.scenes import LIGHTS as SUNS
from brdfkit.shadows.maps.scenes import SCENES, VIEWS
from brdfkit.shadows.maps.split_planes import compute_split_planes
from brdfkit.shadows.maps.techniques import FILES

pytestmark = pytest.mark.usefixtures("llvm_variant")
ONLY = {"cube": ("point", "spot"), "stable_cascades": ("directional",)}  # the lights of a partition
CASES = [(kind, name) for name in FILES["partition"] for kind in ONLY.get(name, LIGHTS)]
UNFIT = [("cube", "directional"), ("stable_cascades", "point")]
SIZE = 128


@cache
def viewed(scene):
    """The scene of a function, its `Placement`, what is seen, what faces the light, what is lit."""
    scene = scene()
    placement = Placement.from_scene(scene, scene.sensors()[0], scene.emitters()[0])
    return scene, placement, *seen_from(scene, SIZE)


@cache
def objects(kind):
    return lambda: objects_on_a_ground(kind, SIZE)


@cache
def few_objects():
    return objects_on_a_ground("directional", SIZE)


def street():
    return mi.load_dict(SCENES["street"](size=(SIZE, SIZE)))


def wrong(scene, resolution, **technique):
    """The share of the picture where a technique's shadow is not that of rays."""
    scene, placement, si, facing, lit = viewed(scene)
    shadow = LightShadow(scene, placement, resolution=resolution, **technique)
    return ((np.array(shadow.visibility(si.p, si.n)) != lit) & facing).sum() / facing.sum()


@pytest.mark.quick
def test_planes_are_those_of_the_thesis():
    """[Ergun 2008, 2.2.3.4], check 7 of four parts from 1 to 100."""
    expected = {
        "logarithmic": [3.162278, 10, 31.622777],
        "uniform": [25.75, 50.5, 75.25],
        "mean": [14.456139, 30.25, 53.436388],
    }
    for spacing, inner in expected.items():
        assert compute_split_planes(1, 100, 4, spacing) == pytest.approx([1, *inner, 100], abs=1e-6)


def every_point_has_a_texel(shadow, si):
    """Whether each point has a part of the `LightShadow`, and is on its map."""
    part, seen = (
        np.array(shadow.find_part(si.p) + dr.zeros(mi.UInt32, SIZE**2)),
        np.array(si.is_valid()),
    )
    found = (part[seen] < len(shadow.maps)).all()
    for number, its_map in enumerate(shadow.maps):
        places = np.array(mi.Point3f(*its_map.projection.project(*si.p)))[:2]
        found &= (np.abs(places[:, seen & (part == number)]) <= 1 + 1e-4).all()
    return found


@pytest.mark.parametrize(("kind", "partition"), CASES)
@pytest.mark.parametrize("projection", ["focused", "logarithmic_perspective"])
def test_every_point_seen_is_on_the_map_of_one_part(kind, partition, projection):
    """And shadows are those of rays, but for borders as wide as texels."""
    scene, placement, si, facing, lit = viewed(objects(kind))
    shadow = LightShadow(scene, placement, projection, partition=partition, resolution=128)
    assert every_point_has_a_texel(shadow, si)
    assert ((np.array(shadow.visibility(si.p, si.n)) != lit) & facing).sum() / facing.sum() < 0.012


ANY = [name for name in FILES["partition"] if name not in (*ONLY, "whole")]


@pytest.mark.parametrize("partition", ANY)
@pytest.mark.parametrize("projection", FILES["projection"])
def test_every_projection_may_be_parted(projection, partition):
    """Each point seen has a texel, and shadows are nearer to those of rays on finer maps."""
    scene, placement, si, facing, lit = viewed(few_objects)
    wrong = []
    for resolution in (32, 256):
        parted = {"partition": partition, "resolution": resolution}
        shadow = LightShadow(scene, placement, projection, **parted)
        assert every_point_has_a_texel(shadow, si)
        wrong.append(
            ((np.array(shadow.visibility(si.p, si.n)) != lit) & facing).sum() / facing.sum()
        )
    assert wrong[1] < max(0.4 * wrong[0], 0.002)


def test_a_street_gains_by_parts_of_as_many_texels_in_all():
    """Measured, in view V1: 0.73 % is wrong by one map of 1024², 0.18 % by four of 512²."""
    whole = wrong(street, 512)
    assert wrong(street, 256, partition="parallel_split") < 0.7 * whole
    assert wrong(street, 256, partition="stable_cascades") < 0.5 * whole
    assert wrong(street, 128, partition="adaptive") < 0.7 * whole


def test_log_planes_from_the_camera_waste_parts_on_air():
    """Mitsuba's near plane is at 0.01: of surfaces the first is at 3."""
    set_up = {"partition": "parallel_split", "spacing": "logarithmic"}
    by_surfaces, by_camera = (wrong(street, 256, ends=e, **set_up) for e in ("surfaces", "camera"))
    assert by_surfaces < 0.7 * by_camera


def test_cascades_keep_their_texels_as_the_camera_moves_and_turns():
    """Every point stays at its place in a texel, though the texel's number on the map changes."""
    _, placement, *_ = viewed(objects("directional"))
    to_world = mi.ScalarTransform4f().look_at([3.7, -6.2, 4.8], [0.4, 0.2, 0.3], [0, 0, 1])
    sensor = mi.load_dict({"type": "perspective", "fov": 40, "to_world": to_world})
    wide = {"low": 9 * placement.low, "high": 9 * placement.high}  # no map is as wide as the scene
    moved = replace(placement, camera=Camera.from_sensor(sensor), **wide)
    points = np.random.default_rng(7).uniform(-3, 3, (3, 100))
    resolution = 500
    camera = replace(placement.camera, slope_y=moved.camera.slope_y)
    for near, far in ((0, 4), (4, 11)):
        before, after = (
            snap_projection(replace(moved, camera=c), near, far, resolution).project(*points)[:2]
            for c in (camera, moved.camera)
        )
        steps = (np.array(after) - before) * resolution / 2
        assert np.abs(steps).max() > 1
        assert steps == pytest.approx(np.round(steps), abs=1e-6)


def test_a_light_among_the_objects_has_a_cube():
    other = objects_on_a_ground("point", SIZE)
    scene = mi.load_dict(
        {
            "type": "scene",
            "light": {"type": "point", "position": [0.4, -1.5, 1.2]},
            "camera": other.sensors()[0],
            **{f"shape_{i}": shape for i, shape in enumerate(other.shapes())},
        }
    )
    placement = Placement.from_scene(scene, scene.sensors()[0], scene.emitters()[0])
    with pytest.raises(BrdfkitError, match="use partition='cube'"):
        LightShadow(scene, placement)
    si, facing, lit = seen_from(scene, SIZE)
    shadow = LightShadow(scene, placement, partition="cube", resolution=512)
    assert len(shadow.maps) >= 5
    assert ((np.array(shadow.visibility(si.p, si.n)) != lit) & facing).sum() / facing.sum() < 0.005
    assert (~lit & facing).sum() > 500


@pytest.mark.parametrize(("partition", "kind"), UNFIT)
def test_lights_that_a_partition_cannot_have_are_one_sentence(partition, kind):
    scene, placement, *_ = viewed(objects(kind))
    with pytest.raises(BrdfkitError, match=r"need a directional light|surrounds a point"):
        LightShadow(scene, placement, partition=partition)


def test_tiles_share_the_texels_so_that_the_least_is_wrong():
    """r ∝ w^(1/3) has the least Σ w / r: less than any other with as many texels."""
    random = np.random.default_rng(3)
    weights = random.uniform(0, 5, (4, 4)) ** 3
    sizes = tiled.distribute_texels(weights, 4096)
    assert (sizes**2).sum() == pytest.approx(4096**2, rel=0.01)
    for _ in range(20):
        other = sizes * random.uniform(0.9, 1.1, (4, 4))
        other *= np.sqrt((sizes**2).sum() / (other**2).sum())
        assert (weights / sizes).sum() < (weights / other).sum()


def test_a_tree_is_finest_where_the_weights_are():
    places = np.array([[0.3, 0.7], [0.31, 0.7], [-0.9, -0.9]])
    leaves = adaptive.grow_quadtree(places, np.array([5.0, 5, 1]), budget=13)
    table = adaptive.make_leaf_table(leaves)
    level, row, column = leaves[table[int(0.85 * len(table)), int(0.65 * len(table))]]
    assert (level, row, column) == (4, int(0.85 * 16), int(0.65 * 16))
    assert len(leaves) == 13
    assert sum(4.0**-level for level, _, _ in leaves) == 1


def test_what_the_parts_hold_has_derivatives():
    """As their maps do: here each part holds a number, by which its points' x is multiplied."""
    scene, placement, si, *_ = viewed(objects("directional"))
    shadow = LightShadow(scene, placement, partition="parallel_split", resolution=16)
    held = [mi.Float(1 + i) for i, _ in enumerate(shadow.maps)]
    dr.enable_grad(held)
    for its_map, number in zip(shadow.maps, held, strict=True):
        its_map.visibility = lambda p, n, active, number=number: p.x * number
    seen = si.is_valid()
    dr.backward(dr.sum(dr.select(seen, shadow.visibility(si.p, si.n, seen), 0)))
    part = np.array(shadow.find_part(si.p))
    for i, number in enumerate(held):
        its_own = np.array(si.p.x)[np.array(seen) & (part == i)]
        assert its_own.size > 0
        assert dr.grad(number)[0] == pytest.approx(its_own.sum(dtype=float), rel=1e-3, abs=0.05)


@pytest.mark.parametrize("name", SCENES)
def test_scenes_have_sun_and_shadow_in_every_view(name):
    for view, sun in zip(VIEWS, [*SUNS, *SUNS], strict=True):
        scene = mi.load_dict(SCENES[name](view, sun, (32, 32)))
        _, facing, lit = seen_from(scene, 32)
        assert facing.mean() > 0.25
        assert (lit & facing).mean() > 0.02
        assert (~lit & facing).mean() > 0.02


@pytest.mark.parametrize("asked", [{"view": "V5"}, {"light": 3}])
def test_a_view_or_a_light_that_is_none_is_one_sentence(asked):
    with pytest.raises(BrdfkitError, match=r"no (view|light) '?(V5|3)"):
        SCENES["street"](**asked)
