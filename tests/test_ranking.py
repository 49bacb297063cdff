"""Rankings: the true model is found, ties are said, and no fit sees what it is held to."""

import json

import drjit as dr
import numpy as np
import pytest
from click.testing import CliRunner

import brdfkit as bk
from brdfkit.checks.material_subject import random_pairs
from brdfkit.cli import main
from brdfkit.errors import BrdfkitError
from brdfkit.geometry.directions import to_half_difference
from brdfkit.measured.selection import select_samples
from brdfkit.model import Model, labels, weight
from brdfkit.model.lobes import Cosine, Lobe
from brdfkit.ranking import ranking
from brdfkit.ranking.held_out import PART, HeldOut, number_blocks
from brdfkit.ranking.result import beside, is_tied, paired_standard_error

TRUTHS = {
    "ward": {"alpha_u": 0.15, "diffuse_reflectance": 0.1},
    "cook_torrance": {"alpha": 0.3, "f0": 0.1, "specular_reflectance": 2.0},
    "oren_nayar": {"sigma": 0.5},
}
NOISE = 0.05


def measured(truth, n=1500, **how):
    """A material of one channel, with noise."""
    wi, wo = random_pairs(n, seed=1, max_degrees=75)
    noise = np.random.default_rng(0).normal(0, NOISE, (n, 1))
    values = truth.eval(wi, wo)[:, :1] * np.exp(noise)
    return bk.Measured.from_samples(wi, wo, values, channels=("Y",), name="synthetic", **how)


@pytest.mark.parametrize("name", TRUTHS)
def test_the_true_model_is_recommended(name):
    """And its held-out error is the noise."""
    found = bk.rank(measured(bk.models()[name](**TRUTHS[name])), TRUTHS)
    assert found.best == name
    assert [row.model for row in found.rows if row.tied] == [name]
    assert found.rows[0].error == pytest.approx(NOISE, rel=0.1)
    assert found.reason.startswith(f"{name} is recommended: its error is the least, by more than")
    assert f"{name}: Shows " in str(found)


def test_ties_are_said_as_ties():
    """More lobes than the truth has follow the noise; the one with fewest parameters is taken."""
    truth = bk.models()["ggx"](alpha_u=0.2)
    found = bk.rank(measured(truth), ["ggx+ggx", "student_t", "lambert", "ggx"])
    rows = {row.model: row for row in found.rows}
    assert found.best == "ggx"
    assert rows["ggx+ggx"].tied
    assert rows["student_t"].tied
    assert not rows["lambert"].tied
    assert rows["ggx"].parameters == 4
    assert rows["ggx+ggx"].parameters == 7
    assert "it has the fewest parameters of 3 models that are tied" in found.reason
    assert "student_t, with 1 more parameter and an error" in found.reason
    # The noise says that more parameters are too many, as the criterion does
    assert rows["ggx"].bic < min(rows["ggx+ggx"].bic, rows["student_t"].bic)


def test_held_out_errors_are_those_of_fits_without_the_fold():
    """Of a constant, whose fit is a mean: by hand."""
    data, rng = measured(bk.models()["ward"](), n=300), np.random.default_rng(0)
    samples = select_samples(data, 80.0)
    held_out = HeldOut.draw(samples, bk.losses["plain"], False, 5, rng)
    values, squares = samples.values[:, 0], np.empty(len(samples.wi))
    for fold in range(5):
        out = held_out.folds == fold
        squares[out] = (values[out] - values[~out].mean()) ** 2
    (row,) = bk.rank(data, "lambert", "plain").rows
    assert row.error == pytest.approx(np.sqrt(squares.mean()), rel=1e-9)
    assert (row.behind, row.uncertainty, row.tied) == (0.0, 0.0, True)


def test_the_uncertainty_is_that_of_the_paired_difference():
    """Where errors differ by as much in each block, it is 0, however these differ."""
    shares = np.full(50, 1 / 50)
    errors = np.random.default_rng(0).random(50) * shares
    assert paired_standard_error(0.1 * shares, shares) == pytest.approx(0, abs=1e-12)
    others = np.roll(errors, 7)
    spread = np.std(others - errors, ddof=1) * np.sqrt(50)
    assert paired_standard_error(others - errors, shares) == pytest.approx(spread)


@pytest.mark.parametrize("anisotropic", [False, True])
def test_blocks_cover_all_directions_and_folds_share_them(anisotropic):
    wi, wo = random_pairs(40_000, seed=0, max_degrees=80)
    blocks = number_blocks(wi, wo, anisotropic)
    theta_h, theta_d, _ = to_half_difference(wi, wo)
    assert set(blocks) == set(range(blocks.max() + 1))
    np.testing.assert_array_equal(number_blocks(wo, wi, anisotropic), blocks)  # reciprocity
    turned = [w @ [[0.6, 0.8, 0], [-0.8, 0.6, 0], [0, 0, 1]] for w in (wi, wo)]
    mirrored = [w * [1, -1, 1] for w in (wi, wo)]
    for pair in (turned, mirrored):
        same = (number_blocks(*pair, anisotropic) == blocks).all()
        assert same == (not anisotropic)
    for block in range(0, blocks.max() + 1, 7):
        assert np.ptp(theta_d[blocks == block]) <= np.radians(15)
        assert np.ptp(theta_h[blocks == block]) <= np.radians(22)


def test_each_fold_sees_the_highlight_and_grazing_angles():
    table = bk.load("red_plastic")
    samples = select_samples(table, 80.0)
    held_out = HeldOut.draw(samples, bk.losses["log"], False, 5, np.random.default_rng(3))
    assert len(held_out.folds) == len(held_out.samples.wi) <= PART
    theta_h, theta_d, _ = to_half_difference(held_out.samples.wi, held_out.samples.wo)
    for fold in range(5):
        own = held_out.folds == fold
        assert 0.1 < held_out.importance[own].sum() / held_out.importance.sum() < 0.3
        assert (theta_h[own] < np.radians(6)).any()
        assert (theta_d[own] > np.radians(70)).any()
        # Blocks are in one fold
        assert not set(held_out.blocks[own]) & set(held_out.blocks[~own])


def test_a_ranking_is_decided_by_its_seed():
    data = measured(bk.models()["ward"](), n=400)
    first, again, other = (bk.rank(data, ["ward", "ggx"], seed=s) for s in (1, 1, 2))
    assert first == again
    assert first != other


class Undefined(Model):
    diffuse_reflectance = weight(0.5, "k_d")

    def lobes(self):
        return (Lobe(lambda wi, wo: dr.log(wi.z - 0.5), Cosine(), diffuse=True),)


def test_a_model_that_cannot_be_fitted_does_not_stop_the_others(no_user_plugins):
    data = measured(bk.models()["lambert"](), n=200)
    found = bk.rank(data, [Undefined, "lambert"])
    assert [row.model for row in found.rows] == ["lambert", "undefined"]
    assert found.best == "lambert"
    (problem,) = found.problems
    assert problem.startswith("undefined: the lobe of diffuse_reflectance is ")
    assert problem in str(found)
    with pytest.raises(BrdfkitError, match="undefined: the lobe"):
        bk.rank(data, Undefined)


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"models": "wrad"}, "There is no model 'wrad'; did you mean ward"),
        ({"models": []}, "There is no model to rank; name at least one."),
        ({"folds": 1}, "folds = 1 should be a whole number, at least 2."),
        ({"folds": 500}, "the samples lie in .* blocks of directions; give fewer"),
        ({"loss": "lgo"}, "There is no loss 'lgo'; did you mean log"),
    ],
)
def test_wrong_arguments_are_refused(wrong, said):
    data = measured(bk.models()["lambert"](), n=200)
    with pytest.raises(BrdfkitError, match=said):
        bk.rank(data, **wrong)


def test_by_default_all_models_and_some_sums_are_ranked():
    ranked = ranking.candidates()
    assert set(bk.models()) - {"mixture"} <= set(ranked)
    assert all(labels.is_label(label) for label in ranked)


# On the command line


@pytest.fixture
def cli(tmp_path, monkeypatch):
    """Runs the command line where two.npz is a file, with two candidates."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(ranking, "candidates", lambda: ["ggx", "lambert"])
    bk.save(measured(bk.models()["ggx"](), n=300), "paint.npz")
    return lambda *words: CliRunner().invoke(main, words)


def test_best_fits_the_recommended_model_and_says_why(cli):
    found = cli("fit", "paint.npz", "-m", "best")
    assert found.exit_code == 0, found.stderr
    table, _, fit = found.stdout.partition("ggx is recommended: its error is the least")
    assert "synthetic: errors (log) at directions that were held out" in table
    assert "ggx fitted to synthetic" in fit
    assert "lambert fitted" not in fit
    record = json.loads(cli("fit", "paint.npz", "-m", "best", "-m", "ward", "--json").stdout)
    assert {fit["model"] for fit in record["fits"]} == {"ggx", "ward"}
    assert record["ranking"]["best"] == "ggx"
    assert [row["tied"] for row in record["ranking"]["models"]] == [True, False]


def test_best_takes_one_file(cli):
    found = cli("fit", "paint.npz", "other.npz", "-m", "best")
    assert found.exit_code == 2
    said = "-m best ranks models on one material; name one FILE, or a model."
    assert found.stderr == f"brdfkit: {said}\n"


def test_ctrl_c_ends_with_the_models_that_are_ranked(cli, monkeypatch):
    validate = ranking.cross_validate

    def interrupted(model, *others):
        if model.type_name() == "lambert":
            raise KeyboardInterrupt
        return validate(model, *others)

    monkeypatch.setattr(ranking, "cross_validate", interrupted)
    found = cli("fit", "paint.npz", "-m", "best")
    assert found.exit_code == 130
    assert found.stderr == "brdfkit: interrupted; 1 of 2 models are ranked.\n"
    assert "ggx is recommended" in found.stdout


# The note on azimuths


@pytest.mark.parametrize("model", ["cook_torrance", "ggx"])
def test_an_isotropic_fit_of_an_anisotropic_table_is_told_what_it_cannot_reach(model):
    """Of a table that is isotropic but for a factor, whose logarithm has a known spread."""
    truth = bk.models()["cook_torrance"](alpha=0.3)
    table = bk.load("brushed_aluminium").table
    factor = np.exp(0.3 * np.cos(2 * table.centres[0]))[:, None]
    wi, wo = (w.reshape(-1, 3) for w in table.directions())
    values = truth.eval(wi, wo).reshape(len(factor), -1) * factor
    data = bk.Measured.from_table(values.reshape(*table.shape, 1), channels=("Y",))
    fit = bk.fit(model, data, "log", anisotropic=False)
    (note,) = (note for note in fit.notes if "turns" in note)
    told = float(note.rpartition(" ")[2])
    assert told == pytest.approx(0.3 / np.sqrt(2), rel=0.05)
    assert told < 1.01 * fit.loss


def test_an_anisotropic_fit_has_no_such_note():
    ward = bk.models()["ward"](alpha_u=0.1, alpha_v=0.3)
    data = measured(ward, n=300, anisotropic=True)
    notes = {model: " ".join(bk.fit(model, data).notes) for model in ("ward", "lambert")}
    assert "turns" not in notes["ward"]
    assert "the material changes as the surface turns, and the model as fitted" in notes["lambert"]


def test_errors_that_differ_by_rounding_are_tied():
    shares, squares = np.full(4, 0.25), np.array([1.0, 2.0, 3.0, 4.0])
    assert is_tied(*beside(squares * (1 + 1e-15), squares, shares))
    assert not is_tied(*beside(squares * 1.001, squares, squares))  # by the same share everywhere
    # one block tells nothing of noise
    assert is_tied(*beside(squares[:1], squares[:1], shares[:1]))
    assert not is_tied(*beside(squares[1:2], squares[:1], shares[:1]))
