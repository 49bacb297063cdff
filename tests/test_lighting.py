"""Environments: the tree of blocks, and the emitter that is sampled by it, beside Mitsuba's own."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from brdfkit.checks.plugin_subject import example
from brdfkit.lighting.environment_tree import block_sums, blocks

pytestmark = pytest.mark.quick


def error(values, found):
    """Sum of squared errors about the blocks' means."""
    return sum(np.var(values[y0:y1, x0:x1]) * (y1 - y0) * (x1 - x0) for x0, x1, y0, y1 in found)


@settings(max_examples=50, deadline=None)
@given(st.integers(1, 9), st.integers(1, 12), st.integers(1, 40), st.integers(0, 2**32 - 1))
def test_blocks_cover_a_picture_once(height, width, count, seed):
    values = np.random.default_rng(seed).exponential(size=(height, width))
    found = blocks(values, count)
    covered = np.zeros((height, width), int)
    for x0, x1, y0, y1 in found:
        covered[y0:y1, x0:x1] += 1
    assert (covered == 1).all()
    assert len(found) == min(count, values.size)
    assert block_sums(values, found).sum() == pytest.approx(values.sum())
    fewer = blocks(values, max(count - 1, 1))
    assert error(values, found) <= error(values, fewer) * (1 + 1e-9)


def test_an_even_block_is_not_cut():
    values = np.zeros((4, 6))
    values[:, 4:] = 1.0
    assert blocks(values, 100).tolist() == [[0, 4, 0, 4], [4, 6, 0, 4]]


@settings(max_examples=25, deadline=None)
@given(st.integers(1, 5), st.integers(1, 6), st.integers(0, 2**32 - 1))
def test_the_first_cut_is_the_best_there_is(height, width, seed):
    """Of all cuts of the whole picture, by trying each (Ergun 2015, eq. 6.1)."""
    values = np.random.default_rng(seed).random((height, width))
    columns = [[(0, x, 0, height), (x, width, 0, height)] for x in range(1, width)]
    rows = [[(0, width, 0, y), (0, width, y, height)] for y in range(1, height)]
    best = min((error(values, cut) for cut in columns + rows), default=0.0)
    assert error(values, blocks(values, 2)) == pytest.approx(best, abs=1e-12)


# The emitter


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
    return {k: v for k, v in entries.items() if k != "blocks"} | {"type": "envmap"}


@pytest.mark.parametrize("turned", [False, True])
def test_it_shines_as_mitsubas(llvm_variant, turned):
    """The same rows, columns and interpolation, over the map's edges too, however it is turned."""
    mi = llvm_variant
    turn = mi.ScalarTransform4f().rotate([0.48, 0.6, 0.64], 70)
    pixels = np.random.default_rng(1).random((4, 6, 3)).astype(np.float32)
    settings = {"bitmap": mi.Bitmap(pixels), "scale": 2.0} | ({"to_world": turn} if turned else {})
    entries = example("kdtree_envmap", **settings)
    w = directions()
    found, expected = (radiance(mi, mi.load_dict(e), w) for e in (entries, as_envmap(entries)))
    np.testing.assert_allclose(found, expected, rtol=1e-4, atol=1e-4)


def scene(mi, emitter):
    camera = mi.ScalarTransform4f().look_at([0, 1, 5], [0, 0, 0], [0, 1, 0])
    film = {"type": "hdrfilm", "width": 24, "height": 24, "rfilter": {"type": "box"}}
    return mi.load_dict(
        {
            "type": "scene",
            "integrator": {"type": "prb", "max_depth": 3},
            "sensor": {"type": "perspective", "fov": 30, "to_world": camera, "film": film},
            "ball": {"type": "sphere", "bsdf": {"type": "roughconductor", "alpha": 0.3}},
            "light": emitter,
        }
    )


def test_pictures_are_those_of_mitsubas(llvm_variant):
    """Means of 64 renders within 3 standard errors, by multiple importance sampling."""
    mi = llvm_variant
    means, ours = {}, example("kdtree_envmap")
    for name, entries in {"ours": ours, "theirs": as_envmap(ours)}.items():
        loaded = scene(mi, entries)
        pictures = [np.array(mi.render(loaded, spp=8, seed=seed)).mean() for seed in range(64)]
        means[name] = np.mean(pictures), np.std(pictures) / 8
    (a, error_a), (b, error_b) = means.values()
    assert abs(a - b) < 3 * np.hypot(error_a, error_b)


def test_the_gradient_by_the_map_is_that_of_mitsubas(llvm_variant):
    """Of the mean of a picture, summed over the map; and by `scale` the mean itself."""
    import drjit as dr

    mi = llvm_variant
    found, ours = {}, example("kdtree_envmap")
    for name, entries in {"ours": ours, "theirs": as_envmap(ours)}.items():
        loaded = scene(mi, entries)
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


@pytest.mark.parametrize(
    ("pixels", "said"),
    [
        (np.zeros((4, 8, 3)), "is black all over"),
        (np.full((4, 8, 3), np.nan), "not finite"),
        (np.full((4, 8, 3), -1.0), "values below 0"),
        (np.full((4, 8, 3), np.inf), "not finite"),
        (np.ones((1, 1, 3)), "has 1×1 pixels"),
    ],
)
def test_a_map_that_lights_nothing_is_refused(llvm_variant, pixels, said):
    bitmap = llvm_variant.Bitmap(pixels.astype(np.float32))
    with pytest.raises(RuntimeError) as error:
        llvm_variant.load_dict({"type": "kdtree_envmap", "bitmap": bitmap})
    assert said in str(error.value).splitlines()[-1]


def test_a_map_may_only_be_turned(llvm_variant):
    scaled = llvm_variant.ScalarTransform4f().scale(3)
    with pytest.raises(RuntimeError, match="to_world scales or shears"):
        llvm_variant.load_dict(example("kdtree_envmap", to_world=scaled))


@pytest.mark.parametrize(("value", "said"), [(0.0, "black all over"), (np.nan, "not finite")])
def test_an_optimiser_s_map_lights_too(llvm_variant, value, said):
    parameters = llvm_variant.traverse(llvm_variant.load_dict(example("kdtree_envmap")))
    parameters["data"] = llvm_variant.TensorXf(np.full((4, 8, 3), value, np.float32))
    with pytest.raises(ValueError, match=said):
        parameters.update()


def test_a_map_is_needed_once(llvm_variant):
    for entries in ({"type": "kdtree_envmap"}, example("kdtree_envmap", filename="map.exr")):
        with pytest.raises(RuntimeError, match="a filename, or a bitmap in its place"):
            llvm_variant.load_dict(entries)
