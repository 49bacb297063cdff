"""`tangent_rotation`: a material turned about the normal, beside the formula of the model."""

import drjit as dr
import numpy as np
import pytest

WARD = {"type": "ward", "alpha_u": 0.4, "alpha_v": 0.1, "specular_reflectance": 0.5}
ROUGH = {"type": "roughconductor", "alpha_u": 0.4, "alpha_v": 0.15}
ANGLE = 0.7


def directions(count, seed):
    z = np.random.default_rng(seed).uniform(0.2, 1, count)
    phi = np.random.default_rng(seed + 1).uniform(0, 2 * np.pi, count)
    across = np.sqrt(1 - z * z)
    return np.stack([across * np.cos(phi), across * np.sin(phi), z], axis=1)


def turned(w, angle):
    c, s = np.cos(angle), np.sin(angle)
    return w @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]])


@pytest.mark.parametrize("nested", [WARD, ROUGH], ids=["ward", "roughconductor"])
def test_it_is_the_nested_material_in_turned_directions(mi, nested):
    wi, wo = directions(200, 0), directions(200, 2)

    def values(bsdf, wi, wo):
        si = dr.zeros(mi.SurfaceInteraction3f, len(wi))
        si.wi = mi.Vector3f(wi.T)
        return np.array(mi.load_dict(bsdf).eval(mi.BSDFContext(), si, mi.Vector3f(wo.T)))

    found = values({"type": "tangent_rotation", "angle": ANGLE, "bsdf": nested}, wi, wo)
    expected = values(nested, turned(wi, -ANGLE), turned(wo, -ANGLE))
    np.testing.assert_allclose(found, expected, rtol=2e-4, atol=1e-6)
    assert np.abs(found - values(nested, wi, wo)).max() > 0.1


def test_derivatives_by_the_angle_are_those_of_differences(mi):
    """Of a picture, with the angle of a texel among others."""
    weights = np.random.default_rng(0).random((16, 16, 3)).astype(np.float32)

    def scene(angle):
        angles = mi.Bitmap(np.full((1, 1, 1), angle, np.float32))
        angles = {"type": "bitmap", "bitmap": angles, "raw": True}
        at = mi.ScalarTransform4f()
        return mi.load_dict(
            {
                "type": "scene",
                "integrator": {"type": "prb", "max_depth": 2},
                "ball": {
                    "type": "sphere",
                    "bsdf": {
                        "type": "tangent_rotation",
                        "angle": angles | {"raw": True},
                        "bsdf": WARD,
                    },
                },
                "lamp": {"type": "point", "position": [2, 3, 4], "intensity": 20.0},
                "sensor": {
                    "type": "perspective",
                    "to_world": at.look_at([0, -1, 4], [0, 0, 0], [0, 1, 0]),
                    "film": {"type": "hdrfilm", "width": 16, "height": 16, "pixel_format": "rgb"},
                },
            }
        )

    def loss(scene, params=None):
        picture = mi.render(scene, params=params, spp=1024, seed=1, seed_grad=2)
        return dr.sum(picture.array * mi.Float(weights.ravel()))

    there = scene(ANGLE)
    params = mi.traverse(there)
    dr.enable_grad(params["ball.bsdf.angle.data"])
    params.update()
    dr.backward(loss(there, params))
    slope = np.array(dr.grad(params["ball.bsdf.angle.data"])).sum()
    ends = [float(loss(scene(ANGLE + step))[0]) for step in (0.01, -0.01)]
    assert slope == pytest.approx((ends[0] - ends[1]) / 0.02, rel=0.05)


@pytest.mark.parametrize(
    ("entries", "said"),
    [
        ({"angel": 1.0, "bsdf": WARD}, "did you mean angle"),
        ({"angle": "steep", "bsdf": WARD}, "angle = steep should be a texture or a number"),
        ({"angle": float("nan"), "bsdf": WARD}, "angle = nan should be a texture or a number"),
        ({"bsdf": {"type": "uniform", "value": 1.0}}, "should be a bsdf"),
        ({"inner": WARD}, "there is no parameter 'inner'"),
    ],
)
def test_bad_parameters_are_one_sentence(mi, entries, said):
    with pytest.raises(RuntimeError, match=said):
        mi.load_dict({"type": "tangent_rotation", **entries})


@pytest.mark.parametrize("nested", [WARD, {"type": "plastic"}], ids=["ward", "plastic"])
def test_pictures_of_the_scalar_variant(mi, nested):
    """As a process that crashed: bool of Python's, and Dr.Jit's replace_grad, are traps there."""
    mi.set_variant("scalar_rgb")
    try:

        def picture(bsdf):
            at = mi.ScalarTransform4f().look_at([1, -2, 2], [0, 0, 0], [0, 0, 1])
            film = {"type": "hdrfilm", "width": 6, "height": 6, "rfilter": {"type": "box"}}
            scene = {
                "type": "scene",
                "integrator": {"type": "path", "max_depth": 3},
                "sensor": {"type": "perspective", "to_world": at, "film": film},
                "sample": {"type": "rectangle", "bsdf": bsdf},
                "light": {"type": "constant"},
            }
            return np.array(mi.render(mi.load_dict(scene), spp=4))

        found = picture({"type": "tangent_rotation", "angle": 0.0, "bsdf": nested})
        np.testing.assert_allclose(found, picture(nested), rtol=1e-4)
    finally:
        mi.set_variant("llvm_ad_rgb")
