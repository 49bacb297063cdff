"""Tensor trees: cells that a BRDF has its values in, and texts that are read back."""

import numpy as np
import pytest

from brdfkit.core.geometry.directions import from_angles
from brdfkit.core.geometry.disc import disc_to_square, square_to_disc
from brdfkit.exporting.tensor_tree import (
    TensorTree,
    format_tree,
    merge_cells,
    round_digits,
    tabulate,
)


def read_tree(words, cells):
    """Fill `cells` with the values of a tree, whose words are taken from the end of the list."""
    assert words.pop() == "{"
    values = []
    while words[-1] not in "{}":
        values.append(float(words.pop()))
    if values:
        cells[...] = values[0] if len(values) == 1 else np.reshape(values, cells.shape)
    else:
        n = len(cells) // 2
        for branch in range(2**cells.ndim):
            bits = (branch >> axis & 1 for axis in range(cells.ndim))
            read_tree(words, cells[tuple(slice(n * bit, n * (bit + 1)) for bit in bits)])
    assert words.pop() == "}"


@pytest.mark.parametrize("shape", [(8, 8, 8), (4, 4, 4, 4)])
def test_the_text_of_a_tree_has_its_values(shape):
    cells = np.random.default_rng(0).uniform(0, 3, shape)
    cells[: shape[0] // 2] = 0.7
    cells = round_digits(merge_cells(cells, 0.3))
    text = format_tree(cells)
    back = np.empty(shape)
    read_tree(text.replace("{", " { ").replace("}", " } ").split()[::-1], back)
    np.testing.assert_allclose(back, cells, rtol=1e-12)


def test_blocks_of_almost_equal_values_become_their_mean():
    cells = np.array([[1.0, 1.1, 2.0, 3.0], [1.0, 1.1, 2.0, 3.0], *[[1.0, 1.0, 1.0, 1.0]] * 2])
    merged = np.array([[1.05, 1.05, 2.0, 3.0], [1.05, 1.05, 2.0, 3.0], *[[1.0] * 4] * 2])
    np.testing.assert_allclose(merge_cells(cells, 0.1), merged)
    np.testing.assert_allclose(merge_cells(np.tile(cells[:2, :2], (2, 2)), 0.1), 1.05)


def test_the_disc_goes_back_to_the_square():
    square = np.random.default_rng(0).random((1000, 2))
    disc = square_to_disc(square)
    assert np.hypot(*disc.T).max() <= 1
    np.testing.assert_allclose(disc_to_square(disc), square, atol=1e-12)


@pytest.mark.parametrize("isotropic", [True, False])
def test_a_tree_has_the_values_of_a_brdf(isotropic):
    axis = [1.0, 0.7] if isotropic else [0.5, 0.7]

    def brdf(wi, wo):  # changes slowly, but differs if light and viewer swap
        x, y = (wi[:, :2] + wo[:, :2]).T
        return (axis[0] * x**2 + axis[0 if isotropic else 1] * y**2 + wi[:, 2])[:, None]

    tree = TensorTree("a", tabulate(brdf, 4 if isotropic else 3, isotropic))
    random = np.random.default_rng(0)
    wi, wo = from_angles(random.uniform(0, 1.2, (2, 500)), random.uniform(0, 6.3, (2, 500)))
    errors = tree.eval(wi, wo) - brdf(wi, wo)
    assert np.sqrt(np.mean(errors**2)) < (0.1 if isotropic else 0.2)
    assert not tree.eval(-wi, wo).any()
