"""Means of a transfer function between two values, and when a volume has them taken."""

import numpy as np
import pytest

from brdfkit.volumes import TransferFunction, Volume
from brdfkit.volumes.rays.voxel_steps import rms_neighbour_difference
from brdfkit.volumes.transfer.lookup import TransferLookup

RNG = np.random.default_rng(8)
HILLS = TransferFunction([-1, 0.5, 2, 2.1, 2.2, 4], RNG.random((6, 4)))


def test_means_between_two_values(llvm_variant):
    """By 10,000 midpoints, in NumPy: near and far, either way, within the range and beyond."""
    mi = llvm_variant
    lookup = TransferLookup(HILLS)
    reach = np.repeat([1e-5, 0.01, 1.0, 50.0], 30)
    front = RNG.uniform(-3, 6, 120).astype(np.float32)
    back = (front + RNG.uniform(-reach, reach)).astype(np.float32)
    rgb, a = lookup.mean_between(*(lookup.integrate_to_value(mi.Float(v)) for v in (front, back)))
    share = (np.arange(10_000) + 0.5) / 10_000
    rgba = HILLS(front[:, None] + share * (back - front)[:, None].astype(float))
    rgba[..., :3] *= rgba[..., 3:]
    np.testing.assert_allclose(np.vstack([rgb, a]).T, rgba.mean(axis=1), atol=3e-4)


def missed(mi, values, function, steps=9, **settings):
    """Whether so many steps of a ray would miss what a function has."""
    values = np.asarray(values, np.float32).reshape(*np.shape(values), 1)
    grid = {"type": "gridvolume", "grid": mi.VolumeGrid(values), **settings}
    entries = {"type": "transfer_function", "values": grid, "transfer": function.to_json()}
    return mi.load_dict(entries).misses_peaks(steps)


def test_which_functions_are_missed(llvm_variant):
    """By how much values change in a step; labels and gradient magnitudes never are."""
    mi = llvm_variant
    far = mi.ScalarTransform4f().translate([5, 6, 7]).scale([2, 3, 4])
    peak = TransferFunction([0, 0.4, 0.5, 0.6, 1], [[1, 1, 1, a] for a in (0, 0, 1, 0, 0)])
    ramp = TransferFunction([0, 1], [[1, 1, 1, 0], [1, 1, 1, 1]])
    stripe = TransferFunction(peak.values, [[r, 1, 1, 1] for r in (0, 0, 1, 0, 0)])
    coarse, fine = (np.broadcast_to(np.linspace(0, 1, n), (3, 2, n)) for n in (5, 200))
    for function in (peak, stripe):
        assert missed(mi, coarse, function, to_world=far)
        assert missed(mi, fine, function)
        assert not missed(mi, fine, function, steps=200)
        assert not missed(mi, coarse, function, filter_type="nearest", to_world=far)
    assert not missed(mi, coarse, ramp)
    two = np.stack([coarse, coarse], axis=-1).astype(np.float32)
    grid = {"type": "gridvolume", "grid": mi.VolumeGrid(two)}
    text = peak.over_gradients([(0, 0), (1, 1)]).to_json()
    both = {"type": "transfer_function", "values": grid, "transfer": text}
    assert not mi.load_dict(both).misses_peaks(9)


def test_typical_differences():
    """Of white noise: √2 times its deviation, in a grid of which not every voxel is asked, too."""
    noise = RNG.normal(0, 3, (60, 300, 200))
    assert rms_neighbour_difference(noise) == pytest.approx(3 * np.sqrt(2), rel=0.01)
    assert rms_neighbour_difference(Volume(np.ones((1, 1, 1))).values) == 0
