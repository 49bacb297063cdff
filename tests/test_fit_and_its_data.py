"""A fit knows its data again: checksums, versions, and what it left of them."""

import json
import pickle
from dataclasses import fields, replace

import numpy as np
import pytest
from test_fit import synthetic

import brdfkit as bk

pytestmark = pytest.mark.quick


def test_a_fit_remembers_its_data_and_what_made_it(tmp_path):
    data = bk.load("blasted_gold")
    fit = bk.fit("lambert", data)
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


def test_a_fit_of_other_versions_is_read(tmp_path):
    file = tmp_path / "fit.json"
    fit = bk.fit("lambert", synthetic(bk.models()["lambert"](), n=50))
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
