"""The integrator of largest values: beside a dense march, never above it; colours; derivatives."""

import drjit as dr
import numpy as np
import pytest

from brdfkit.volumes import TransferFunction, Volume
from brdfkit.volumes.rays.search import find_distance_of_maximum


@pytest.fixture
def mi(llvm_variant):
    return llvm_variant


def gridvolume(mi, values):
    return {"type": "gridvolume", "grid": mi.VolumeGrid(values[..., None].astype(np.float32))}


def scene(mi, **integrator):
    """Light behind the unit cube, and nothing else; of rays that a test makes."""
    return mi.load_dict(
        {
            "type": "scene",
            "integrator": {"type": "maximum_intensity", **integrator},
            "behind": {"type": "constant", "radiance": 0.5},
        }
    )


def seen(mi, loaded, origins, directions, seed=0):
    """The radiance (n, 3) along rays."""
    sampler = mi.load_dict({"type": "independent"})
    sampler.seed(seed, len(origins))
    o, d = (np.ascontiguousarray(x.T, np.float32) for x in (origins, directions))
    ray = mi.RayDifferential3f(mi.Ray3f(mi.Point3f(o), mi.Vector3f(d)))
    return np.array(loaded.integrator().sample(loaded, sampler, ray)[0]).T


def rays(n):
    """Through the unit cube, from a sphere around it: origins, and unit directions."""
    rng = np.random.default_rng(5)
    ends = rng.normal(size=(2, n, 3))
    ends[0] = 0.5 + 2 * ends[0] / np.linalg.norm(ends[0], axis=1, keepdims=True)
    ends[1] = rng.uniform(0.2, 0.8, (n, 3))
    d = ends[1] - ends[0]
    return ends[0], d / np.linalg.norm(d, axis=1, keepdims=True)


def test_the_largest_value_is_found_from_below(mi):
    """Of waves along 400 rays: never above the truth, nearer in more steps, at last equal."""
    rng = np.random.default_rng(1)
    frequency, phase = rng.uniform(3, 40, (2, 400)), rng.uniform(0, 6, (2, 400))
    t = np.linspace(0, 1, 20_001)
    truth = sum(np.sin(f[:, None] * t + p[:, None]) for f, p in zip(frequency, phase, strict=True))
    truth = truth.max(axis=1)
    waves = [(mi.Float(f), mi.Float(p)) for f, p in zip(frequency, phase, strict=True)]

    def value(t):
        return sum(dr.sin(f * t + p) for f, p in waves)

    near, far, place = mi.Float(np.zeros(400)), mi.Float(np.ones(400)), mi.Float(rng.random(400))
    missing = []
    for steps in (4, 32, 256):
        found = value(find_distance_of_maximum(value, near, far, steps, place, mi.Bool(True)))
        missing.append(truth - np.array(found))
        assert missing[-1].min() > -1e-5, steps
    means = [m.mean() for m in missing]
    assert means[0] > 10 * means[1] > 10 * means[2]
    assert np.abs(missing[-1]).max() < 2e-5


def test_a_volume_beside_a_dense_march(mi):
    """In grey, of oblique rays; the largest over passes rises."""
    values = np.random.default_rng(2).uniform(0, 9, (6, 5, 7))
    to_world = np.diag([1 / 7, 1 / 5, 1 / 6, 1])
    to_world[:3, 3] = np.diag(to_world)[:3] / 2
    o, d = rays(60)
    t = np.linspace(0.5, 3.5, 10_001)
    known = Volume(values, to_world)((o[:, None] + t[:, None] * d[:, None]).reshape(-1, 3))
    truth = known.reshape(60, -1).max(axis=1)
    dense, sparse = (scene(mi, volume=gridvolume(mi, values), steps=n) for n in (200, 12))
    np.testing.assert_allclose(seen(mi, dense, o, d)[:, 0], truth, rtol=2e-3)

    passes = [seen(mi, sparse, o, d, seed)[:, 0] for seed in range(8)]
    missing = truth - np.maximum.accumulate(passes)
    assert missing.min() > -0.01  # the march has steps, too
    assert missing[0].mean() > 0.01 > abs(missing[-1].mean())


def test_colours_lie_before_what_is_behind(mi):
    function = TransferFunction([0, 4], [[0.2, 0.4, 0.8, 0], [0.2, 0.4, 0.8, 1]])
    values = np.zeros((8, 8, 8))
    values[3:5, 3:5, 3:5] = 3
    volume = {"values": gridvolume(mi, values), "transfer": function.to_json()}
    loaded = scene(mi, volume={"type": "transfer_function", **volume})
    o = np.array([[0.5, 0.5, 3], [0.05, 0.05, 3], [9, 9, 3]])
    found = seen(mi, loaded, o, np.tile([0, 0, -1.0], (3, 1)))
    light = np.array([0.2, 0.4, 0.8])
    np.testing.assert_allclose(found, [0.75 * light + 0.125, [0.5] * 3, [0.5] * 3], rtol=1e-5)


def test_derivatives_are_those_at_the_largest_value(mi):
    """By the values and the table, along random changes, of differences with the same samples."""
    rng = np.random.default_rng(4)
    function = TransferFunction([0, 9], rng.uniform(0.2, 1, (2, 4)))
    values = rng.uniform(1, 8, (5, 5, 5))
    volume = {"values": gridvolume(mi, values), "transfer": function.to_json()}
    loaded = scene(mi, volume={"type": "transfer_function", **volume}, steps=64)
    parameters = mi.traverse(loaded)
    o, d = rays(300)
    sampler = mi.load_dict({"type": "independent"})
    point, direction = (np.ascontiguousarray(x.T, np.float32) for x in (o, d))

    def total():
        sampler.seed(0, 300)
        ray = mi.RayDifferential3f(mi.Ray3f(mi.Point3f(point), mi.Vector3f(direction)))
        return dr.sum(dr.ravel(loaded.integrator().sample(loaded, sampler, ray)[0]))

    for key in ("values.data", "table"):
        name = f"integrator.volume.{key}"
        start = np.array(parameters[name])
        change, ends = rng.random(start.shape, np.float32), []
        leaf = mi.TensorXf(start)
        dr.enable_grad(leaf)
        for value in (leaf, *(mi.TensorXf(start + s * change) for s in (-0.01, 0.01, 0))):
            parameters[name] = value
            parameters.update()
            ends.append(total())
        dr.backward(ends[0])
        exact = float((np.array(dr.grad(leaf)) * change).sum())
        assert exact == pytest.approx((ends[2] - ends[1])[0] / 0.02, rel=0.01), key
