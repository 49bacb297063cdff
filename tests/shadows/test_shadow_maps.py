"""Shadow maps of every light against shadow rays."""

import mitsuba as mi
import numpy as np
import pytest
from shadow_scenes import LIGHTS, light, objects_on_a_ground, placement_of, seen_from

from brdfkit.core.errors import BrdfkitError
from brdfkit.core.projective.camera import Camera
from brdfkit.shadows.maps.light_shadow import DEPTHS, LightShadow
from brdfkit.shadows.maps.techniques import FILES

pytestmark = pytest.mark.usefixtures("llvm_variant")


@pytest.mark.parametrize("kind", LIGHTS)
@pytest.mark.parametrize("projection", FILES["projection"])
def test_the_error_falls_with_the_resolution(kind, projection):
    """What differs is borders: their share of the picture is as the width of a texel."""
    scene = objects_on_a_ground(kind)
    si, facing, lit = seen_from(scene)
    placement = placement_of(scene)

    def wrong(resolution):
        shadow = LightShadow(scene, placement, projection, resolution=resolution)
        return ((np.array(shadow.visibility(si.p, si.n)) != lit) & facing).sum() / facing.sum()

    coarse, fine = wrong(64), wrong(1024)
    assert coarse < 0.02
    assert fine < 0.002


@pytest.mark.parametrize("kind", ["directional", "point"])
def test_linear_depth_has_the_shadows_of_projected_depth(kind):
    scene = objects_on_a_ground(kind)
    si, facing, _ = seen_from(scene)
    placement = placement_of(scene)
    projected, linear = (
        LightShadow(scene, placement, "trapezoidal", resolution=256, depth=depth)
        for depth in DEPTHS
    )
    differ = np.array(projected.visibility(si.p, si.n) != linear.visibility(si.p, si.n)) & facing
    assert differ.sum() / facing.sum() < 1e-3


def test_the_nearest_surface_is_found():
    scene = objects_on_a_ground("point")
    si, _, _ = seen_from(scene)
    placement = placement_of(scene)
    seen = np.array(si.is_valid())
    depths = placement.camera.compute_depths(np.array(si.p).T[seen])
    assert placement.nearest == pytest.approx(depths.min(), rel=0.02)
    assert placement.visible_depths[0] == placement.nearest


@pytest.mark.parametrize("kind", LIGHTS)
@pytest.mark.parametrize("filter", FILES["filter"])
def test_the_error_of_a_filter_falls_with_the_resolution(kind, filter):
    """Borders are as wide as a number of texels."""
    scene = objects_on_a_ground(kind)
    si, facing, lit = seen_from(scene)

    def wrong(resolution):
        shadow = LightShadow(scene, placement_of(scene), filter=filter, resolution=resolution)
        return (np.abs(np.array(shadow.visibility(si.p, si.n)) - lit) * facing).sum() / facing.sum()

    coarse, fine = wrong(64), wrong(512)
    assert coarse < 0.08
    assert fine < 0.012


def test_a_light_among_the_objects_is_one_sentence():
    scene = objects_on_a_ground("point")
    placement = placement_of(scene)
    placement.light.point[:3] = [2, 2, 1]
    with pytest.raises(BrdfkitError, match="one shadow map cannot look all around"):
        LightShadow(scene, placement)


TECHNIQUES = [(kind, name) for kind, files in FILES.items() for name in files]


@pytest.mark.parametrize(("kind", "name"), TECHNIQUES)
def test_the_integrator_takes_every_technique_as_it_is(kind, name):
    """Its picture is that of exact shadows, but for borders."""
    lamp = "point" if name == "cube" else "directional"
    scene = objects_on_a_ground(lamp, size=24)
    technique = {"type": "shadow_map", "resolution": 256, kind: name}
    picture, exact = (
        np.array(mi.render(scene, integrator=mi.load_dict(each), spp=4, seed=1))
        for each in (technique, {"type": "direct", "hide_emitters": True})
    )
    assert abs(picture.mean() / exact.mean() - 1) < 0.05


def test_a_scene_without_shapes_is_one_sentence():
    scene = mi.load_dict(
        {"type": "scene", "camera": {"type": "perspective"}, "light": light("point")}
    )
    with pytest.raises(BrdfkitError, match="no shapes"):
        placement_of(scene)


def test_the_middle_of_a_thin_lens_is_the_camera():
    lens = {"type": "thinlens", "aperture_radius": 0.1, "focus_distance": 3.0, "fov": 40}
    found = Camera.from_sensor(mi.load_dict(lens))
    pinhole = Camera.from_sensor(mi.load_dict({"type": "perspective", "fov": 40}))
    np.testing.assert_allclose(found.matrix, pinhole.matrix)
