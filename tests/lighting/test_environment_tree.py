"""The tree of blocks that a map is cut into."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from brdfkit.lighting.sampling.tree import CRITERIA, Sums, block_sums, build_tree


def error(values, found):
    """Sum of squared errors about the blocks' means."""
    return sum(np.var(values[y0:y1, x0:x1]) * (y1 - y0) * (x1 - x0) for x0, x1, y0, y1 in found)


@pytest.mark.parametrize("criterion", CRITERIA)
@settings(max_examples=25, deadline=None)
@given(st.integers(1, 9), st.integers(1, 12), st.integers(1, 40), st.integers(0, 2**32 - 1))
def test_blocks_cover_a_picture_once(criterion, height, width, count, seed):
    values = np.random.default_rng(seed).exponential(size=(height, width))
    tree = build_tree(values, count, criterion)
    covered = np.zeros((height, width), int)
    for x0, x1, y0, y1 in tree.blocks:
        covered[y0:y1, x0:x1] += 1
    assert (covered == 1).all()
    assert len(tree.blocks) == min(count, values.size)
    assert block_sums(values, tree.blocks).sum() == pytest.approx(values.sum())
    assert error(values, tree.blocks) <= error(values, tree.boxes[:1]) * (1 + 1e-9)


def greedy(values, count, criterion):
    """Algorithm 2 as it is printed: one block after the other, its cut found by trying all."""
    blocks = [(0, values.shape[1], 0, values.shape[0])]
    while len(blocks) < count:
        keys = CRITERIA[criterion](Sums(values), np.array(blocks))
        x0, x1, y0, y1 = blocks.pop(int(keys.argmax()))
        columns = [[(x0, x, y0, y1), (x, x1, y0, y1)] for x in range(x0 + 1, x1)]
        rows = [[(x0, x1, y0, y), (x0, x1, y, y1)] for y in range(y0 + 1, y1)]
        blocks += min(columns + rows, key=lambda cut: error(values, cut))
    return sorted(blocks)


@pytest.mark.quick
@pytest.mark.parametrize("criterion", CRITERIA)
@pytest.mark.parametrize("seed", range(4))
def test_many_cuts_at_once_are_those_of_one_after_the_other(criterion, seed):
    """Ergun 2015, algorithm 2 with eq. 6.1."""
    random = np.random.default_rng(seed)
    values = random.gamma(0.5, size=random.integers(4, 12, 2))
    found = build_tree(values, 13, criterion).blocks
    assert sorted(map(tuple, found.tolist())) == greedy(values, 13, criterion)


@pytest.mark.quick
def test_an_even_block_is_not_cut():
    values = np.zeros((4, 6))
    values[:, 4:] = 1.0
    assert build_tree(values, 100).blocks.tolist() == [[0, 4, 0, 4], [4, 6, 0, 4]]


def variance_of_samples(power, boxes):
    """Of light / density, relative to the square of the light: a point is drawn by its block."""
    sums, areas = (
        block_sums(power, boxes),
        (boxes[:, 1] - boxes[:, 0]) * (boxes[:, 3] - boxes[:, 2]),
    )
    return (block_sums(power**2, boxes) * areas / sums).sum() / power.sum() - 1


def three_lobes():
    """A noisy constant with three lights, 128 × 256, per angle; as in the digest's trial."""
    theta = np.pi * (np.arange(128) + 0.5)[:, None] / 128
    phi = 2 * np.pi * (np.arange(256) + 0.5) / 256
    w = np.stack(
        [np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta) + 0 * phi]
    )
    light = 0.5 + 0.1 * np.random.default_rng(0).random((128, 256))
    for axis, kappa, weight in (
        ((0, 0.6, 0.8), 60, 8.0),
        ((0.8, 0, 0.6), 200, 20.0),
        ((-0.6, -0.8, 0), 20, 3.0),
    ):
        light += weight * np.exp(kappa * (np.tensordot(axis, w, 1) - 1))
    return light * np.sin(theta)


@pytest.mark.quick
def test_the_squared_error_reconstructs_best_and_the_relative_one_samples_best():
    """The claim of Ergun 2015 on sse (C1); and what sampling sees is another error."""
    power = three_lobes()
    trees = {criterion: build_tree(power, 192, criterion).blocks for criterion in CRITERIA}
    errors = {criterion: error(power, blocks) for criterion, blocks in trees.items()}
    assert min(errors, key=errors.get) == "sse"
    noise = {criterion: variance_of_samples(power, blocks) for criterion, blocks in trees.items()}
    assert min(noise, key=noise.get) == "relative"


@pytest.mark.quick
def test_the_relative_error_is_what_a_block_adds_to_the_variance():
    power = three_lobes()
    boxes = build_tree(power, 50).blocks
    added = CRITERIA["relative"](Sums(power), boxes).sum() / power.sum()
    assert added == pytest.approx(variance_of_samples(power, boxes))
