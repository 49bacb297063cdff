"""Where light collides in volumes, by majorants of all or of parts: closed forms and quadrature."""

import drjit as dr
import numpy as np
import pytest
from scipy.ndimage import map_coordinates

from brdfkit.core.errors import BrdfkitError
from brdfkit.volumes.light.constant_medium import split_light
from brdfkit.volumes.light.majorants import Majorants
from brdfkit.volumes.light.tracking import (
    FAINT,
    estimate_passed_and_collided_light,
    estimate_transmittance,
    sample_collision,
)

N = 1 << 17
DEVIATIONS = 4.5  # of a mean: one in 150 000 is farther
# σ = 0.25 + 1.5 z along z from 0 to 2: the share that comes through, the mean distance of a
# collision, ∫ T dz
THROUGH, MEAN, SEEN = 0.030197, 0.83229, 2.8195 / 3.25
TALL = np.diag([1.0, 1.0, 2.0, 1.0])
STEPS = (0.25 + 1.5 * np.arange(0.125, 2.1, 0.125)).reshape(-1, 1, 1)


def linear(p, active):
    return 0.25 + 1.5 * p.z


def along_z(mi, z=-1.0):
    zero = dr.zeros(mi.Float, N)
    return mi.Ray3f(mi.Point3f(zero + 0.3, zero + 0.4, z), mi.Vector3f(0, 0, 1))


def sampler(mi, n=N, seed=0):
    made = mi.load_dict({"type": "independent"})
    made.seed(seed, n)
    return made


def require_mean(found, expected, rounding=0.0):
    """The mean of random numbers is what it should be, within its error."""
    error = np.std(found) / np.sqrt(len(found))
    assert abs(np.mean(found) - expected) < DEVIATIONS * error + rounding


@pytest.mark.parametrize("bounds", [3.25, 6.5, 26.0, STEPS], ids=["3.25", "6.5", "26", "steps"])
def test_collisions_in_a_linear_medium(bounds, llvm_variant):
    mi = llvm_variant
    majorants = Majorants(np.broadcast_to(bounds, (np.size(bounds), 1, 1)), TALL)
    majorants.require_extinction_below(linear)
    t, lookups = sample_collision(linear, majorants, along_z(mi), 0, dr.inf, sampler(mi))
    t, lookups = np.array(t), np.array(lookups)
    require_mean(np.isinf(t), THROUGH, 1e-6)
    require_mean(t[np.isfinite(t)] - 1, MEAN, 1e-5)  # the rays begin 1 before the medium
    if np.size(bounds) == 1:
        require_mean(lookups, bounds * SEEN, 1e-4 * bounds)
    else:
        assert lookups.mean() < 0.4 * 3.25 * SEEN
    share, _ = estimate_transmittance(
        linear, majorants, along_z(mi), 0, dr.inf, sampler(mi, seed=1)
    )
    require_mean(np.array(share), THROUGH, 1e-6)
    assert np.std(np.array(share)) < np.sqrt(THROUGH * (1 - THROUGH))  # of tracking's 0 and 1
    share, collided, t, _ = estimate_passed_and_collided_light(
        linear, majorants, along_z(mi), 0, dr.inf, sampler(mi, seed=2)
    )
    share, collided, t = np.array(share), np.array(collided), np.array(t)
    require_mean(share, THROUGH, 1e-6)
    require_mean(collided, 1 - THROUGH, 1e-6)
    require_mean(collided * np.where(collided > 0, t - 1 - MEAN, 0), 0, 1e-5)
    np.testing.assert_allclose((share + collided)[share > FAINT], 1, rtol=1e-5)


def test_an_extinction_above_its_majorant(llvm_variant):
    """Found before a picture; else it makes what it spoils no number."""
    mi, low = llvm_variant, Majorants([[[1.5]]], TALL)
    with pytest.raises(BrdfkitError, match=r"extinction is 3\.2.* its majorant 1\.5.*raise"):
        low.require_extinction_below(linear)
    for track in (sample_collision, estimate_transmittance, estimate_passed_and_collided_light):
        found, *_ = track(linear, low, along_z(mi), 0, dr.inf, sampler(mi))
        assert np.isnan(np.array(found)).any()
        below, *_ = track(linear, low, along_z(mi), 0, 1.8, sampler(mi))  # z < 0.8
        assert not np.isnan(np.array(below)).any()


@pytest.mark.quick
@pytest.mark.parametrize("wrong", [[[[-1.0]]], [[[np.nan]]], [[1.0]], np.ones((0, 1, 1))])
def test_what_is_no_bound_is_refused(wrong, llvm_variant):
    with pytest.raises(BrdfkitError, match="finite numbers"):
        Majorants(wrong)


@pytest.fixture
def turned(llvm_variant):
    """A sparse grid of random voxels, turned and stretched: (σ, voxels, cube_to_world)."""
    mi = llvm_variant
    rng = np.random.default_rng(3)
    voxels = rng.random((9, 14, 11), np.float32) * 8
    voxels[rng.random(voxels.shape) < 0.7] = 0
    voxels[:, :8] = 0
    to_world = mi.ScalarTransform4f().rotate([2 / 3, 2 / 3, -1 / 3], 50).scale([2, 1, 3])
    grid = {"type": "gridvolume", "grid": mi.VolumeGrid(voxels[..., None]), "to_world": to_world}
    volume = mi.load_dict({**grid, "raw": True})

    def sigma(p, active):
        it = dr.zeros(mi.Interaction3f)
        it.p = p
        return volume.eval_1(it, active)

    return sigma, voxels, np.array(to_world.matrix)


@pytest.mark.quick
@pytest.mark.parametrize("size", [1, 2, 5, 100])
def test_bounds_of_a_grid_bound_what_lies_between_voxels(size, turned):
    sigma, voxels, to_world = turned
    majorants = Majorants.from_grid(voxels, size, to_world)
    majorants.require_extinction_below(sigma)
    assert majorants.shape == tuple(-(-n // size) for n in voxels.shape[::-1])
    assert majorants.values.max() == voxels.max()
    if size <= 2:
        assert majorants.values.min() == 0


@pytest.mark.parametrize("size", [2, 100])
def test_rays_through_a_turned_grid(size, turned, llvm_variant):
    """Of any direction, from inside or outside, and along edges of cells: by quadrature."""
    mi, (sigma, voxels, to_world) = llvm_variant, turned
    majorants = Majorants.from_grid(voxels, size, to_world)
    rng, n, t_max = np.random.default_rng(4), 1 << 13, 0.7
    # in the unit cube
    o, d = rng.random((3, n)) * 1.4 - 0.2, rng.normal(size=(3, n)) / 2
    d[:, : n // 4] = np.eye(3)[rng.integers(3, size=n // 4)].T
    depth = optical_depths(voxels, o, d, t_max)
    turn, shift = to_world[:3, :3], to_world[:3, 3:]
    world = ((turn @ o + shift).astype(np.float32), (turn @ d).astype(np.float32))
    ray = mi.Ray3f(mi.Point3f(world[0]), mi.Vector3f(world[1]))
    share, _ = estimate_transmittance(sigma, majorants, ray, 0, t_max, sampler(mi, n))
    require_mean(np.array(share) - np.exp(-depth), 0, 1e-4)
    distance, _ = sample_collision(sigma, majorants, ray, 0, t_max, sampler(mi, n, 1))
    distance = np.array(distance)
    require_mean(np.isinf(distance) - np.exp(-depth), 0, 1e-4)
    assert (distance[np.isfinite(distance)] <= t_max).all()
    assert not np.isnan(distance).any()


def optical_depths(voxels, o, d, t_max, steps=256):
    """∫ σ dt from 0 to `t_max` along rays (3, n) through voxels in the unit cube."""
    t = (np.arange(steps) + 0.5) / steps * t_max
    p = o[..., None] + d[..., None] * t
    sizes = np.array(voxels.shape[::-1]).reshape(3, 1, 1)
    between = map_coordinates(voxels, (p * sizes - 0.5)[::-1], order=1, mode="nearest")
    return np.where(((p > 0) & (p < 1)).all(axis=0), between, 0).sum(axis=-1) * t_max / steps


@pytest.mark.quick
def test_rays_that_miss_or_are_not_asked(llvm_variant):
    mi, majorants = llvm_variant, Majorants([[[3.0]]])
    beside = mi.Ray3f(mi.Point3f([0.5, 2, 0.5], 0.5, -1), mi.Vector3f(0, 0, 1))
    asked = mi.Bool([True, True, False])
    for track, expected in (
        (sample_collision, np.inf),
        (estimate_transmittance, 1.0),
        (estimate_passed_and_collided_light, 1.0),
    ):
        rays = majorants, beside, 0, 9, sampler(mi, 3), asked
        found, *_, lookups = track(lambda p, active: 0 * p.x, *rays)
        np.testing.assert_array_equal(np.array(found), [expected] * 3)
        np.testing.assert_array_equal(np.array(lookups)[1:], 0)


def test_what_collides_has_a_place(llvm_variant):
    """Also by a random number of 1, to which one in millions is rounded: else a pixel is NaN."""
    mi = llvm_variant

    class HalfAndOne:
        calls = 0

        def next_1d(self, active=True):
            self.calls += 1  # the second and fourth draw an optical depth, the third tells
            return mi.Float(0.5 if self.calls % 2 == 0 else 1.0)

    even = Majorants([[[20.0]]])
    found = estimate_passed_and_collided_light(
        lambda p, active: mi.Float(7), even, along_z(mi), 0, dr.inf, HalfAndOne()
    )
    _, collided, t, _ = found
    assert collided[0] > 0
    assert np.isfinite(t[0])


@pytest.mark.parametrize("depth", [1e-6, 9e-3, 1.1e-2, 1.0, 40.0])
def test_collisions_in_a_constant_medium_are_inverted(depth, llvm_variant):
    mi = llvm_variant
    u, sigma, length = np.linspace(0, 1, 64, endpoint=False), 2.5, depth / 2.5
    found = split_light(mi.Float(sigma), mi.Float(length), mi.Float(u.astype(np.float32)))
    passed, collided, t = (np.array(part, float) for part in found)
    np.testing.assert_allclose(passed, np.exp(-depth), rtol=1e-5)
    np.testing.assert_allclose(collided, -np.expm1(-depth), rtol=2e-6)
    # The distribution function, at t, is the random number
    reached = np.expm1(-sigma * t) / np.expm1(-depth)
    np.testing.assert_allclose(reached, u, atol=1e-4)
