"""Rankings: the true model is found, ties are said, no fit sees what it is held to, and the model
that looks worst is not taken."""

import json
from dataclasses import replace
from types import SimpleNamespace

import drjit as dr
import numpy as np
import pytest
from click.testing import CliRunner
from sample_sums import sample_sum

import brdfkit as bk
from brdfkit.checks.material_subject import draw_direction_pairs
from brdfkit.cli import main
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.geometry.directions import to_half_difference
from brdfkit.fitting.ranking import Ranked, Ranking, ranking
from brdfkit.fitting.ranking.appearance import Appearance
from brdfkit.fitting.ranking.cross_validation import Validated
from brdfkit.fitting.ranking.held_out import SAMPLE_LIMIT, HeldOut, assign_blocks, assign_regions
from brdfkit.fitting.ranking.ranked import rank_results
from brdfkit.fitting.ranking.ties import compare_with_best, compute_paired_standard_error, is_tied
from brdfkit.images.ball import draw_pixels
from brdfkit.materials.measured.selection import select_samples
from brdfkit.model import Model, labels, weight
from brdfkit.model.lobes import Cosine, Lobe

TRUTHS = {
    "ward": {"alpha_u": 0.15, "diffuse_reflectance": 0.1},
    "cook_torrance": {"alpha": 0.3, "f0": 0.1, "diffuse_reflectance": 0.2},
    "oren_nayar": {"sigma": 0.5},
}
NOISE = 0.05
UNBEATEN = "that no other beats in both error and picture"
TIED = "that are tied in error and whose pictures are within 0.5 dB of the best"


def measured(truth, n=1500, **how):
    """A material of one channel, with noise."""
    wi, wo = draw_direction_pairs(n, seed=1, max_degrees=75)
    noise = np.random.default_rng(0).normal(0, NOISE, (n, 1))
    values = truth.eval(wi, wo)[:, :1] * np.exp(noise)
    return bk.Measured.from_samples(wi, wo, values, channels=("Y",), name="synthetic", **how)


@pytest.mark.parametrize("name", TRUTHS)
def test_the_true_model_is_recommended(name):
    """And its held-out error is the noise."""
    found = bk.rank(measured(bk.models()[name](**TRUTHS[name])), TRUTHS, loss="log")
    assert found.best == name
    assert [row.model for row in found.rows if row.tied] == [name]
    assert found.rows[0].error == pytest.approx(NOISE, rel=0.1)
    assert found.reason.startswith(f"{name} is recommended: no other model has a lesser error or a")
    assert f"{name}: Suits " in str(found)


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
    assert (
        found.why == f"among the 3 models {UNBEATEN} it has the fewest parameters of the 3 {TIED}"
    )
    assert "student_t, with 1 more parameter, an error" in found.reason
    # The noise says that more parameters are too many, as the criterion does
    assert rows["ggx"].bic < min(rows["ggx+ggx"].bic, rows["student_t"].bic)


def test_held_out_errors_are_those_of_fits_without_the_fold():
    """Of a constant, whose fit is a mean: by hand."""
    data, rng = measured(bk.models()["ward"](), n=300), np.random.default_rng(0)
    samples = select_samples(data, 80.0)
    plain_sum = sample_sum("plain")
    held_out = HeldOut.divide(samples, plain_sum, False, 5, rng)
    values, squares = samples.values[:, 0], np.empty(len(samples.wi))
    for fold in range(5):
        out = held_out.folds == fold
        squares[out] = (values[out] - values[~out].mean()) ** 2
    (row,) = bk.rank(data, "lambert", loss=plain_sum).rows
    assert row.error == pytest.approx(np.sqrt(squares.mean()), rel=1e-9)
    assert (row.behind, row.uncertainty, row.tied) == (0.0, 0.0, True)


def test_the_uncertainty_is_that_of_the_paired_difference():
    """Where errors differ by as much in each block, it is 0, however these differ."""
    shares = np.full(50, 1 / 50)
    errors = np.random.default_rng(0).random(50) * shares
    assert compute_paired_standard_error(0.1 * shares, shares) == pytest.approx(0, abs=1e-12)
    others = np.roll(errors, 7)
    spread = np.std(others - errors, ddof=1) * np.sqrt(50)
    assert compute_paired_standard_error(others - errors, shares) == pytest.approx(spread)


@pytest.mark.parametrize("anisotropic", [False, True])
def test_blocks_cover_all_directions_and_folds_share_them(anisotropic):
    wi, wo = draw_direction_pairs(40_000, seed=0, max_degrees=80)
    blocks = assign_blocks(wi, wo, anisotropic)
    theta_h, theta_d, _ = to_half_difference(wi, wo)
    assert set(blocks) == set(range(blocks.max() + 1))
    np.testing.assert_array_equal(assign_blocks(wo, wi, anisotropic), blocks)  # reciprocity
    turned = [w @ [[0.6, 0.8, 0], [-0.8, 0.6, 0], [0, 0, 1]] for w in (wi, wo)]
    mirrored = [w * [1, -1, 1] for w in (wi, wo)]
    for pair in (turned, mirrored):
        same = (assign_blocks(*pair, anisotropic) == blocks).all()
        assert same == (not anisotropic)
    for block in range(0, blocks.max() + 1, 7):
        assert np.ptp(theta_d[blocks == block]) <= np.radians(15)
        assert np.ptp(theta_h[blocks == block]) <= np.radians(22)


def test_each_fold_sees_the_highlight_and_grazing_angles():
    table = bk.load("red_plastic")
    samples = select_samples(table, 80.0)
    held_out = HeldOut.divide(samples, bk.losses.named["log"], False, 5, np.random.default_rng(3))
    assert len(held_out.folds) == len(held_out.samples.wi) <= SAMPLE_LIMIT
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
    ranked = ranking.list_default_models()
    assert set(bk.models()) - {"mixture"} <= set(ranked)
    assert all(labels.is_label(label) for label in ranked)


# By pictures


@pytest.fixture(scope="module")
def red():
    """A red material with a highlight of one colour, and its `Appearance`."""
    truth = bk.models()["ggx"](alpha_u=0.2, diffuse_reflectance=(0.4, 0.05, 0.05))
    wi, wo = draw_direction_pairs(50, seed=1, max_degrees=75)
    samples = bk.Measured.from_samples(wi, wo, truth.eval(wi, wo)).samples
    return truth, Appearance(SimpleNamespace(rgb=truth, anisotropic=False), samples, 80.0, 1)


def test_the_picture_error_is_the_rms_over_the_peak_of_what_a_screen_shows(red):
    truth, appearance = red
    assert appearance.compute_picture_error(truth.eval) < 1e-9
    pixels, total, every = appearance.pixels, 0.0, []
    values = truth.eval(pixels.wi, pixels.wo)
    for number, share in enumerate(pixels.weights):
        own = slice(number * pixels.pairs, (number + 1) * pixels.pairs)
        x = np.clip((pixels.shares[own, None] * values[own]).sum(axis=0), 0, 1)
        srgb = np.where(x < 0.0031308, 12.92 * x, 1.055 * x ** (1 / 2.4) - 0.055)
        total += share * (srgb**2).mean()
        every.append(srgb)
    black = appearance.compute_picture_error(lambda wi, wo: 0 * truth.eval(wi, wo))
    rms = np.sqrt(total / pixels.weights.sum())
    assert black == pytest.approx(rms / np.percentile(every, 99.9), rel=1e-9)


@pytest.mark.parametrize(
    ("rim", "said"),
    [
        ((0.0, 0.0, 0.0), ""),
        ((0.2, 0.2, 0.2), ""),  # what Fresnel's equations do
        ((0.2, 0.04, 0.04), ""),  # the material's own colour
        ((0.0, 0.1, 0.2), "the colour at 85° is not the material's"),
        ((0.9, 0.9, 0.9), "more light is reflected at 85° than arrives"),
    ],
)
def test_a_rim_of_another_colour_is_doubtful(red, rim, said):
    truth, appearance = red

    def brdf(wi, wo):
        grazing = np.maximum(1 - wi[:, 2:], 1 - wo[:, 2:]) ** 12
        return truth.eval(wi, wo) + grazing * np.array(rim)

    assert appearance.find_implausibility(brdf) == said


def row(model, error, psnr, parameters, **how):
    """A row of a ranking whose best error is 0.1, of the Pareto set."""
    how = {"behind": error - 0.1, "uncertainty": 0.01, "pareto": True} | how
    return Ranked(model, error, picture=10 ** (-psnr / 20), parameters=parameters, **how)


def choose(*rows):
    """What is recommended of these rows, and why."""
    ranking = Ranking("paint", "log", rows, len(rows))
    return ranking.best, ranking.why


def test_the_worst_picture_is_not_taken_for_its_few_parameters():
    rows = row("abc", 0.1, 40.0, 12), row("ggx", 0.11, 39.7, 9), row("ward", 0.115, 32.0, 7)
    assert all(one.tied for one in rows)
    best, why = choose(*rows)
    assert best == "ggx"
    assert why == f"among the 3 models {UNBEATEN} it has the fewest parameters of the 2 {TIED}"


def test_a_better_picture_is_taken_before_a_lesser_error():
    best, why = choose(row("abc", 0.1, 30.0, 12), row("ggx", 0.2, 33.0, 9))
    assert best == "ggx"
    assert why.endswith("it has the best picture, by more than 0.5 dB")
    best, why = choose(row("abc", 0.2, 30.0, 12), row("ggx", 0.3, 30.4, 9))
    assert best == "abc"
    assert why.endswith(
        "it has the least error of the 2 whose pictures are within 0.5 dB of the best"
    )


def test_pictures_that_eight_bits_do_not_tell_apart_are_as_good():
    assert choose(row("ggx+ggx", 0.1, 90.0, 12), row("ggx", 0.1, 70.0, 9))[0] == "ggx"


def test_doubtful_models_stand_back():
    doubt = "the colour at 85° is not the material's"
    rows = row("abc", 0.1, 40.0, 12, doubt=doubt), row("ggx", 0.2, 33.0, 9)
    best, why = choose(*rows)
    assert best == "ggx"
    assert why.endswith("it alone is without a doubt")
    said = str(Ranking("paint", "log", rows, 2))
    assert f"Doubtful: {doubt}, of abc." in said
    assert "tied, Pareto, doubtful" in said
    beaten = row("ward", 0.11, 38.0, 7, pareto=False)
    assert choose(*rows, beaten)[0] == "ggx"
    best, why = choose(rows[0], beaten)
    assert best == "ward"
    assert why == "it is tied in error, and all models that no other beats are doubtful"
    alone = Ranking("paint", "log", (rows[0],), 1)
    assert alone.reason.startswith(f"abc is recommended, though {doubt}: no other model")


def test_a_model_is_beaten_only_in_both_error_and_picture():
    """And in the error by more than noise, that of the two models' blocks."""
    shares, noise = np.full(40, 1 / 40), np.random.default_rng(0).normal(1, 0.1, 40)
    found = {
        name: Validated(error * shares * noise**power, None, picture, "", 7, 0.0, 0.0)
        for name, error, power, picture in [
            ("best", 1.0, 1, 0.02),
            ("tied", 1.01, -1, 0.05),
            ("beaten", 2.0, 1, 0.03),
            ("pretty", 3.0, 1, 0.01),
        ]
    }
    rows = {one.model: one for one in rank_results(found, shares)}
    assert rows["tied"].tied
    assert [name for name, one in rows.items() if one.pareto] == ["best", "tied", "pretty"]
    assert rows["pretty"].psnr == pytest.approx(40)


@pytest.fixture(scope="module")
def pixels_held_out():
    """What is held out of fits by the picture loss, of a material without noise."""
    data = bk.load("red_plastic")
    samples, loss = select_samples(data, 80.0), bk.losses.Picture(("hall", "sky"))
    pixels = draw_pixels(loss.lights, data.eval, 80.0, 0, directions=8)
    return HeldOut.divide(samples, loss, False, 5, np.random.default_rng(0), pixels)


def test_a_region_of_the_ball_is_held_out_under_all_lights(pixels_held_out):
    pixels = pixels_held_out.pixels
    regions = assign_regions(pixels)
    folds = pixels_held_out.folds[-len(regions) :]
    wo = pixels.wo.reshape(-1, pixels.pairs, 3)
    wo = wo[np.arange(len(wo)), wo[..., 2].argmin(axis=1)]
    for region in range(regions.max() + 1):
        own = regions == region
        assert len(set(folds[own])) == 1
        assert np.ptp(np.hypot(wo[own, 0], wo[own, 1])) <= 0.5  # of the disc's radius
        assert own.sum() < 10 or set(np.flatnonzero(own) % 2) == {0, 1}
    for fold in range(5):
        share = pixels.weights[folds == fold].sum() / pixels.weights.sum()
        assert 0.1 < share < 0.3


def test_a_fit_does_not_see_the_pixels_that_it_is_held_to(pixels_held_out):
    """And the errors of all are those that the fit minimises."""
    out, model = pixels_held_out.folds == 2, bk.models()["ward"]
    whole = pixels_held_out.regress(model, pixels_held_out.folds >= 0, starts=2)
    squares = pixels_held_out.compute_squared_differences(model, whole, pixels_held_out.folds >= 0)
    assert pixels_held_out.importance @ squares == pytest.approx(whole.loss**2, rel=1e-6)

    one = pixels_held_out.regress(model, ~out, starts=2)
    of_samples, of_pixels = np.split(out, [len(pixels_held_out.samples.wi)])
    samples, pixels = pixels_held_out.samples, pixels_held_out.pixels
    spoilt = HeldOut(
        replace(samples, values=np.where(of_samples[:, None], 7.0, samples.values)),
        replace(pixels, values=np.where(of_pixels[:, None], 7.0, pixels.values)),
        *(getattr(pixels_held_out, name) for name in ("loss", "importance", "blocks", "folds")),
    )
    again = spoilt.regress(model, ~out, starts=2)
    assert one.shapes == again.shapes
    np.testing.assert_array_equal(one.weights, again.weights)
    held_to = [
        these.compute_squared_differences(model, one, out).mean()
        for these in (pixels_held_out, spoilt)
    ]
    assert held_to[1] > 10 * held_to[0]


# On the command line


@pytest.fixture
def cli(tmp_path, monkeypatch):
    """Runs the command line where two.npz is a file, with two candidates."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(ranking, "list_default_models", lambda: ["ggx", "lambert"])
    bk.save(measured(bk.models()["ggx"](), n=300), "paint.npz")
    return lambda *words: CliRunner().invoke(main, words)


def test_best_fits_the_recommended_model_and_says_why(cli):
    found = cli("fit", "paint.npz", "-m", "best")
    assert found.exit_code == 0, found.stderr
    table, _, fit = found.stdout.partition("ggx is recommended: no other model has a lesser error")
    assert "synthetic: errors (cbrt) at directions that were held out" in table
    assert "ggx fitted to synthetic" in fit
    assert "lambert fitted" not in fit
    record = json.loads(cli("fit", "paint.npz", "-m", "best", "-m", "ward", "--json").stdout)
    assert {fit["model"] for fit in record["fits"]} == {"ggx", "ward"}
    assert record["ranking"]["best"] == "ggx"
    assert [row["tied"] for row in record["ranking"]["models"]] == [True, False]
    assert [row["pareto"] for row in record["ranking"]["models"]] == [True, False]
    assert record["ranking"]["models"][0]["psnr"] > 30


def test_best_ranks_by_the_picture_loss(cli):
    shape = 30, 12, 18, 1
    wi, wo = bk.Measured.from_table(np.ones(shape), channels=("Y",)).table.directions()
    values = bk.models()["ggx"]().eval(wi.reshape(-1, 3), wo.reshape(-1, 3))[:, :1]
    bk.save(bk.Measured.from_table(values.reshape(shape), channels=("Y",)), "table.npz")
    words = "fit", "table.npz", "-m", "best", "--loss", "picture"
    done = cli(*words, "-m", "lambert", "--json")
    assert done.exit_code == 0, done.stderr
    record = json.loads(done.stdout)
    assert record["ranking"]["best"] == "ggx"
    assert {(fit["model"], fit["loss"]) for fit in record["fits"]} == {
        ("ggx", "picture"),
        ("lambert", "picture"),
    }
    refused = cli(*words, "--robust", "huber")
    assert refused.exit_code == 2
    assert refused.stderr.startswith("brdfkit: robust looks at samples one by one")


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
    fit = bk.fit(data, model, loss="log", anisotropic=False)
    (note,) = (note for note in fit.notes if "turns" in note)
    told = float(note.rpartition(" ")[2])
    assert told == pytest.approx(0.3 / np.sqrt(2), rel=0.05)
    assert told < 1.01 * fit.loss


def test_an_anisotropic_fit_has_no_such_note():
    ward = bk.models()["ward"](alpha_u=0.1, alpha_v=0.3)
    data = measured(ward, n=300, anisotropic=True)
    notes = {model: " ".join(bk.fit(data, model).notes) for model in ("ward", "lambert")}
    assert "turns" not in notes["ward"]
    assert "the material changes as the surface turns, and the model as fitted" in notes["lambert"]


def test_errors_that_differ_by_rounding_are_tied():
    shares, squares = np.full(4, 0.25), np.array([1.0, 2.0, 3.0, 4.0])
    assert is_tied(*compare_with_best(squares * (1 + 1e-15), squares, shares))
    assert not is_tied(
        *compare_with_best(squares * 1.001, squares, squares)
    )  # by the same share everywhere
    # one block tells nothing of noise
    assert is_tied(*compare_with_best(squares[:1], squares[:1], shares[:1]))
    assert not is_tied(*compare_with_best(squares[1:2], squares[:1], shares[:1]))
