"""Sweeps: many materials in several processes, past what fails, and resumed."""

import csv
import functools
import itertools
import json
import multiprocessing
import os
import pickle
import signal
import subprocess
import sys
import time
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote

import psutil
import pytest
from click.testing import CliRunner

import brdfkit as bk
from brdfkit.checks.material_subject import draw_direction_pairs
from brdfkit.cli import main
from brdfkit.core.discovery import plugin_files
from brdfkit.fitting.settings import FitSettings
from brdfkit.fitting.sweeping import sweeping
from brdfkit.fitting.sweeping.planning import plan_tasks, split_tasks
from brdfkit.fitting.sweeping.tasks import fit_models

TRUTHS = {
    "chalk": bk.models()["lambert"](diffuse_reflectance=(0.5, 0.4, 0.3)),
    "copper": bk.models()["ggx"](alpha_u=0.3, specular_reflectance=(0.9, 0.6, 0.4)),
    "paint": bk.models()["ward"](alpha_u=0.2, diffuse_reflectance=(0.1, 0.2, 0.3)),
}
FILES = [f"{name}.npz" for name in TRUTHS]
LINEAR = ["lambert", "koenderink"]  # fitted in no time


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """The files of three small materials, by name."""
    folder = tmp_path_factory.mktemp("materials")
    for seed, (name, truth) in enumerate(TRUTHS.items()):
        wi, wo = draw_direction_pairs(200, seed=seed, max_degrees=75)
        bk.save(bk.Measured.from_samples(wi, wo, truth.eval(wi, wo)), folder / f"{name}.npz")
    return {file: (folder / file).read_bytes() for file in FILES}


@pytest.fixture
def here(made, tmp_path, monkeypatch):
    """A current folder with the files."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(plugin_files, "_users", {})
    for file, data in made.items():
        Path(file).write_bytes(data)
    return tmp_path


@pytest.fixture
def fitted(monkeypatch):
    """Sweeps run in this process; gives the list of (material, model) that were fitted."""
    done = []
    monkeypatch.setattr(sweeping, "run_in_processes", functools.partial(run_here, done=done))
    return done


def run_here(tasks, workers, done=None):
    """`run_in_processes` without any; what is finished is added to the list `done`."""
    for outcome in itertools.chain.from_iterable(map(fit_models, tasks)):
        if done is not None:
            done.append((outcome.material, outcome.model))
        yield outcome


def tree(folder="."):
    return sorted(p.relative_to(folder).as_posix() for p in Path(folder).rglob("*"))


# What comes out


def test_rows_and_the_best(here, fitted):
    found = bk.sweep(FILES, LINEAR)
    assert [(r.material, r.model) for r in found.rows] == [(m, n) for m in TRUTHS for n in LINEAR]
    assert found.requested == len(found.fits) == 6
    assert found.failed == []
    for row in found.rows:
        assert row.fit == bk.fit(row.file, row.model)
        assert row.error == row.fit.loss
        assert row.parameters == {"lambert": 3, "koenderink": 15}[row.model]
    for material, best in found.best.items():
        assert best.loss == min(r.error for r in found.rows if r.material == material)
    assert [line.split()[0] for line in str(found).splitlines()[1:5]] == ["material", *TRUTHS]
    assert str(found).splitlines()[-1].startswith("  6 of 6 fits; ")


def test_fits_are_judged_where_they_were_not_fitted_and_by_pictures(here, fitted):
    models = ["lambert", "ward"]
    found = bk.sweep(["chalk.npz", "paint.npz"], models, judge=True, folder="out")
    judged = {(r.material, r.model): (r.held_out, r.psnr) for r in found.rows}
    for material, truth in ("chalk", "lambert"), ("paint", "ward"):  # which predict themselves
        assert judged[material, truth][0] < 1e-4
    assert judged["chalk", "lambert"][1] > 80
    assert judged["paint", "ward"][1] > judged["paint", "lambert"][1] + 5
    error, psnr = judged["paint", "lambert"]
    assert 0.5 < error / found.rows[2].error < 5
    ranking = bk.rank("paint.npz", models, loss="cbrt")
    assert abs(psnr - {row.model: row.psnr for row in ranking.rows}["lambert"]) < 1
    text = Path("out/index.html").read_text(encoding="utf-8")
    assert "<h2>Errors where they were not fitted</h2>" in text
    assert f"{psnr:.1f}" in text
    assert "--judge" not in text

    # They are kept with the fits; what was not judged is done anew
    again = bk.sweep(["chalk.npz", "paint.npz"], models, judge=True, folder="out")
    assert again.found == 4
    assert {(r.material, r.model): (r.held_out, r.psnr) for r in again.rows} == judged
    bk.sweep(["chalk.npz"], models, folder="other")
    assert bk.sweep(["chalk.npz"], models, judge=True, folder="other").found == 0


def test_fits_whose_light_is_wrong_are_marked_and_counted(here, fitted):
    found = bk.sweep(["plaster", "red_plastic"], ["lambert", "ggx"], folder="out")
    wrong = [row for row in found.rows if row.fit.warnings]
    assert found.warned == wrong
    assert 0 < len(wrong) < 4
    assert f"; the light of {len(wrong)} is wrong (!); " in found.summary
    lines = str(found).splitlines()
    assert sum(line.count("! 0.") for line in lines) == len(wrong)
    counts = [sum(row.model == model for row in wrong) for model in ("lambert", "ggx")]
    assert f"! light is wrong {counts[0]} {counts[1]}" in [" ".join(line.split()) for line in lines]
    text = Path("out/index.html").read_text(encoding="utf-8")
    assert text.count(' bad" title=') == len(wrong)
    assert all(row.fit.warnings[0] in text for row in wrong)
    with Path("out/table.csv").open(encoding="utf-8", newline="") as stream:
        for row, read in zip(found.rows, csv.DictReader(stream), strict=True):
            assert read["warnings"] == "; ".join(row.fit.warnings)
            for place, angle in enumerate((5, 45, 75)):
                own, known = row.fit.albedo.fit[place], row.fit.albedo.measured[place]
                assert float(read[f"albedo_{angle}"]) == pytest.approx(sum(own) / 3)
                assert float(read[f"measured_albedo_{angle}"]) == pytest.approx(sum(known) / 3)


def test_settings_are_those_of_a_fit(here, fitted):
    settings = {"loss": "cbrt", "robust": "bisquare", "max_angle": 60, "fixed": {"alpha_u": 0.1}}
    settings |= {"solver": "trust_region"}
    row = bk.sweep("paint.npz", "ward", settings=settings).rows[0]
    assert row.fit == bk.fit("paint.npz", "ward", **settings)
    assert (row.loss, row.parameters) == ("cbrt", 6)


def test_what_fails_does_not_stop_the_others(here, fitted):
    Path("short.npz").write_bytes(b"PK")
    bk.save(bk.fit("chalk.npz", "lambert"), "fit.json")
    found = bk.sweep(["missing.npz", *FILES, "short.npz", "fit.json", "crapet"], LINEAR)
    assert [r.material for r in found.failed[::2]] == ["missing", "short", "fit", "crapet"]
    assert len(found.fits) == 6
    assert len(found.problems) == 4
    bad = "missing.npz", "short.npz", "fit.json", "crapet"
    for file, said in zip(bad, found.problems, strict=True):
        assert said.count(file) == 1, said
    assert str(here) not in str(found)
    assert found.problems[0] in str(found)


def test_a_name_counts_once_and_names_are_made_unlike(here, fitted):
    Path("old").mkdir()
    Path("old/paint.npz").write_bytes(Path("chalk.npz").read_bytes())
    files = ["paint.npz", "./paint.npz", Path("old/paint.npz")]
    found = bk.sweep(files, ["lambert", "lambert"])
    assert [(r.material, r.file) for r in found.rows] == [
        ("paint", "paint.npz"),
        ("paint (2)", "old/paint.npz"),
    ]


@pytest.mark.quick
def test_an_error_that_is_not_for_people_fails_one_fit(here, fitted, monkeypatch):
    def broken(data, name, **settings):
        return {}[name] if name == "lambert" else bk.fit(data, name, **settings)

    monkeypatch.setattr("brdfkit.fitting.sweeping.tasks.fit", broken)
    found = bk.sweep("chalk.npz", LINEAR)
    assert found.problems == ["chalk.npz: lambert fails with KeyError ('lambert')."]
    assert len(found.fits) == 1


@pytest.mark.quick
@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ((FILES, "wrad"), "did you mean ward"),
        ((FILES, []), "no model here"),
        (([], "ward"), "no file here"),
        ((FILES, "ward", {"los": "log"}), "no setting of a fit 'los'; did you mean loss?"),
        ((FILES, "ward", {"loss": "lgo"}), "did you mean log"),
        ((FILES, "ward", {"max_angle": 300}), "max_angle = 300"),
        (([TRUTHS["chalk"]], "ward"), "takes files"),
        ((FILES, type("Felt", (bk.Model,), {})), "Felt is defined in no file"),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_wrong_arguments_are_told_before_the_work(here, fitted, arguments, said):
    with pytest.raises(bk.BrdfkitError, match=said.replace("?", r"\?")):
        bk.sweep(*arguments[:2], settings=dict(*arguments[2:]), folder="new")
    assert fitted == []
    assert not Path("new").exists()


@pytest.mark.quick
@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"workers": 0}, "workers = 0"),
        ({"client": "tcp://here"}, "should be a dask.distributed.Client"),
        ({"client": "tcp://here", "workers": 2}, "either workers or a client"),
        ({"folder": "chalk.npz"}, "cannot be made a folder"),
    ],
)
def test_wrong_options_are_told_before_the_work(here, fitted, options, said):
    with pytest.raises(bk.BrdfkitError, match=said):
        bk.sweep(FILES, LINEAR, **options)
    assert fitted == []


# Saved, and resumed


def test_a_later_sweep_does_the_rest(here, fitted):
    first = bk.sweep(FILES[:2], "lambert", folder="out")
    assert tree("out") == sorted(
        ["chalk", "chalk/lambert.json", "copper", "copper/lambert.json", "index.html", "table.csv"]
    )
    assert [bk.load(row.saved) for row in first.rows] == first.fits
    fitted.clear()
    reports = []
    more = bk.sweep(
        FILES,
        LINEAR,
        settings={"loss": "cbrt"},
        folder="out",
        progress=lambda *step: reports.append(step),
    )
    assert set(fitted) == {(m, n) for m in TRUTHS for n in LINEAR} - {
        ("chalk", "lambert"),
        ("copper", "lambert"),
    }
    assert reports == [(done, 4) for done in range(5)]
    assert (more.found, len(more.fits)) == (2, 6)
    assert more.rows[0] == first.rows[0]
    fitted.clear()
    again = bk.sweep(FILES, LINEAR, folder="out")
    assert fitted == []
    assert again.rows == more.rows
    assert "6 of 6 fits, 6 of them saved before" in str(again)


def test_what_has_changed_is_fitted_again(here, fitted, monkeypatch):
    def changed(**settings):
        fitted.clear()
        bk.sweep(FILES, "lambert", settings=settings, folder="out")
        return [material for material, _ in fitted]

    assert changed() == ["chalk", "copper", "paint"]
    Path("copper.npz").write_bytes(Path("chalk.npz").read_bytes())
    assert changed() == ["copper"]
    assert changed(max_angle=70) == ["chalk", "copper", "paint"]
    Path("out/paint/lambert.json").write_text("{")
    Path("out/chalk/lambert.json").write_text("[1]")
    assert changed(max_angle=70) == ["chalk", "paint"]
    bk.save(bk.fit("chalk.npz", "lambert", max_angle=70), "out/chalk/lambert.json")
    assert changed(max_angle=70) == ["chalk"]  # of which nobody knows that it is this one
    defaults = "brdfkit.fitting.sweeping.tasks.Task.__init__.__defaults__"
    monkeypatch.setattr(defaults, (False, "", "0.0.9"))
    assert changed(max_angle=70) == ["chalk", "copper", "paint"]


FELT = '''"""Felt: dull."""

from brdfkit.model import Model, weight
from brdfkit.model.lobes import lambertian


class Felt(Model):
    diffuse_reflectance = weight(0.3, "k_d")

    def lobes(self):
        return (lambertian(),)
'''


def test_a_model_of_ones_own_is_fitted_again_when_its_file_changes(here, fitted):
    Path("felt.py").write_text(FELT)
    for expected in (["felt"], [], ["felt+ward", "felt"]):
        fitted.clear()
        bk.sweep("chalk.npz", ["lambert", *expected[:-1], "felt.py"], folder="out")
        assert [model for _, model in fitted if model != "lambert"] == expected
        if not expected:
            Path("felt.py").write_text(FELT + "\n")


@pytest.mark.quick
def test_a_file_that_changes_meanwhile_fails(here):
    (task,) = plan_tasks("chalk.npz", "lambert", FitSettings.from_dictionary({}))
    Path("chalk.npz").write_bytes(Path("paint.npz").read_bytes())
    (outcome,) = fit_models(task)
    assert outcome.failure == "chalk.npz: has changed since the work began; begin it again."
    (outcome,) = fit_models(replace(task, version="0.0.9"))
    assert "the worker has brdfkit" in outcome.failure


@pytest.mark.quick
def test_a_task_is_plain_data_and_is_cut_where_there_are_few(here):
    tasks = plan_tasks(FILES, [*LINEAR, "ward"], FitSettings.from_dictionary({}))
    assert pickle.loads(pickle.dumps(tasks)) == tasks
    for workers, parts in ((1, 6), (2, 9), (8, 9)):
        cut = split_tasks(tasks, workers)
        assert len(cut) == parts
        assert [(t.file, m) for t in cut for m in t.models] == [
            (t.file, m) for t in tasks for m in t.models
        ]


def test_ctrl_c_ends_with_what_is_finished(here, fitted):
    def progress(done, total):
        if done == stop:
            raise KeyboardInterrupt

    stop = 2
    found = bk.sweep(FILES, LINEAR, folder="out", progress=progress)
    assert (len(found.rows), found.requested) == (2, 6)
    assert "2 of 6 fits" in str(found)
    assert {"index.html", "table.csv"} < set(tree("out"))
    stop = 0
    with pytest.raises(KeyboardInterrupt):
        bk.sweep(FILES, LINEAR, progress=progress)


# Written


@pytest.fixture
def swept(here, fitted):
    """A sweep with a failure and a name that is markup."""
    Path("<i>&.npz").write_bytes(Path("paint.npz").read_bytes())
    return bk.sweep(["chalk.npz", "<i>&.npz", "missing.npz"], LINEAR, folder="out")


def test_the_table(swept):
    with Path("out/table.csv").open(encoding="utf-8", newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert [r["material"] for r in rows] == [r.material for r in swept.rows]
    for written, row in zip(rows, swept.rows, strict=True):
        assert written["message"] == row.message
        if row.fit:
            assert float(written["error"]) == row.error
            assert json.loads(written["values"]) == {k: list(v) for k, v in row.fit.values.items()}
        else:
            assert written["error"] == written["seconds"] == written["values"] == ""


def test_parquet(swept, monkeypatch):
    parquet = pytest.importorskip("pyarrow.parquet")
    swept.to_parquet("table.parquet")
    table = parquet.read_table("table.parquet").to_pydict()
    assert table["error"] == [row.error if row.fit else None for row in swept.rows]
    with Path("out/table.csv").open(encoding="utf-8") as stream:
        assert list(table) == next(csv.reader(stream))
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    with pytest.raises(bk.BrdfkitError, match=r"other.parquet: .*pip install pyarrow"):
        swept.to_parquet("other.parquet")
    assert not Path("other.parquet").exists()


class Page(HTMLParser):
    """The tags and the text of a page; fails where a tag is not closed."""

    def __init__(self, text):
        super().__init__()
        self.open, self.tags, self.links, self.text = [], [], [], ""
        self.feed(text)
        assert self.open == []

    def handle_starttag(self, tag, attrs):
        self.tags.append(tag)
        self.links += [value for name, value in attrs if name == "href"]
        if tag not in ("meta", "br"):
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.text += data


def test_the_page(swept):
    text = Path("out/index.html").read_text(encoding="utf-8")
    page = Page(text)
    assert not {"i", "img", "link"} & set(page.tags)
    assert page.tags.count("script") == 1  # which sorts the tables
    assert "prefers-color-scheme: dark" in text
    assert "://" not in text
    assert swept.problems[0] in page.text
    assert all(f"{row.error:.5f}" in page.text for row in swept.rows if row.fit)
    assert len(page.links) == len(swept.fits) == 4
    assert all(bk.load(Path("out", unquote(link))) in swept.fits for link in page.links)
    Path("elsewhere").mkdir()
    swept.to_html("elsewhere/page.html")
    links = Page(Path("elsewhere/page.html").read_text(encoding="utf-8")).links
    assert all(Path("elsewhere", unquote(link)).is_file() for link in links)


# In processes

DEADLY = '''"""Deadly: ends its process."""

import multiprocessing
import os
import signal
from pathlib import Path

from brdfkit.model import Model, weight
from brdfkit.model.lobes import lambertian


class Deadly(Model):
    diffuse_reflectance = weight(0.3, "k_d")

    def lobes(self):
        if multiprocessing.parent_process() and ALWAYS_OR_ONCE:
            Path("died").touch()
            os.kill(os.getpid(), signal.SIGKILL)
        return (lambertian(),)
'''


@pytest.mark.parametrize("always", [False, True])
def test_a_process_that_dies_takes_nothing_with_it(here, always):
    condition = "True" if always else 'not Path("died").exists()'
    Path("deadly.py").write_text(DEADLY.replace("ALWAYS_OR_ONCE", condition))
    found = bk.sweep("chalk.npz", ["lambert", "deadly.py", "koenderink"], workers=1, folder="out")
    assert [row.model for row in found.rows] == ["lambert", "deadly", "koenderink"]
    assert Path("died").exists()
    assert [row.model for row in found.failed] == (["deadly"] if always else [])
    if always:
        assert found.problems == [
            "chalk.npz: deadly ended its process 2 times (SIGKILL); give fewer workers if memory "
            "is short."
        ]
    assert multiprocessing.active_children() == []


SLOW = FELT.replace("Felt", "Slow").replace(
    "        return",
    "        time.sleep(600 if multiprocessing.parent_process() else 0)\n        return",
)
SWEEPS = """
import brdfkit.cli

models = ["-m", "lambert", "-m", "slow.py"]
brdfkit.cli.main(["fit", "chalk.npz", "paint.npz", *models, "-o", "out", "-j", "2"])
"""


def test_ctrl_c_ends_the_processes_and_keeps_what_is_finished(here):
    """Typed in a terminal, a Ctrl-C reaches all processes. The script has no guard that keeps its
    processes from running it, too."""
    Path("slow.py").write_text("import multiprocessing\nimport time\n" + SLOW)
    Path("script.py").write_text(SWEEPS)
    command = [sys.executable, "-W", "error", "script.py"]
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    with subprocess.Popen(command, text=True, start_new_session=True, **pipes) as process:
        while len([name for name in tree() if name.endswith("lambert.json")]) < 2:
            time.sleep(0.05)
            assert process.poll() is None
        children = psutil.Process(process.pid).children()
        workers = [child for child in children if "spawn_main" in " ".join(child.cmdline())]
        os.killpg(process.pid, signal.SIGINT)
        try:
            printed, told = process.communicate(timeout=300)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)  # or the block would wait for it without end
            raise
    assert process.returncode == 130
    assert told == (
        "brdfkit: interrupted; 2 of 4 fits are finished; the same command continues from there.\n"
    )
    assert "2 of 4 fits; " in printed
    assert "out/index.html" in printed
    assert [worker.is_running() for worker in workers] == [False, False]
    assert len(tree("out")) == 6


# On the command line


@pytest.fixture
def cli(here, fitted):
    """A function that runs the command line, which gives its status and output."""
    return lambda *words: CliRunner().invoke(main, [str(w) for w in words])


MODELS = [word for name in LINEAR for word in ("-m", name)]


def test_the_command(cli):
    result = cli("fit", *FILES, *MODELS, "-o", "out")
    assert (result.exit_code, result.stderr) == (0, "")
    assert all(name in result.stdout for name in [*TRUTHS, *LINEAR, "median", "6 of 6 fits"])
    assert result.stdout.count("written: ") == 3
    assert {"chalk/lambert.json", "index.html", "table.csv"} < set(tree("out"))
    record = json.loads(cli("fit", *FILES, *MODELS, "-o", "out", "--json").stdout)
    assert record["failed"] == []
    for fit, row in zip(record["fits"], bk.sweep(FILES, LINEAR, folder="out").rows, strict=True):
        assert (fit["material"], fit["model"], fit["error"]) == (row.material, row.model, row.error)
    assert set(record["written"]) == {f"out/{name}" for name in tree("out") if "." in name}


def test_the_command_goes_past_bad_files(cli):
    Path("short.npz").write_bytes(b"PK")
    result = cli("fit", "short.npz", *FILES, "missing.npz", *MODELS, "--json")
    assert result.exit_code == 2
    first, second = result.stderr.splitlines()
    assert first.startswith("brdfkit: short.npz: ")
    assert second.startswith("brdfkit: missing.npz: ")
    record = json.loads(result.stdout)
    assert len(record["fits"]) == 6
    assert [f["file"] for f in record["failed"]] == ["short.npz"] * 2 + ["missing.npz"] * 2
    nothing = cli("fit", "short.npz", "missing.npz", *MODELS, "-o", "new")
    assert (nothing.exit_code, nothing.stdout) == (2, "")
    assert sorted(nothing.stderr.splitlines()) == sorted([first, second])
    assert not Path("new").exists()


@pytest.mark.quick
@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--render"], "--render shows one material"),
        (["-j", "0"], "--workers"),
        (["--loss", "nope"], "nope"),
        (["-m", "nope"], "nope"),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, list) else "",
)
def test_the_command_refuses_in_one_sentence(cli, fitted, words, said):
    result = cli("fit", *FILES, *words, "-o", "new")
    assert (result.exit_code, result.stdout, fitted) == (2, "", [])
    assert result.stderr.startswith("brdfkit: ")
    assert result.stderr.count("\n") == 1
    assert said in result.stderr
    assert not Path("new").exists()
