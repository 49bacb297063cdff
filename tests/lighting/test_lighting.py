"""The emitter `kdtree_envmap`, beside Mitsuba's own; and maps and settings that it refuses."""

import numpy as np
import pytest
from batches import mean_and_error, render_batches

from brdfkit.checks.plugin_subject import make_example


def directions(n=20_000):
    w = np.random.default_rng(0).normal(size=(n, 3))
    return w / np.linalg.norm(w, axis=1, keepdims=True)


def radiance(mi, emitter, w):
    import drjit as dr

    si = dr.zeros(mi.SurfaceInteraction3f, len(w))
    si.wi = -mi.Vector3f(w.astype(np.float32).T)
    return np.array(emitter.eval(si))


def as_envmap(entries):
    """The dictionary of Mitsuba's `envmap` with the same map."""
    own = ("type", "blocks")
    return {"type": "envmap"} | {k: v for k, v in entries.items() if k not in own}


@pytest.mark.parametrize("turned", [False, True])
def test_it_shines_as_mitsubas(llvm_variant, turned):
    """The same rows, columns and interpolation, over the map's edges too, however it is turned."""
    mi = llvm_variant
    turn = mi.ScalarTransform4f().rotate([0.48, 0.6, 0.64], 70)
    pixels = np.random.default_rng(1).random((4, 6, 3)).astype(np.float32)
    settings = {"bitmap": mi.Bitmap(pixels), "scale": 2.0} | ({"to_world": turn} if turned else {})
    entries = make_example("kdtree_envmap", **settings)
    w = directions()
    found, expected = (radiance(mi, mi.load_dict(e), w) for e in (entries, as_envmap(entries)))
    np.testing.assert_allclose(found, expected, rtol=1e-4, atol=1e-4)


def scene(mi, emitter, integrator, size):
    camera = mi.ScalarTransform4f().look_at([0, 1, 5], [0, 0, 0], [0, 1, 0])
    film = {"type": "hdrfilm", "width": size, "height": size, "rfilter": {"type": "box"}}
    return mi.load_dict(
        {
            "type": "scene",
            "integrator": {"type": integrator, "max_depth": 3},
            "sensor": {"type": "perspective", "fov": 22, "to_world": camera, "film": film},
            "ball": {"type": "sphere", "bsdf": {"type": "roughconductor", "alpha": 0.3}},
            "light": emitter,
        }
    )


def mean_and_error_of_ball(mi, emitter):
    """The mean of 64 pictures of a ball, and its standard error."""
    pictures = render_batches(scene(mi, emitter, "path", 12), batches=64, samples=16)
    return mean_and_error(pictures.mean(axis=1))


@pytest.fixture(scope="module")
def mitsubas_mean(mi):
    """That of Mitsuba's `envmap`, once."""
    return mean_and_error_of_ball(mi, as_envmap(make_example("kdtree_envmap")))


EMITTERS = [
    ("kdtree_envmap", {"distribution": "exact", "lookup": "texture"}),
    ("kdtree_envmap", {"distribution": "hyperbolic", "lookup": "tree"}),
    ("kdtree_envmap", {"distribution": "steps", "lookup": "grid"}),
    ("kdtree_envmap", {"compensated": True}),
    ("sampled_envmap", {"sampler": "cdf"}),
    ("sampled_envmap", {"sampler": "mip"}),
    ("sampled_envmap", {"sampler": "alias", "compensated": True}),
]


@pytest.mark.parametrize(("name", "settings"), EMITTERS)
def test_pictures_are_those_of_mitsubas(name, settings, llvm_variant, mitsubas_mean):
    """Means of 64 renders within 3 standard errors, by multiple importance sampling."""
    (a, error_a), (b, error_b) = (
        mean_and_error_of_ball(llvm_variant, make_example(name, **settings)),
        mitsubas_mean,
    )
    assert abs(a - b) < 3 * np.hypot(error_a, error_b)


def test_the_gradient_by_the_map_is_that_of_mitsubas(llvm_variant):
    """Of the mean of a picture, summed over the map; and by `scale` the mean itself."""
    import drjit as dr

    mi = llvm_variant
    found, ours = {}, make_example("kdtree_envmap")
    for name, entries in {"ours": ours, "theirs": as_envmap(ours)}.items():
        loaded = scene(mi, entries, "prb", 24)
        parameters = mi.traverse(loaded)
        key = next(k for k in parameters.keys() if k.endswith("data"))  # noqa: SIM118
        leaf = mi.TensorXf(dr.detach(parameters[key]))
        dr.enable_grad(leaf)
        parameters[key] = leaf
        parameters.update()
        picture = mi.render(loaded, parameters, spp=256)
        dr.backward(dr.mean(picture, axis=None))
        found[name] = np.array(dr.grad(leaf)).sum()  # Mitsuba's has columns twice, with a part each
    assert found["ours"] == pytest.approx(found["theirs"], rel=0.02)


BRIGHT = np.ones((4, 8, 3))
REFUSED = [
    ({"bitmap": 0 * BRIGHT}, "the bitmap is black all over and lights nothing; give another map."),
    ({"bitmap": np.nan * BRIGHT}, "the bitmap has values that are not finite; mend them."),
    ({"bitmap": np.inf * BRIGHT}, "the bitmap has values that are not finite; mend them."),
    ({"bitmap": -BRIGHT}, "the bitmap has values below 0; mend them."),
    ({"bitmap": np.ones((1, 1, 3))}, "the bitmap has 1×1 pixels; give 2×2 or more."),
    ({"filename": "map.exr"}, "needs a filename, or a bitmap in its place."),
    ({"blocks": 0}, "blocks = 0 should be a number between 1 and 1e+06."),
    ({"blocks": 2_000_000}, "blocks = 2000000 should be a number between 1 and 1e+06."),
    ({"criterion": "mse"}, "criterion = mse should be one of relative, sse, variance, range."),
    (
        {"distribution": "even"},
        "distribution = even should be one of exact, alias, hyperbolic, steps.",
    ),
    ({"lookup": "hash"}, "lookup = hash should be one of texture, tree, grid."),
    ({"compensated": 1}, "compensated = 1 should be true or false."),
]


@pytest.mark.parametrize(("given", "said"), REFUSED)
def test_what_it_cannot_use_is_refused_in_a_sentence(given, said, llvm_variant):
    mi = llvm_variant
    if "bitmap" in given:
        given = given | {"bitmap": mi.Bitmap(given["bitmap"].astype(np.float32))}
    with pytest.raises(RuntimeError) as error:
        mi.load_dict(make_example("kdtree_envmap", **given))
    assert said in str(error.value).splitlines()[-1]


def test_a_map_is_needed(llvm_variant):
    with pytest.raises(RuntimeError, match="a filename, or a bitmap in its place"):
        llvm_variant.load_dict({"type": "kdtree_envmap"})


def test_a_map_that_cannot_be_read_is_named(llvm_variant, tmp_path):
    cut = tmp_path / "cut.exr"
    cut.write_bytes(b"v/1\x01" + bytes(40))
    with pytest.raises(RuntimeError) as error:
        llvm_variant.load_dict({"type": "kdtree_envmap", "filename": str(cut)})
    assert "cut.exr: Mitsuba cannot load it" in str(error.value).splitlines()[-1]


def test_a_map_may_only_be_turned(llvm_variant):
    scaled = llvm_variant.ScalarTransform4f().scale(3)
    with pytest.raises(RuntimeError, match="to_world scales or shears"):
        llvm_variant.load_dict(make_example("kdtree_envmap", to_world=scaled))


@pytest.mark.parametrize(("value", "said"), [(0.0, "black all over"), (np.nan, "not finite")])
def test_an_optimiser_s_map_lights_too(llvm_variant, value, said):
    parameters = llvm_variant.traverse(llvm_variant.load_dict(make_example("kdtree_envmap")))
    parameters["data"] = llvm_variant.TensorXf(np.full((4, 8, 3), value, np.float32))
    with pytest.raises(ValueError, match=said):
        parameters.update()


def test_more_blocks_than_pixels_are_as_many(llvm_variant):
    emitter = llvm_variant.load_dict(make_example("kdtree_envmap", blocks=1_000_000))
    assert len(emitter.map_sampler.shares) <= 15 * 32
