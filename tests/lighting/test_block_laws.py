"""Laws of the probabilities of blocks: NumPy's and the renderer's, and their fits."""

import numpy as np
import pytest

from brdfkit.lighting.sampling.block_laws import Hyperbolic, SortedBlocks, Steps
from brdfkit.lighting.sampling.tree import build_tree

pytestmark = pytest.mark.quick


def falling(n=300):
    """Shares (n,) of blocks as maps have them: over decades, the last ones black."""
    shares = np.exp(-8 * np.linspace(0, 1, n) ** 0.4)
    shares[-n // 30 :] = 0
    return shares / shares.sum()


LAWS = {law.__name__: law.fit_to_shares(falling()) for law in (Hyperbolic, Steps)}
LAWS["of one block"] = Steps.fit_to_shares(np.ones(1))


def test_the_hyperbola_s_numbers():
    """Digest of Ergun 2015, 2.1.7: n = 256, u = 5."""
    law = Hyperbolic(256, 5.0)
    p = law.probability(np.arange(256))
    assert p.sum() == pytest.approx(1)
    np.testing.assert_allclose(p[[0, 1, 255]], [0.0460980, 0.0389753, 0.000970593], rtol=1e-6)
    np.testing.assert_allclose(
        law.inverse_cumulative(np.array([0.1, 0.25, 0.5, 0.75, 0.9])),
        [2.425694, 8.439640, 31.124784, 92.100816, 170.741147],
        rtol=1e-6,
    )


def test_a_hyperbola_s_parameter_is_found():
    assert Hyperbolic.fit_to_shares(
        Hyperbolic(256, 5.0).probability(np.arange(256))
    ).u == pytest.approx(5, rel=1e-4)


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
def test_a_law_is_a_distribution(law):
    i, xi = np.arange(law.n), np.linspace(0, 0.999, 101)
    p = law.probability(i)
    assert p.min() >= 0
    assert p.sum() == pytest.approx(1)
    np.testing.assert_allclose(
        law.cumulative_probability(i + 1) - law.cumulative_probability(i), p, atol=1e-12
    )
    np.testing.assert_allclose(
        law.cumulative_probability(law.inverse_cumulative(xi)), xi, atol=1e-9
    )


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
def test_the_renderer_chooses_by_the_law(law, llvm_variant):
    """A point of block i is drawn by the uniform numbers between F(i) and F(i + 1), to rounding."""
    mi = llvm_variant
    tree = build_tree(np.random.default_rng(0).random((20, 30)), law.n)
    shares = np.full(law.n, 1 / law.n)
    blocks = SortedBlocks(
        tree,
        shares,
        np.zeros((law.n, 2)),
        type("Law", (type(law),), {"fit_to_shares": lambda _: law}),
    )
    xi = ((np.arange(40_000) + 0.5) / 40_000).astype(np.float32)
    x, y, density = (
        np.array(a) for a in blocks.sample(mi.Point2f(mi.Float(xi), mi.Float(0.5)), True)
    )
    i = np.minimum(np.floor(law.inverse_cumulative(xi.astype(float))), law.n - 1).astype(int)
    x0, x1, y0, y1 = tree.blocks[i].T  # the shares are equal: sorted as they are
    rest = (xi - law.cumulative_probability(i)) / law.probability(i)
    expected = x0 + rest.clip(0, 1) * (x1 - x0)
    off = np.abs(x - expected) > 0.01 * (x1 - x0)
    assert off.mean() < 5e-3
    np.testing.assert_allclose(y, (y0 + y1) / 2, atol=1e-4)
    p = law.probability(i) * 600 / ((x1 - x0) * (y1 - y0))
    assert (np.abs(density - p) > 2e-3 * p).mean() < 1e-3


def test_steps_are_nearer_than_the_hyperbola():
    """By the variance of choosing, Σ P² / P̂ - 1, which is 0 for the exact shares."""
    shares = falling()
    i = np.flatnonzero(shares)
    noise = {
        name: (shares[i] ** 2 / law.probability(i)).sum() - 1
        for name, law in LAWS.items()
        if name != "of one block"
    }
    assert noise["Steps"] < 0.1 < noise["Hyperbolic"]
