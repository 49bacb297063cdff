"""Losses of one's own, weights of samples and standard errors: what a fit makes small."""

import drjit as dr
import numpy as np
import pytest
from click.testing import CliRunner

import brdfkit as bk
from brdfkit.checks.material_subject import draw_direction_pairs
from brdfkit.cli import main
from brdfkit.core.errors import BrdfkitError
from brdfkit.materials.measured.selection import select_samples
from brdfkit.model.samples import Table

N = 400


def measured(model, seed=0, noise=0.0, **details):
    """A model measured at random directions, with noise of the standard error `noise` (n, 3)."""
    wi, wo = draw_direction_pairs(N, seed=seed, max_degrees=79)
    noise = np.broadcast_to(noise, (N, 3))
    values = model.eval(wi, wo) + np.random.default_rng(seed).normal(size=(N, 3)) * noise
    return bk.Measured.from_samples(wi, wo, values, **details)


def assert_same(found, other, rtol=1e-10):
    for name, value in other.values.items():
        np.testing.assert_allclose(found.values[name], value, rtol=rtol, err_msg=name)


@pytest.mark.quick
def test_a_loss_tells_itself_whether_it_is_linear():
    """Not by a flag: by its values, over eight decades of the model's and the measured one."""
    linear = {name for name, loss in bk.losses.named.items() if loss.linear}
    assert linear == {"cosine", "plain", "lafortune", "kurt"}

    def bent(model, measured, cos_i, cos_o):
        return dr.minimum(model, 100.0) - dr.minimum(measured, 100.0)

    assert not bk.losses.Loss("bent", "linear up to 100", bent).linear


def test_a_loss_of_ones_own_is_as_good():
    """Written by the user, the log loss gives the same fit, and is named after its function."""

    def own_log(model, measured, cos_i, cos_o):
        """Mine."""
        kappa = cos_i * cos_o
        return dr.log(kappa * model + 1e-3) - dr.log(kappa * dr.maximum(measured, 0) + 1e-3)

    data = measured(bk.models()["ward"](alpha_u=0.3), noise=0.01)
    mine = bk.losses.Loss("own_log", "Mine", own_log, measure="angles")
    found, known = bk.fit(data, "ggx", loss=mine), bk.fit(data, "ggx", loss="log")
    assert bk.fit(data, "ggx", loss=own_log).loss_name == "own_log"
    assert found.loss == pytest.approx(known.loss, rel=1e-12)
    assert_same(found, known)
    both = bk.losses.Loss("both", "with weights", own_log, weights=lambda cos_i: cos_i)
    assert bk.fit(data, "ggx", loss=both).loss != pytest.approx(known.loss, rel=1e-3)


@pytest.mark.quick
@pytest.mark.parametrize(
    ("loss", "words"),
    [
        ("lgo", "There is no loss 'lgo'; did you mean log"),
        (7, "There is no loss 7"),
        (lambda model, measured: model - measured, "loss lambda fails with TypeError.*cos_i, cos"),
        (lambda m, r, ci, co: np.log(m), "fails with TypeError.*NumPy array"),
        (lambda m, r, ci, co: dr.sum(m - r), "returns 1 numbers for 4 samples"),
        (lambda m, r, ci, co: r * ci, "does not change with the model's value"),
        (lambda m, r, ci, co: dr.detach(m) - r, "or has no derivative by it"),
        (
            bk.losses.Loss("log", "taken", lambda m, r, ci, co: m - r),
            "a text as name that is not in brdfkit.losses.named",
        ),
        (
            bk.losses.Loss("few", "", lambda m, r, ci, co: m - r, weights=lambda c: c[:2]),
            "weights of the loss few",
        ),
        (bk.losses.Loss("low", "", lambda m, r, ci, co: m - r, weights=lambda c: -c), "at least 0"),
        (lambda m, r, ci, co: dr.log(m) - dr.log(r + 1), "is -inf at theta_i.*the model's 0; keep"),
        (lambda m, r, ci, co: dr.log(m + 1) - dr.log(r), "is inf at theta_i.*measured value is 0"),
        (lambda m, r, ci, co: dr.sqrt(m) - dr.sqrt(r), "the derivative inf at theta_i"),
    ],
)
def test_a_bad_loss_is_refused(loss, words):
    with np.errstate(all="ignore"), pytest.raises(BrdfkitError, match=words):
        bk.fit(
            measured(bk.models()["lambert"](diffuse_reflectance=0.0)), "ward", loss=loss, starts=2
        )


@pytest.mark.quick
def test_weights_count_samples():
    """A weight of 0 leaves a sample out; where each sample is one, a weight of 2 is it twice."""
    data = measured(bk.models()["ggx"](), noise=0.02)
    weights = np.random.default_rng(5).integers(0, 3, N)
    rows = np.repeat(np.arange(N), weights)
    wi, wo, values = data.samples.wi[rows], data.samples.wo[rows], data.values[rows]
    repeated = bk.fit(bk.Measured.from_samples(wi, wo, values), "ggx", loss="kurt")
    found = bk.fit(data, "ggx", loss="kurt", weights=weights)
    assert found.loss == pytest.approx(repeated.loss, rel=1e-10)
    assert_same(found, repeated, rtol=1e-6)
    assert found.samples == np.count_nonzero(weights)


@pytest.mark.quick
def test_a_sample_that_is_there_twice_counts_once():
    """What it stands for is shared, so that a file's repeats do not pull a fit: where half of the
    samples are there ten times, they still are about half of the measure."""
    data = measured(bk.models()["ggx"](), noise=0.02)
    rows = np.concatenate([np.arange(N), np.repeat(np.arange(N // 2), 9)])
    wi, wo, values = data.samples.wi[rows], data.samples.wo[rows], data.values[rows]
    repeated = select_samples(bk.Measured.from_samples(wi, wo, values), 80.0)
    once = select_samples(data, 80.0)
    for loss in bk.losses.named.by_sample.values():
        if loss.measure != "samples":
            first = loss.importance(repeated)[rows < N // 2].sum()
            expected = loss.importance(once)[: N // 2].sum()
            assert first / loss.importance(repeated).sum() == pytest.approx(
                expected / loss.importance(once).sum(), rel=0.05
            )


def test_weights_of_cells_have_the_tables_shape():
    """Of a table, too, they are its cells', in its shape or flat."""
    table = Table(np.random.default_rng(0).uniform(0.1, 1, (8, 6, 10, 3)))
    data, weights = bk.Measured.from_table(table.values), np.ones(table.shape)
    weights[3:] = 0
    left = bk.Measured.from_table(np.where(weights[..., None] > 0, table.values, np.nan))
    expected = bk.fit(left, "ward")
    for given in (weights, weights.ravel()):
        assert_same(bk.fit(data, "ward", weights=given), expected)
    with pytest.raises(BrdfkitError, match=r"weights \(8, 6\) should be \(480,\) or \(8, 6, 10\)"):
        bk.fit(data, "ward", weights=weights[..., 0])
    with pytest.raises(BrdfkitError, match="finite numbers of at least 0"):
        bk.fit(data, "ward", weights=-weights)


def test_standard_errors_bring_the_fit_nearer():
    """Half of the samples are 20 times as noisy: weights of 1 / σ² would lower the mean squared
    error to mean(σ²) mean(1 / σ²) = 100 times less; over a few noises it is 30 times less."""
    truth = bk.models()["ward"](diffuse_reflectance=0.3, specular_reflectance=0.1, alpha_u=0.3)
    noise = np.where(np.arange(N) % 2, 0.002, 0.04)[:, None]
    squares = {True: 0.0, False: 0.0}
    for seed in range(12):
        data = measured(truth, seed, noise, standard_error=np.broadcast_to(noise, (N, 3)))
        for use in squares:
            found = bk.fit(data, "ward", loss="plain", starts=1, use_standard_error=use)
            squares[use] += (found.values["alpha_u"] - 0.3) ** 2
            assert any("standard errors" in note for note in found.notes) == use
    assert squares[True] < squares[False] / 30


@pytest.mark.parametrize("size", [0.0, 1e-6, 0.3])
def test_standard_errors_that_say_nothing_change_nothing(size):
    """Equal ones in the loss's differences, and such as are small beside the model's own error."""
    data = measured(bk.models()["ggx"](), noise=0.05, standard_error=np.full((N, 3), size))
    found, other = (
        bk.fit(data, "ward", loss="plain", use_standard_error=use) for use in (True, False)
    )
    assert found.values == other.values
    assert found.loss == other.loss


@pytest.mark.quick
@pytest.mark.parametrize("bad", [-0.1, np.nan, np.inf])
def test_bad_standard_errors_are_refused(bad):
    with pytest.raises(BrdfkitError, match=r"a standard error is .*; it should be a finite"):
        measured(bk.models()["ward"](), standard_error=np.full((N, 3), bad))


def stopping(after, name="stopped"):
    """The log loss; its call number `after` is hit by Ctrl-C."""
    log, calls = bk.losses.named["log"], []

    def difference(*arrays):
        calls.append(1)
        if len(calls) == after:
            raise KeyboardInterrupt
        return log.difference(*arrays)

    return bk.losses.Loss(name, log.meaning, difference, log.measure)


@pytest.mark.parametrize(("robust", "after"), [(None, 60), ("bisquare", 300)])
def test_ctrl_c_keeps_the_best_fit_so_far(robust, after):
    """In an exception, by which loops end; its loss is that of its model."""
    data = measured(bk.models()["ward"](alpha_u=0.3), noise=0.01)
    with pytest.raises(bk.Interrupted, match="the best fit so far has the loss") as stop:
        bk.fit(data, "ggx", loss=stopping(after), robust=robust)
    best = stop.value.best
    assert isinstance(stop.value, KeyboardInterrupt)
    assert best.message == "interrupted: the best so far"
    assert best.loss == pytest.approx(bk.compare(data, best).errors["ggx"]["log"], rel=1e-9)
    assert best.loss < bk.compare(data, bk.models()["ggx"]()).errors["ggx"]["log"]


@pytest.mark.quick
def test_ctrl_c_on_the_command_line_prints_it(tmp_path, monkeypatch):
    """After the finished fits, which alone are saved; the status is that of Ctrl-C."""
    bk.save(measured(bk.models()["ward"](alpha_u=0.3), noise=0.01), tmp_path / "ward.npz")
    monkeypatch.chdir(tmp_path)
    lambert = CliRunner().invoke(main, ["fit", "ward.npz", "-m", "lambert"])
    assert lambert.exit_code == 0
    monkeypatch.setitem(bk.losses.named, "cbrt", stopping(120, "cbrt"))
    found = CliRunner().invoke(
        main, ["fit", "ward.npz", "-m", "lambert", "-m", "ggx", "-m", "ward", "-o", "fits"]
    )
    assert found.exit_code == 130
    assert "interrupted; 1 of 3 fits are finished, the last one is not" in found.stderr
    assert "interrupted: the best so far" in found.stdout
    assert [file.name for file in (tmp_path / "fits").iterdir()] == ["lambert.json"]
