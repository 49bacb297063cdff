"""A fit knows its data again: checksums, versions, and what it left of them."""

import json
import pickle
from dataclasses import fields, replace

import numpy as np
import pytest
from measured_models import synthetic
from sample_sums import sample_sum

import brdfkit as bk
from brdfkit.core.errors import BrdfkitError
from brdfkit.materials.measured.selection import select_samples


@pytest.mark.quick
def test_a_fit_remembers_its_data_and_what_made_it(tmp_path):
    data = bk.load("blasted_gold")
    fit = bk.fit(data, "lambert")
    assert fit.checksum == data.checksum
    assert len(bytes.fromhex(fit.checksum)) == 32
    assert fit.versions["brdfkit"] == bk.__version__
    assert fit.versions["numpy"] == np.__version__
    assert sorted(fit.versions) == ["brdfkit", "drjit", "mitsuba", "numpy", "scipy"]
    bk.save(fit, tmp_path / "fit.json")
    for again in (bk.load(tmp_path / "fit.json"), pickle.loads(pickle.dumps(fit))):
        assert again == fit
        assert again.versions == fit.versions
        assert not [f.name for f in fields(fit) if getattr(fit, f.name) != getattr(again, f.name)]


@pytest.mark.quick
def test_a_fit_of_other_versions_is_read(tmp_path):
    file = tmp_path / "fit.json"
    fit = bk.fit(synthetic(bk.models()["lambert"](), n=50), "lambert")
    bk.save(replace(fit, versions={"brdfkit": "0.0.1", "mitsuba": "3.5.0"}), file)
    other = bk.load(file)
    assert other == fit
    assert other.versions["mitsuba"] == "3.5.0"
    record = json.loads(file.read_text())
    del record["fit"]["checksum"], record["fit"]["versions"]
    file.write_text(json.dumps(record))
    older = bk.load(file)
    assert (older.checksum, older.versions) == ("", {})
    assert older.values == fit.values


def test_the_checksum_is_of_what_was_measured(tmp_path):
    """The same in any file that loses nothing; another one for another value, direction or mask."""
    data = synthetic(bk.models()["ward"](diffuse_reflectance=(0.1, 0.2, 0.3)), n=50)
    bk.save(data, tmp_path / "other name.npz")
    assert bk.load(tmp_path / "other name.npz").checksum == data.checksum
    table = bk.load("red_plastic")
    bk.save(table, tmp_path / "table.npz.xz")
    assert bk.load(tmp_path / "table.npz.xz").checksum == table.checksum

    def changed(name="", **more):
        arrays = {n: np.array(getattr(data.samples, n)) for n in ("wi", "wo", "values", "valid")}
        if name == "valid":
            arrays[name][7] = False
        elif name:
            arrays[name][7] = arrays[name][8]
        return bk.Measured.from_samples(**arrays, **more).checksum

    assert changed() == changed(anisotropic=True)
    others = [changed(name) for name in ("", "wi", "wo", "values", "valid")]
    others.append(changed(channels=("400nm", "500nm", "600nm")))
    assert len({*others, table.checksum}) == 7


def test_residuals_are_measured_less_modelled():
    """Of samples and of a table, at what was fitted; rendered and plotted as any material."""
    for data in (synthetic(bk.models()["ggx"](), n=300), bk.load("red_plastic")):
        fit = bk.fit(data, "lambert", loss="lafortune", max_angle=70)
        left = fit.residuals(data)
        assert left.is_table == data.is_table
        assert left.samples.valid.sum() == fit.samples
        rows = left.samples.valid
        wi, wo = left.samples.wi[rows], left.samples.wo[rows]
        np.testing.assert_allclose(left.values[rows] + fit.eval(wi, wo), data.values[rows])
        assert (left.values[rows] < 0).any()
        samples = select_samples(left, 70.0)
        cosines = samples.wi[:, 2:] * samples.wo[:, 2:]
        loss = bk.losses.named["lafortune"].importance(samples) @ (cosines * samples.values) ** 2
        assert loss.sum() == pytest.approx(fit.loss**2)
        bk.plot(left)
        assert bk.render(left, spp=1, size=4).pictures[f"{data.name} - lambert"].min() >= 0
    turned = left.mix_channels(-np.eye(3), ("R", "G", "B"))
    assert (left.eval(wi, wo) * turned.eval(wi, wo)).max() == 0


@pytest.mark.quick
def test_a_loss_that_standard_errors_weigh_is_told_from_that_of_compare():
    data = synthetic(bk.models()["ward"](), n=200)
    errors = np.linspace(0.01, 0.1, 200)[:, None]
    wi, wo = data.samples.wi, data.samples.wo
    noisy = bk.Measured.from_samples(wi, wo, data.samples.values, standard_error=errors)
    plain, weighed = (bk.fit(one, "lambert", loss="log") for one in (data, noisy))
    assert plain.loss == pytest.approx(bk.compare(data, plain).errors["lambert"]["log"])
    assert plain.loss_label == "log loss"
    assert weighed.loss != pytest.approx(bk.compare(noisy, weighed).errors["lambert"]["log"])
    assert weighed.loss_label == "log loss, weighed by standard errors"
    assert f"{weighed.loss_label} {weighed.loss:.6g}" in str(weighed)


@pytest.mark.quick
def test_residuals_keep_what_is_known_of_the_data():
    wi = wo = np.array([[0.0, 0.0, 1.0], [0.6, 0.0, 0.8], [0.999, 0.0, 0.04]])
    errors = np.full((3, 1), 0.01)
    data = bk.Measured.from_samples(wi, wo, [1, 2, 3], channels=("Y",), standard_error=errors)
    left = bk.fit(data, "lambert", loss=sample_sum("plain")).residuals(data)
    np.testing.assert_allclose(left.values[:, 0], [-0.5, 0.5, np.nan])
    np.testing.assert_array_equal(left.standard_error, errors)
    assert str(left) == "samples - lambert: samples, 2 of 3 valid, channels Y"


@pytest.mark.quick
def test_what_cannot_be_subtracted_is_refused():
    data = synthetic(bk.models()["lambert"](), n=20)
    fit = bk.fit(data, "lambert")
    with pytest.raises(BrdfkitError, match="lambert need the measured material, not a str; load"):
        fit.residuals("car_paint")
    with pytest.raises(BrdfkitError, match="3 channels cannot be subtracted from 1"):
        data.subtract(bk.load("car_paint"))
    with pytest.raises(BrdfkitError, match="max_angle = 100"):
        data.subtract(fit, 100)


WRONG = None, -1, "x", [], {}, [[1, 2]], [1], [None], 10**400, 1e308, True, "99.0"


def entries(record, path=()):
    """Yield the path of every entry of a record of JSON; of lists the first and last."""
    if path:
        yield path
    keys = []
    if isinstance(record, dict):
        keys = [*record]
    elif isinstance(record, list) and record:
        keys = sorted({0, len(record) - 1})
    for key in keys:
        yield from entries(record[key], (*path, key))


def test_a_damaged_saved_fit_is_refused_in_a_sentence(tmp_path):
    """Every entry in turn is of another kind; a file that is accepted works."""
    file = tmp_path / "fit.json"
    bk.save(bk.fit(synthetic(bk.models()["ggx"](), n=50), "ggx"), file)
    record = json.loads(file.read_text())
    wi = wo = np.array([[0.0, 0.6, 0.8]])
    refused = []
    for path in entries(record):
        for wrong in WRONG:
            copy = json.loads(json.dumps(record))
            inside = copy
            for key in path[:-1]:
                inside = inside[key]
            inside[path[-1]] = wrong
            file.write_text(json.dumps(copy))
            try:
                found = bk.load(file)
            except bk.BrdfkitError as error:
                refused.append(str(error))
            else:
                assert str(found)
                assert np.isfinite(found.eval(wi, wo)).all()
    assert len(refused) > 300
    assert all(sentence.startswith(f"{file}: ") for sentence in refused)


@pytest.mark.quick
def test_a_saved_fit_of_a_later_version_is_refused(tmp_path):
    file = tmp_path / "fit.json"
    bk.save(bk.fit(synthetic(bk.models()["lambert"](), n=20), "lambert"), file)
    file.write_text(file.read_text().replace(bk.__version__, "99.0", 1))
    with pytest.raises(bk.BrdfkitError, match=r"saved by brdfkit 99\.0, and this is .*: update"):
        bk.load(file)
