"""`brdfkit prior` and its function: the files of a prior, their terms, and how it serves."""

import json
import shutil

import numpy as np
import pytest
from click.testing import CliRunner

import brdfkit as bk
from brdfkit.cli import main
from brdfkit.materials.completion.prior_file import read_prior
from brdfkit.materials.completion.prior_folder import find_terms, make_folder_prior
from brdfkit.model.samples import Table

COUNT = 31


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """31 random paints as tables, three more files that do not suit, and a README."""
    place = tmp_path_factory.mktemp("paints")
    rng = np.random.default_rng(0)
    wi, wo = Table(np.zeros((20, 8, 8, 1))).directions()
    for k in range(COUNT):
        paint = bk.models()["ggx"](
            diffuse_reflectance=rng.uniform(0.02, 0.6, 3), alpha_u=rng.uniform(0.05, 0.5)
        )
        values = paint.eval(wi.reshape(-1, 3), wo.reshape(-1, 3)).reshape(20, 8, 8, 3)
        above = (wi[..., 2] > 0) & (wo[..., 2] > 0)
        values[~above] = np.nan
        bk.save(bk.Measured.from_table(values, name=f"p{k:02}"), place / f"p{k:02}.npz")
    shutil.copy(place / "p00.npz", place / "q-copy.npz")
    plan = bk.plan(8)
    few = bk.Measured.from_samples(plan.wi, plan.wo, paint.eval(plan.wi, plan.wo))
    bk.save(bk.complete(few), place / "q-full.npz")
    (place / "q-notes.txt").write_text("not a material")
    (place / "README.md").write_text("# Paints\n\nSome paints.\n\nLicence: for research\nonly.\n")
    return place


def run(*arguments):
    return CliRunner().invoke(main, [str(a) for a in arguments])


@pytest.fixture(scope="module")
def made(folder):
    return make_folder_prior(folder, with_models=False)


def test_files_are_read_or_named_with_a_reason(made):
    assert made.prior.materials == COUNT == len(made.prior.sources)
    assert all(len(line.split(" sha256 ")[1]) == 64 for line in made.prior.sources)
    assert made.skipped == {
        "q-copy.npz": "it is a copy of p00.npz",
        "q-full.npz": "it is completed, not measured",
        "q-notes.txt": "is in no known format of materials",
    }


def test_terms_and_checksums_go_into_every_result(made, folder):
    assert made.prior.terms == ("README.md: Licence: for research only.",)
    plan = bk.plan(8, prior=made.prior)
    paint = bk.load(folder / "p03.npz")
    values = paint.eval(plan.wi, plan.wo)
    completed = bk.complete(bk.Measured.from_samples(plan.wi, plan.wo, values), prior=made.prior)
    assert completed.info["prior"] == f"{folder.name} ({COUNT} materials)"
    assert completed.info["prior terms"] == "README.md: Licence: for research only."
    assert "31 files, sha256" in completed.info["prior sources"]


def test_own_materials_help_and_models_help_with_others(made, folder):
    """A paint like those of the folder has less error by its prior than by that of models."""
    truth = bk.models()["ggx"](diffuse_reflectance=(0.3, 0.2, 0.1), alpha_u=0.2)
    plan = bk.plan(8)
    measured = bk.Measured.from_samples(plan.wi, plan.wo, truth.eval(plan.wi, plan.wo))
    mixed = make_folder_prior(folder).prior
    errors = [
        log_error(bk.complete(measured, prior=prior), truth) for prior in (None, made.prior, mixed)
    ]
    assert max(errors[1:]) < errors[0], errors
    assert mixed.name.endswith("with brdfkit's models")


def log_error(material, truth):
    """The root mean square error of ln(f cosθi cosθo + 10⁻³) of 500 directions below 75°."""
    rng = np.random.default_rng(0)
    theta, phi = np.radians(rng.uniform(0, 75, (2, 500))), rng.uniform(0, 2 * np.pi, (2, 500))
    wi, wo = (
        np.stack([np.sin(t) * np.cos(p), np.sin(t) * np.sin(p), np.cos(t)], axis=1)
        for t, p in zip(theta, phi, strict=True)
    )
    logs = [np.log(m.eval(wi, wo) * (wi[:, 2:] * wo[:, 2:]) + 1e-3) for m in (material, truth)]
    return np.sqrt(np.mean((logs[0] - logs[1]) ** 2))


def test_the_command_writes_a_prior_that_complete_takes(folder, tmp_path):
    path = tmp_path / "mine.npz"
    result = run("prior", folder, "-o", path, "--terms", "mine [alone]", "--without-models")
    assert result.exit_code == 0, result.output
    for words in (f"{COUNT} materials", "q-copy.npz is left out", "terms: mine [alone]", str(path)):
        assert words in result.output
    assert read_prior(path).terms == ("mine [alone]",)
    result = run("complete", folder / "p01.npz", "--prior", path)
    assert "mine [alone]" in result.output, result.output
    record = json.loads(run("prior", folder, "-o", path, "--force", "--json").output)
    assert record["materials"] == COUNT
    assert record["skipped"].keys() == {
        "q-copy.npz",
        "q-full.npz",
        "q-notes.txt",
    }


def test_bad_input_is_said_in_a_sentence(folder, tmp_path):
    few = tmp_path / "few"
    few.mkdir()
    shutil.copy(folder / "p00.npz", few)
    wi = wo = np.array([[0, 0, 1.0]] * 5)
    wi = wi + [[0.1 * k, 0, 0] for k in range(5)]
    wi /= np.linalg.norm(wi, axis=1, keepdims=True)
    hair = bk.Measured.from_samples(wi, wo, np.ones((5, 3)), anisotropic=True)
    bk.save(hair, few / "hair.npz")
    bk.save(bk.Measured.from_samples(wi, wo, np.ones((5, 3))), few / "spots.npz")
    (tmp_path / "there.npz").write_bytes(b"")
    cases = [
        ([few], ["few has 1 materials", "hair.npz: it is anisotropic", "spots.npz: it was meas"]),
        ([tmp_path / "nowhere"], ["there is no such folder"]),
        ([folder / "p00.npz"], ["there is no such folder"]),
        ([folder, "-o", tmp_path / "x.txt"], ["written as .npz"]),
        ([folder, "-o", tmp_path / "there.npz"], ["--force"]),
        ([folder, "-o", folder / "p00.npz"], ["p00.npz"]),
    ]
    for arguments, words in cases:
        result = run("prior", *arguments)
        assert result.exit_code == 2, (arguments, result.output)
        assert all(word in result.output for word in words), (words, result.output)
        assert result.output.count("\n") == 1


def test_terms_are_those_of_the_licence_before_the_readme(tmp_path):
    assert "are not stated" in find_terms(tmp_path)
    (tmp_path / "README").write_text("No word about it.")
    (tmp_path / "SHA256SUMS").write_text("cc01 license.txt")
    assert "are not stated" in find_terms(tmp_path)
    (tmp_path / "LICENSE").write_text("License: " + "x " * 400)
    assert find_terms(tmp_path).startswith("LICENSE: License: x x")
    assert len(find_terms(tmp_path)) < 320
