"""Progressive pictures: what passes add up to, how sure that is, and a reset as a fresh start."""

from dataclasses import replace

import numpy as np
import pytest

from brdfkit.images.errors.noise import Accumulated
from brdfkit.rendering.progressive import Progressive
from brdfkit.rendering.volumes.scene import describe_scene
from brdfkit.volumes import TransferFunction, Volume

RNG = np.random.default_rng(3)


@pytest.fixture
def scene(llvm_variant):
    """A wall that glows, seen through noise: a lamp of which each ray meets another place."""
    mi = llvm_variant
    return mi.load_dict(
        {
            "type": "scene",
            "integrator": {"type": "path", "max_depth": 2},
            "sensor": {
                "type": "perspective",
                "to_world": mi.ScalarTransform4f().look_at([0, 0, 3], [0, 0, 0], [0, 1, 0]),
                "film": {"type": "hdrfilm", "width": 6, "height": 5, "rfilter": {"type": "box"}},
            },
            "wall": {"type": "rectangle", "bsdf": {"type": "diffuse"}},
            "lamp": {
                "type": "sphere",
                "center": [1, 1, 1.5],
                "emitter": {"type": "area", "radiance": 5.0},
            },
        }
    )


@pytest.fixture
def growing(scene):
    return Progressive({"wall": scene}, seed=3)


def grow(growing, passes, spp=2):
    """What the passes alone are; they are integrated as well."""
    pictures = []
    for _ in range(passes):
        pictures.append(growing.generate("wall", spp))
        growing.integrate({"wall": pictures[-1]}, spp)
    return pictures


def test_the_mean_of_the_passes_is_what_they_add_up_to(growing):
    pictures = grow(growing, 5)
    found = growing.accumulated["wall"]
    np.testing.assert_allclose(found.picture, np.mean(pictures, axis=0), rtol=1e-6)
    assert (found.passes, found.spp, found.picture.dtype) == (5, 10, np.float32)
    assert len({p.tobytes() for p in pictures}) == 5  # each has samples of its own


def test_a_reset_is_a_fresh_start(growing, scene):
    first = grow(growing, 4)
    growing.reset()
    assert growing.accumulated["wall"] == Accumulated()
    for fresh in (growing, Progressive({"wall": scene}, seed=3)):
        again = grow(fresh, 4)
        np.testing.assert_allclose(again, first, rtol=1e-6)  # threads sum up in any order


def test_what_is_not_integrated_counts_for_nothing(growing):
    (only,) = grow(growing, 1)
    growing.generate("wall", 2)
    np.testing.assert_array_equal(growing.accumulated["wall"].picture, only)


def test_a_changed_scene_shows_after_a_reset(growing, llvm_variant):
    before = np.mean(grow(growing, 3), axis=0)
    parameters = llvm_variant.traverse(growing.scenes["wall"])
    parameters["lamp.emitter.radiance.value"] = 10.0
    parameters.update()
    growing.reset()
    np.testing.assert_allclose(np.mean(grow(growing, 3), axis=0), 2 * before, rtol=1e-5)


def test_a_changed_volume_shows_after_a_reset(llvm_variant):
    """Its bounds are found anew: twice the extinction is as another volume with it."""
    volume = Volume(RNG.random((4, 4, 4)))
    white = TransferFunction([0, 1], [[0.9] * 3 + [0], [0.9] * 3 + [1]])

    def scene_of(function):
        view = (8, 8), (30, 20), ("studio", 0.02), {}
        return llvm_variant.load_dict(describe_scene(volume, function, "single_scattering", *view))

    growing = Progressive({"volume": scene_of(white)})
    growing.integrate({"volume": growing.generate("volume", 4)}, 4)
    parameters = llvm_variant.traverse(growing.scenes["volume"])
    parameters["integrator.extinction.extinction"] = 2.0
    parameters.update()
    growing.reset()
    fresh = Progressive({"volume": scene_of(replace(white, extinction=2))})
    np.testing.assert_allclose(
        growing.generate("volume", 4), fresh.generate("volume", 4), rtol=1e-4, atol=1e-5
    )


@pytest.mark.quick
def test_standard_errors_are_those_of_the_mean():
    """Of 4,000 pixels, 9 passes of 1 to 3 samples. Mean and square of (mean - truth) / error
    are off by 4 standard errors once in 16,000: Student's t of 8 degrees has the variance 8 / 6,
    and 4th moment 8."""
    n, w = 4000, RNG.integers(1, 4, 9)
    found = Accumulated()
    for spp in w.tolist():
        found = found.add_pass(RNG.normal(2, 0.3 / np.sqrt(spp), n).astype(np.float32), spp)
    t = (found.picture - 2) / found.standard_error
    assert abs(t.mean()) < 4 * np.sqrt(8 / 6 / n)
    assert abs(np.square(t).mean() - 8 / 6) < 4 * np.sqrt((8 - (8 / 6) ** 2) / n)
    assert Accumulated().add_pass(np.ones(3), 4).standard_error is None


@pytest.mark.quick
def test_sums_do_not_stall():
    """0/1 of mean 0.1: half floats are off by 0.097 after 10,000 passes [Lesar 2018, chapter 6]."""
    passes = RNG.random((10_000, 20)) < 0.1
    found = Accumulated()
    for one in passes.astype(np.float32):
        found = found.add_pass(one, 1)
    np.testing.assert_allclose(found.picture, passes.mean(axis=0), rtol=1e-7)
