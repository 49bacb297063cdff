"""`refine` of Mitsuba's own materials, and what an error leaves behind: nothing."""

import drjit as dr
import numpy as np
import pytest
from refined_scenes import TRUTH, alone, corner, noisy, require_back, views

import brdfkit as bk
from brdfkit.inverse.scenes.problem.parameters import choose_unknowns
from brdfkit.inverse.scenes.problem.scene_parameters import ROUGHNESS_BOUNDS, SHARE_BOUNDS
from brdfkit.inverse.scenes.search import forward_derivatives as module
from brdfkit.inverse.scenes.search.forward_derivatives import compute_derivatives

GREY = {"type": "rgb", "value": [0.4, 0.3, 0.2]}
PLASTIC = {"type": "roughplastic", "alpha": 0.2, "diffuse_reflectance": GREY}
PRINCIPLED = {
    "type": "principled",
    "base_color": GREY,
    "roughness": 0.3,
    "metallic": 0.2,
    "specular": 0.4,
}
METAL = {
    "type": "roughconductor",
    "alpha": 0.3,
    "eta": {"type": "rgb", "value": [0.2, 0.9, 1.1]},
    "k": {"type": "rgb", "value": [3.9, 2.4, 2.2]},
}


def with_bsdf(mi, bsdf, **more):
    scene = corner(mi, TRUTH, size=12)
    scene["ball"]["bsdf"] = bsdf
    return {**scene, **more}


NUMBERS = {
    "roughplastic": (PLASTIC, "ball.bsdf.diffuse_reflectance"),
    "roughplastic's alpha": (PLASTIC, "ball.bsdf.alpha"),
    "roughplastic's eta": (PLASTIC, "ball.bsdf.eta"),
    "principled": (PRINCIPLED, "ball.bsdf.base_color"),
    "principled's roughness": (PRINCIPLED, "ball.bsdf.roughness"),
    "principled's specular": (PRINCIPLED, "ball.bsdf.specular"),
    "roughconductor": (METAL, "ball.bsdf.alpha"),
    "roughconductor's eta": (METAL, "ball.bsdf.eta"),
    "plastic": ({"type": "plastic", "diffuse_reflectance": GREY}, "ball.bsdf.diffuse_reflectance"),
    "two sides": ({"type": "twosided", "bsdf": PLASTIC}, "ball.bsdf.brdf_0.alpha"),
    "a blend": (
        {"type": "blendbsdf", "weight": 0.4, "a": {"type": "diffuse"}, "b": PLASTIC},
        "ball.bsdf.weight",
    ),
    "a blend's part": (
        {"type": "blendbsdf", "weight": 0.4, "a": {"type": "diffuse"}, "b": PLASTIC},
        "ball.bsdf.bsdf_1.alpha",
    ),
    "a mask": ({"type": "mask", "opacity": 0.6, "b": {"type": "diffuse"}}, "ball.bsdf.opacity"),
}


@pytest.mark.parametrize("case", NUMBERS)
def test_derivatives_are_those_of_finite_differences(mi, case):
    """Those of roughplastic's alpha were half of the whole, and failed at first."""
    bsdf, name = NUMBERS[case]
    scene = with_bsdf(mi, bsdf)
    found = views(mi, np.array(mi.render(mi.load_dict(scene), spp=4)), scene, [name])
    x, step = found.start, 0.03
    along = compute_derivatives(found, x, 512, 3).sum(axis=0)
    ends = [
        [found.render_residuals(x + sign * step, 1024, seed) for sign in (1, -1)]
        for seed in (50, 900)
    ]
    one, other = ((high - low) / (2 * step) for high, low in ends)
    # two, lest their noise make their square too large
    ratio = (along * (one + other)).sum() / (2 * one * other).sum()
    assert ratio == pytest.approx(1, abs=0.1)


def test_the_scale_of_a_sky_comes_back(mi):
    sky = {"type": "envmap", "bitmap": mi.Bitmap(np.float32(np.full((4, 8, 3), 0.7)))}
    scene = alone(mi, {"type": "diffuse", "reflectance": GREY}, sky={**sky, "scale": 1.5})
    del scene["lamp"]
    (picture,) = noisy(mi, scene, 64)
    scene["sky"]["scale"] = 1.0
    result = bk.refine(scene, picture, parameters=["sky.scale"], spp=64)
    require_back(result, {"sky.scale": 1.5})


def test_roughplastic_comes_back(mi):
    names = ["ball.bsdf.alpha", "ball.bsdf.diffuse_reflectance"]
    (picture,) = noisy(mi, alone(mi, PLASTIC))
    begin = alone(mi, {"type": "roughplastic", "alpha": 0.4, "diffuse_reflectance": 0.5})
    begin["ball"]["bsdf"]["diffuse_reflectance"] = {"type": "rgb", "value": [0.5, 0.5, 0.5]}
    result = bk.refine(begin, picture, parameters=names, starts=1, spp=256)
    require_back(result, {names[0]: 0.2, names[1]: (0.4, 0.3, 0.2)})


def test_shares_and_roughnesses_of_mitsuba_have_bounds(mi):
    scene = mi.load_dict(with_bsdf(mi, PRINCIPLED), optimize=False)
    names = {"roughness": ROUGHNESS_BOUNDS, "metallic": SHARE_BOUNDS, "base_color": (0, np.inf)}
    for name, bounds in names.items():
        (one,) = choose_unknowns(mi.traverse(scene), [f"ball.bsdf.{name}"])
        assert (one.low, one.high) == bounds
        assert not one.has_wrong_derivatives
    (wider,) = choose_unknowns(mi.traverse(scene), {"ball.bsdf.roughness": (0.1, 2)})
    assert (wider.low, wider.high) == (0.1, 2)


def test_an_error_leaves_no_derivatives_behind(mi, monkeypatch):
    """Dr.Jit's loops go through the BSDFs of all scenes: the next good search failed, too."""
    scene, name = with_bsdf(mi, PLASTIC), "ball.bsdf.diffuse_reflectance"
    picture = np.array(mi.render(mi.load_dict(scene), spp=16))
    broken = mi.load_dict(scene, optimize=False)
    # what makes Dr.Jit fail within its loop, as it did
    with monkeypatch.context() as patch:
        patch.setattr(module.dr, "traverse", lambda *how, **more: None)
        with pytest.raises(RuntimeError, match="isolate_grad"):
            bk.refine(broken, picture, parameters=[name], starts=1, spp=16)
    assert not any(dr.grad_enabled(value) for _, value in mi.traverse(broken))
    good = with_bsdf(mi, {"type": "diffuse", "reflectance": GREY})
    names = ["ball.bsdf.reflectance"]
    assert bk.refine(good, picture, parameters=names, starts=1, spp=16, steps=1).steps == 1
    assert bk.refine(broken, picture, parameters=[name], starts=1, spp=16).steps
