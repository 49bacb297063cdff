"""Reports: one HTML file that says what is so, harms nobody, and moves in a browser."""

import hashlib
import inspect
import io
import json
import re
import shlex
import zlib
from base64 import b64decode, b64encode
from contextlib import contextmanager
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import drjit as dr
import numpy as np
import pytest
from click.testing import CliRunner
from PIL import Image

import brdfkit as bk
from brdfkit.cli import main
from brdfkit.core.jit.threads import use_two_threads
from brdfkit.images.errors.metrics import METRICS
from brdfkit.model.samples import Table
from brdfkit.regression.robust.reweighting import WEIGHTS
from brdfkit.reporting import many_files, origin, report
from brdfkit.reporting.charts import svg
from brdfkit.reporting.pictures import pixels
from brdfkit.reporting.pictures.defaults import MODELS
from brdfkit.reporting.pictures.defaults import SIZE as SIZE_OF_REPORTS
from brdfkit.reporting.pictures.picture_errors import PictureError
from brdfkit.reporting.pictures.pictures import render_pictures
from brdfkit.reporting.verdict.fit_errors import (
    FitErrors,
    compute_fit_errors,
    format_factor,
    make_errors_table,
    order_fits,
)
from brdfkit.reporting.verdict.picture_verdict import describe_visibility
from brdfkit.reporting.verdict.verdict import write_verdict

NAME = 'a<b>&"c"</script>'
SIZE, SPP = 48, 16
SMALL = {"spp": SPP, "size": SIZE}
TRUTH = bk.models()["ward"](
    alpha_u=0.2, diffuse_reflectance=(0.1, 0.2, 0.3), specular_reflectance=(0.3, 0.3, 0.2)
)


def measured(name, seed=0):
    """A small table of TRUTH with 3 % noise."""
    empty = Table(np.zeros((12, 12, 12, 3)))
    wi, wo = (w.reshape(-1, 3) for w in empty.directions())
    noise = 1 + 0.03 * np.random.default_rng(seed).normal(size=(len(wi), 3))
    values = (TRUTH.eval(wi, wo) * noise).reshape(empty.values.shape)
    return bk.Measured.from_table(values, name=name, info={"made <by>": "a & b"})


@pytest.fixture(scope="module")
def material():
    return measured(NAME)


@pytest.fixture(scope="module")
def fits(material):
    return [bk.fit(material, name) for name in ("lambert", "ward")]


@pytest.fixture(scope="module")
def written(material, fits, tmp_path_factory):
    """The path of a report, and what it says."""
    path = tmp_path_factory.mktemp("one") / "report.html"
    return path, report.write_report(material, fits, path, **SMALL)


@pytest.fixture(scope="module")
def rendering(material, fits):
    """The pictures of the report, the best fit first, as it shows them."""
    found = render_pictures(material, fits, **SMALL)
    measured, lambert, ward = found.pictures.values()
    return measured, ward, lambert


class Page(HTMLParser):
    """A page in its elements: (tag, attributes), and the text in those that are open."""

    def __init__(self, path):
        super().__init__(convert_charrefs=True)
        self.text, self.elements, self.open = path.read_text(encoding="utf-8"), [], []
        self.feed(self.text)
        self.close()

    def handle_starttag(self, tag, attributes):
        self.elements.append((tag, dict(attributes), []))
        if tag not in ("meta", "img", "input", "wbr", "br", "image"):
            self.open.append(self.elements[-1])

    def handle_startendtag(self, tag, attributes):
        self.elements.append((tag, dict(attributes), []))

    def handle_endtag(self, tag):
        assert self.open.pop()[0] == tag

    def handle_data(self, data):
        for _, _, texts in self.open:
            texts.append(data)

    def all(self, tag):
        """(attributes, text) of the elements of this tag."""
        return [(given, "".join(texts)) for t, given, texts in self.elements if t == tag]


def test_it_is_balanced_html_without_anything_from_elsewhere(written):
    page = Page(written[0])
    assert page.open == []
    assert page.text.startswith("<!doctype html>")
    assert not re.findall(r"\w://|@import|url\(", page.text)
    for _, attributes, _ in page.elements:
        assert not {"style", "onclick", "onload", "srcset"} & attributes.keys()
        for address in (attributes.get("src"), attributes.get("href")):
            assert address is None or address.startswith("data:image/")


def test_its_policy_allows_its_own_style_and_scripts_alone(written):
    page = Page(written[0])
    (policy,) = [a["content"] for a, _ in page.all("meta") if "http-equiv" in a]
    rules = dict(rule.strip().split(" ", 1) for rule in policy.split(";"))
    assert rules["default-src"] == "'none'"
    assert rules["img-src"] == "data:"

    def digest(text):
        return f"'sha256-{b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"

    assert rules["style-src"].split() == [digest(text) for _, text in page.all("style")]
    scripts = [text for given, text in page.all("script") if given["type"] == "module"]
    assert rules["script-src"].split() == [digest(text) for text in scripts]


def test_names_are_escaped_everywhere(written):
    page = Page(written[0])
    assert [text for _, text in page.all("h1")] == [NAME]
    assert NAME in page.all("title")[0][1]
    (packed,) = [text for given, text in page.all("script") if given["type"] != "module"]
    assert json.loads(packed)["names"] == [NAME, "ward", "lambert"]
    assert "made <by>" in [text for _, text in page.all("dt")]
    assert len(page.all("script")) == 3
    records = [json.loads(text) for _, text in page.all("pre") if text.startswith("{")]
    assert [record["material"] for record in records] == [NAME, NAME]


def test_equal_input_gives_equal_bytes_however_many_threads(written, material, fits, tmp_path):
    threads = dr.thread_count()
    try:
        dr.set_thread_count(3)
        again = report.report(material, fits, path=tmp_path / "report.html", **SMALL)
    finally:
        dr.set_thread_count(threads)
    assert again.read_bytes() == written[0].read_bytes()


def test_three_fits_are_below_three_megabytes(written):
    """Of noisy pixels, which hardly shrink, there are as many bytes as there are pixels."""
    page, packed = len(written[0].read_bytes()), written[1].page["pixels"]
    small = [sum(map(len, packed[kind])) for kind in ("pictures", "differences")]
    full = [size * (SIZE_OF_REPORTS / SIZE) ** 2 for size in small]
    assert page - sum(small) + full[0] * 4 / 3 + full[1] * 3 / 2 < 2_500_000  # and 3 more charts


def unpack(text):
    """The codes that the script unpacks, by NumPy."""
    split = np.frombuffer(zlib.decompress(b64decode(text)), np.uint8).reshape(2, -1)
    return np.cumsum(split[0] + 256 * split[1].astype(np.uint16), dtype=np.uint16)


def test_the_pixels_are_linear_light_to_half_a_step(written, rendering):
    packed = written[1].page["pixels"]
    for text, picture in zip(packed["pictures"], rendering, strict=True):
        codes = unpack(text).reshape(3, SIZE, SIZE)
        light = np.where(codes, 2.0 ** (packed["darkest"] + codes / packed["steps"]), 0)
        np.testing.assert_allclose(light, np.moveaxis(picture, -1, 0), rtol=0.0028, atol=2**-13)


def test_a_difference_is_kept_to_a_few_hundredths_where_it_is_small():
    given = np.array([[0.0, 0.5, 1.0, 5.0, 100.0, 300.0, np.nan]])
    kept = pixels.LARGEST_DIFFERENCE * (pixels.encode_difference(given) / 255) ** 2
    np.testing.assert_allclose(kept[0, :4], given[0, :4], atol=0.08)
    assert kept[0, 4:].tolist() == [100, 100, 0]


def test_the_verdict_is_what_the_samples_say(written, material, fits):
    said = written[1]
    assert said.names == ["ward", "lambert"]
    assert said.verdict.startswith("ward is best by every loss and by its picture. Half of the")
    # the ratio of every measured and modelled value
    samples = material.samples.at(material.samples.within(80))
    measured, rows = samples.values.ravel(), said.page["errors"]["rows"]
    for fit, row in zip(reversed(fits), rows, strict=True):
        ratio = fit.eval(samples.wi, samples.wo).ravel()[measured > 0] / measured[measured > 0]
        factors = np.quantile(np.maximum(ratio, 1 / ratio), [0.5, 0.95])
        for text, factor in zip((row["typical"], row["large"]), factors, strict=True):
            assert abs(float(text) - factor) < (0.006 if "." in text else 0.51)  # as it is rounded
    head = re.search(r"within a factor of ([\d.]+), 95\s% within ([\d.]+), ", said.verdict)
    assert head.groups() == (rows[0]["typical"], rows[0]["large"])
    assert "Its lead over the others is more than noise." in said.page["more"]


def test_the_light_is_shown_beside_the_measured_and_marked_where_it_is_wrong(
    written, material, fits
):
    """In the words of the fit's notes: below the table of fits, and with the parameters."""
    page, (warning,) = Page(written[0]), fits[0].warnings
    assert warning in fits[0].notes
    assert not fits[1].warnings
    bad = {"bad", "small bad", "number bad"}
    said, marked = ([t for a, t in page.all(tag) if a.get("class") in bad] for tag in ("p", "td"))
    assert said == [f"lambert: {warning}", warning]
    albedo = f"{np.mean(fits[0].albedo.fit[0]):.2f}"
    assert marked == [albedo]
    (row,) = [text for _, text in page.all("tr") if text.startswith("measured-")]
    assert row.split("-")[-2] == "".join(f"{a:.2f}" for a in material.albedo.means)


def test_equal_fits_are_tied_and_worse_ones_are_not(material, fits):
    lambert, ward = fits
    near = bk.fit(material, "ward", max_angle=79)
    tied = [one.is_tied for one in compute_fit_errors(material, [ward, near, lambert], "log")]
    assert tied == [True, True, False]


def stood(error, numbers, tied):
    """A `FitErrors` by log and cbrt, of which cbrt likes few numbers."""
    errors = {"log": error, "cbrt": numbers / 10}
    return FitErrors(errors, (0.2, 0.3, 1.1), 1.1, 1.4, 1.2, (75, 90), numbers, tied)


def psnr_and_delta(psnr, floor=50.0, delta=0.1, noise=0.1):
    """The `PictureError`s of fits with these PSNRs; each ΔE is `delta`."""
    deltas = [PictureError(METRICS[f"delta_e_2000{end}"], (delta,), noise) for end in ("", "_95")]
    errors = PictureError(METRICS["psnr"], psnr, floor), *deltas
    return dict(zip(("psnr", "delta_e_2000", "delta_e_2000_95"), errors, strict=True))


def test_of_tied_fits_the_one_with_the_fewest_numbers_is_taken():
    found = [stood(0.30, 13, True), stood(0.31, 8, True), stood(0.5, 7, False)]
    order = order_fits(found, "log")
    assert order == [1, 0, 2]
    names, found = ["ggx", "ggx+ggx", "ward"], [found[k] for k in order]
    head, more = write_verdict(names, found, psnr_and_delta((40.0, 40.8, 20.0)), "log")
    assert head.startswith(
        "ggx is enough: ggx+ggx, with 5 more numbers, is no better by more than noise. Half of "
    )
    assert more[0] == "By cbrt, ward is ahead."
    assert "In the picture ggx+ggx comes nearest: PSNR 40.8 dB, against 40.0 dB of ggx." in more
    rows = make_errors_table(found, "log", (0.2, np.nan, np.nan))["rows"]
    assert [row["verdict"] for row in rows] == ["take", "tied", ""]
    assert rows[0]["albedos"] == [("0.20", False), ("0.30", False), ("1.10", True)]


def test_the_verdict_leaves_out_what_is_noise_or_said_already():
    found = [stood(0.3, 8, True), stood(0.5, 8, False)]
    for nearer, floor, told in ((40.8, 50.0, True), (40.8, 42.0, False), (40.01, 90.0, False)):
        more = write_verdict(["a", "b"], found, psnr_and_delta((40.0, nearer), floor), "log")[1]
        assert any("comes nearest" in sentence for sentence in more) == told
    # half are met within 1.1 in all, and 1.2 or 1.12 where they are met worst
    assert more[-1].endswith(
        "75° to 90°: half of the values there are met within a factor of 1.20."
    )
    for cbrt, told in ((0.79, True), (0.796, False)):  # of 0.8
        other = replace(found[1], by_loss={"log": 0.5, "cbrt": cbrt})
        more = write_verdict(["a", "b"], [found[0], other], psnr_and_delta((40.0, 30.0)), "log")[1]
        assert ("By cbrt, b is ahead." in more) == told
    near = [replace(one, worst_factor=1.12) for one in found]
    assert "farthest" not in "".join(
        write_verdict(["a", "b"], near, psnr_and_delta((40.0, 30.0)), "log")[1]
    )


@pytest.mark.parametrize(
    ("delta", "noise", "words"),
    [
        (3.2, 3.0, "the pictures are too noisy to tell; use more --spp"),
        (9.0, 3.0, "its picture is plainly another one"),
        (1.5, 0.5, "its picture differs visibly, side by side"),
        (0.1, 0.1, "its picture differs by no more than noise"),
        (0.5, 0.1, "its picture cannot be told"),
    ],
)
def test_what_noise_hides_is_not_called_visible(delta, noise, words):
    assert describe_visibility(psnr_and_delta((30.0,), 30.0, delta, noise)).startswith(words)


@pytest.mark.parametrize(
    ("factor", "words"), [(1.0, "1.00"), (1.5, "1.50"), (14.9, "15"), (np.inf, "1,000 or more")]
)
def test_factors_in_words(factor, words):
    assert format_factor(factor) == words


def write_materials():
    """Write two materials and a file that is none to the current folder."""
    for seed, name in enumerate(("paint", "second paint")):
        bk.save(measured(name, seed), f"{name}.npz")
    Path("bad.npz").write_text("bad")


@pytest.fixture
def here(tmp_path, monkeypatch):
    """A current folder with materials."""
    monkeypatch.chdir(tmp_path)
    write_materials()
    return tmp_path


def cli(*words):
    return CliRunner().invoke(main, list(map(str, words)), catch_exceptions=False)


FEW = "--spp", SPP, "--size", SIZE, "-m", "ward"


def test_the_command_in_a_report_repeats_it(here):
    done = cli("report", "paint.npz", *FEW, "--loss", "cbrt", "--max-angle", 70)
    assert done.exit_code == 0, done.stderr
    assert "ward is the only fit" in done.stdout
    path = Path("paint-report.html")
    first = path.read_bytes()
    page = Page(path)
    facts = dict(zip(*([text for _, text in page.all(tag)] for tag in ("dt", "dd")), strict=True))
    assert (
        facts["SHA-256 of the file"] == hashlib.sha256(Path("paint.npz").read_bytes()).hexdigest()
    )
    program, *words = shlex.split(page.all("pre")[-1][1])
    assert program == "brdfkit"
    path.unlink()
    assert cli(*words).exit_code == 0
    assert path.read_bytes() == first


def test_settings_that_no_option_tells_are_named(material):
    settings = {"solver": "slsqp", "constraints": bk.solvers.AlbedoAtMost(0.9), "max_angle": 70}
    told = bk.fit(material, "lambert", **settings)
    how = {**SMALL, "seed": 0, "scene": "ball", "environment": None}
    words, untold = origin.make_command(material, "x.npz", [told], "out/x y.html", **how)
    assert words.endswith(
        "--max-angle 70 --solver slsqp --albedo-at-most 0.9 --spp 16 --size 48 "
        "--seed 0 -o 'x y.html'"
    )
    assert untold == []
    ward = bk.fit(material, "ward", loss="log", bounds={"alpha_u": (0.1, 0.3)}, seed=3, starts=1)
    _, untold = origin.make_command(material, None, [told, ward], "x.html", **how)
    assert {"loss", "bounds", "seed", "starts"} <= set(untold)


def test_the_page_says_which_model_was_chosen_and_why(here, monkeypatch):
    monkeypatch.setattr(
        "brdfkit.fitting.ranking.ranking.list_default_models", lambda: ["lambert", "ward"]
    )
    done = cli("report", "paint.npz", "--spp", SPP, "--size", SIZE, "-m", "best")
    assert done.exit_code == 0, done.stderr
    best = "no other model has a lesser error or a better picture"
    why = f"ward was chosen from 2 models, because {best}."
    assert why in done.stdout
    page = Page(Path("paint-report.html"))
    assert why in page.text
    texts = [text for _, text in page.all("p")]
    assert any(text.startswith("ward is recommended: no other model has") for text in texts)
    rows = [text for _, text in page.all("tr")]
    assert sum(text.startswith("lambert") for text in rows) == 1  # ranked, and not fitted
    assert [text[:8] for text in rows if "take" in text] == ["wardtake"]
    assert "time [s]" not in page.text  # another one each time
    assert "by every loss" not in page.text


def test_another_scene_and_light(here, material):
    import mitsuba as mi

    with use_two_threads():
        mi.Bitmap(np.ones((4, 8, 3), np.float32)).write("grey.exr")
    mi.load_dict({"type": "cube"}).write_ply("cube.ply")
    place = {"scene": "cube.ply", "environment": "grey.exr"}
    once, again = (render_pictures(material, [], SPP, size=16, **place) for _ in range(2))
    np.testing.assert_array_equal(once.pictures[NAME], again.pictures[NAME])
    sides = once.mask.any(axis=0).sum(), once.mask.any(axis=1).sum()
    assert once.mask.sum() > 0.85 * np.prod(sides)  # a ball has π/4 of the square around it
    words = "--spp", SPP, "--size", 16, "-m", "lambert", "--scene", "vase", "--envmap", "grey.exr"
    assert cli("report", "paint.npz", *words).exit_code == 0
    page = Page(Path("paint-report.html"))
    assert "They show the scene vase, lit by grey.exr." in [text for _, text in page.all("p")]
    assert "--scene vase --envmap grey.exr" in page.all("pre")[-1][1]


def test_doubts_stand_under_the_head_and_in_the_terminal(here):
    bright = TRUTH.__class__(diffuse_reflectance=(1.5, 1.5, 1.5))
    table = Table(np.zeros((12, 12, 12, 3)))
    wi, wo = (w.reshape(-1, 3) for w in table.directions())
    values = bright.eval(wi, wo).reshape(table.values.shape)
    bk.save(bk.Measured.from_table(values, name="bright"), "bright.npz")
    done = cli("report", "bright.npz", *FEW)
    doubts = bk.audit("bright.npz").findings()
    assert doubts
    for doubt in doubts:
        assert f"The measurement is doubtful: {doubt}.\n" in done.stdout
    warnings = [f"ward: {warning}" for warning in bk.fit("bright.npz", "ward").warnings]
    assert warnings
    for warning in warnings:
        assert f"! {warning}\n" in done.stdout
    page = Page(Path("bright-report.html"))
    ((_, head),) = page.all("header")
    assert all(doubt in head for doubt in (*doubts, *warnings))


def test_in_python_models_and_the_file_have_defaults(here):
    assert inspect.signature(bk.report).parameters["models"].default == MODELS
    path = bk.report(measured("second paint"), "lambert", **SMALL)
    assert path == Path("second paint-report.html")
    assert path.is_file()


def test_lines_that_lie_on_each_other_are_all_seen():
    assert len({svg.choose_css_class(number) for number in range(18)}) == 18
    chart = svg.Chart("", *[svg.make_linear_axis("", 0, 1, ())] * 2)
    chart.add_fits([([0, 1], [0, 1])] * 5)
    drawn = [line.split() for line in re.findall(r'class="line (fit-[^"]*)"', chart.svg)]
    solid, broken = ([k[0] for k in drawn if len(k) == n] for n in (1, 2))
    assert [k[0] for k in drawn] == solid + broken
    assert solid == ["fit-3", "fit-0"]


def test_help_lists_all_weights():
    assert ", ".join(list(WEIGHTS)[:-1]) in " ".join(cli("report", "--help").stdout.split())


@pytest.fixture(scope="module")
def reports(tmp_path_factory):
    """A folder of reports of two materials and a bad file, and what was printed."""
    folder = tmp_path_factory.mktemp("many")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        write_materials()
        files = "second paint.npz", "bad.npz", "paint.npz"
        done = cli("report", *files, *FEW, "-m", "ward.json", "-o", "all")
    return folder / "all", done


def test_a_gallery_passes_bad_files_and_models_that_cannot_be_fitted(reports):
    folder, done = reports
    assert done.exit_code == 2
    assert "brdfkit: bad.npz: " in done.stderr
    assert "brdfkit: paint: ward.json: there is no such file" in done.stderr
    written = {p.name for p in folder.iterdir()}
    assert written == {"index.html", "paint.html", "second paint.html"}
    page = Page(folder / "index.html")
    assert page.open == []
    assert {given["href"] for given, _ in page.all("a")} == {"paint.html", "second%20paint.html"}
    assert "ward.json" in next(text for _, text in page.all("li"))
    verdicts = [t for given, t in page.all("td") if given.get("class") == "verdict-text"]
    names = "second paint", "paint"
    assert all(v.startswith("ward is the only fit. Half of the measured") for v in verdicts)
    said = [f"{name}: {verdict}" for name, verdict in zip(names, verdicts, strict=True)]
    assert [line for line in done.stdout.splitlines() if "written" not in line] == said


@pytest.mark.parametrize(
    ("when", "finished"),
    [
        ("between", "1 of 2 reports are finished"),
        (
            "during pictures",
            "0 of 2 reports are finished, and one with fewer samples per pixel is kept",
        ),
    ],
)
def test_ctrl_c_leaves_the_reports_that_are_finished(when, finished, here, written, monkeypatch):
    def write(material, fits, path, *_, **__):
        if material.name != "paint":
            raise KeyboardInterrupt
        path.write_text("finished")
        said = written[1]
        return replace(said, requested=2 * said.spp) if when == "during pictures" else said

    monkeypatch.setattr(many_files, "write_report", write)
    done = cli("report", "paint.npz", "second paint.npz", "-m", "lambert", "-o", "some")
    assert done.exit_code == 130
    assert done.stderr == f"brdfkit: interrupted; {finished}.\n"
    assert sorted(p.name for p in Path("some").iterdir()) == ["index.html", "paint.html"]


def test_ctrl_c_during_the_pictures_keeps_their_samples(here, monkeypatch):
    monkeypatch.setattr("brdfkit.cli.console.Console.progress", stop_after_two_passes)
    done = cli("report", "paint.npz", "-m", "lambert", "--spp", 64, "--size", 16)
    said = "brdfkit: interrupted; rendered with 32 of 64 samples per pixel.\n"
    assert (done.exit_code, done.stderr) == (130, said)
    assert "32 samples per pixel" in Path("paint-report.html").read_text()


@contextmanager
def stop_after_two_passes(self, what):
    """In place of `Console.progress`: Ctrl-C in the third pass of two pictures."""

    def report(done, total):
        if what == "render" and done == 5:
            raise KeyboardInterrupt

    yield report


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["paint.npz", "-o", "page.txt"], "page.txt: a report is written as .html"),
        (["paint.npz", "-m", "wrad"], "did you mean ward?"),
        (["bad.npz"], "bad.npz: "),
        (["paint.npz", "--size", 2000], "size = 2000: pictures of a page have at most 1024"),
        (["paint.npz", "paint.npz", "-m", "best"], "-m best ranks models on one material"),
        (["paint.npz", "paint.npz", "-o", "x.html"], "x.html is one page; for several FILEs, name"),
        (["paint.npz", "ward.json"], "ward.json: a saved fit goes behind -m"),
        (["paint.npz", "--scene", "vaes"], "did you mean vase?"),
        (["paint.npz", "--scene", "room.xml#it"], "room.xml#it: a report shows materials in"),
        (["paint.npz", "--envmap", "no.exr"], "no.exr: there is no such file"),
    ],
)
def test_mistakes_are_said_and_nothing_is_written(here, words, said):
    before = sorted(here.iterdir())
    done = cli("report", *words, *([] if "-m" in words else ["-m", "lambert"]))
    assert done.exit_code == 2
    assert said in done.stderr
    assert sorted(here.iterdir()) == before


def test_a_fit_of_other_data_is_refused(fits, tmp_path):
    with pytest.raises(bk.BrdfkitError, match="not to the data of other"):
        bk.report(measured("other", seed=3), fits, path=tmp_path / "no.html", **SMALL)


# ---- In a browser --------------------------------------------------------------------------------


@pytest.fixture
def show(browser):
    """Opens a file in a tab without a network; afterwards nothing was asked for or complained."""
    asked, said, contexts = [], [], []

    def open_tab(path, **how):
        contexts.append(browser.new_context(offline=True, **how))
        tab = contexts[-1].new_page()
        tab.on("request", lambda request: asked.append(request.url))
        tab.on("console", lambda message: said.append(message.text))
        tab.on("pageerror", lambda error: said.append(str(error)))
        tab.goto(Path(path).resolve().as_uri())
        return tab

    yield open_tab
    for context in contexts:
        context.close()
    assert said == []
    assert [url for url in asked if not url.startswith(("file:", "data:"))] == []


@pytest.fixture
def tab(show, written):
    # Playwright's own questions need what the page forbids
    found = show(written[0], viewport={"width": 1200, "height": 900}, bypass_csp=True)
    found.locator(".viewer").wait_for()
    found.locator(".stage").scroll_into_view_if_needed()
    return found


def choose(tab, name, value):
    tab.locator(f"input[name={name}][value='{value}']").check(force=True)


def slide(tab, name, value):
    tab.locator(f"input[name={name}]").fill(str(value))


def drawn(tab, which):
    """The bytes (height, width, 3) of sRGB on one of the two canvases."""
    canvas = tab.locator(".stage canvas").nth(which)
    address = canvas.evaluate("canvas => canvas.toDataURL()")
    return opened(b64decode(address.partition(",")[2]))


def opened(png):
    """The bytes (height, width, 3) of sRGB in a PNG."""
    return np.asarray(Image.open(io.BytesIO(png)).convert("RGB"), float)


def srgb(linear):
    """The bytes of sRGB, by the formula of IEC 61966-2-1."""
    x = np.clip(linear, 0, 1)
    return 255 * np.where(x <= 0.0031308, 12.92 * x, 1.055 * x ** (1 / 2.4) - 0.055)


def test_pictures_are_shown_at_the_chosen_exposure(tab, rendering):
    for stops in (0, 2.5, -4):
        slide(tab, "exposure", stops)
        for which in (0, 1):
            expected = srgb(rendering[which] * 2**stops)
            assert np.abs(drawn(tab, which) - expected).max() < 1.5
    assert tab.locator("output[name=stops]").inner_text() == "−4 stops"


def test_the_wipe_moves_by_keyboard_and_by_pointer(tab):
    over = tab.locator(".over")

    def clip():
        return over.evaluate("e => getComputedStyle(e).clipPath")

    assert clip() == "inset(0px 0px 0px 50%)"
    tab.locator("input[name=wipe]").focus()
    tab.keyboard.press("Home")
    assert clip() in ("inset(0px)", "inset(0px 0px 0px 0%)")
    tab.locator(".stage").scroll_into_view_if_needed()
    box = tab.locator(".stage").bounding_box()
    tab.mouse.move(box["x"] + box["width"] * 0.5, box["y"] + 50)
    tab.mouse.down()
    tab.mouse.move(box["x"] + box["width"] * 0.75, box["y"] + 50)
    tab.mouse.up()
    assert clip() == "inset(0px 0px 0px 75%)"


def test_another_fit_and_the_difference_are_shown(tab, rendering):
    import matplotlib as mpl

    assert tab.locator(".tag.right").inner_text() == "ward"
    choose(tab, "fit", 2)
    assert tab.locator(".tag.right").inner_text() == "lambert"
    assert np.abs(drawn(tab, 1) - srgb(rendering[2])).max() < 1.5
    choose(tab, "mode", "difference")
    assert tab.locator(".tag.right").inner_text() == "ΔE of lambert"
    difference = bk.rendering.montage.ciede2000(rendering[0], rendering[2])
    expected = 255 * mpl.colormaps["magma"](difference / pixels.BRIGHT_DIFFERENCE)[..., :3]
    assert np.abs(drawn(tab, 1) - expected).max() < 10  # a step of ΔE is some steps of the scale
    assert tab.locator(".viewer .scale").is_visible()


def test_the_pictures_take_turns_and_stand_side_by_side(tab):
    choose(tab, "mode", "flicker")
    tab.wait_for_function("document.querySelector('.tag.right').textContent === 'measured'")
    assert tab.locator(".over").evaluate("e => getComputedStyle(e).visibility") == "hidden"
    tab.wait_for_function("document.querySelector('.tag.right').textContent === 'ward'")
    choose(tab, "mode", "beside")
    left, right = (pane.bounding_box() for pane in tab.locator(".pane").all())
    assert right["x"] >= left["x"] + left["width"]
    assert abs(left["width"] - right["width"]) < 1


def test_the_readout_says_what_is_under_the_pointer(tab, rendering):
    x, y = 20, 17
    box = tab.locator(".pane").first.bounding_box()
    step = box["width"] / SIZE
    tab.mouse.move(box["x"] + (x + 0.5) * step, box["y"] + (y + 0.5) * step)

    def read():
        rows = tab.locator(".readout tbody tr").all()
        return [[float(t) for t in row.locator("td").all_inner_texts()] for row in rows[:3]]

    def expected(x, y):
        first, second = rendering[0][y, x], rendering[1][y, x]
        return [first, second, second / first]

    assert tab.locator(".readout .place").inner_text() == f"{x}, {y}"
    np.testing.assert_allclose(read(), expected(x, y), rtol=0.012)
    said = float(tab.locator(".delta").inner_text().removeprefix("ΔE "))
    difference = bk.rendering.montage.ciede2000(rendering[0][y, x], rendering[1][y, x])
    assert abs(said - difference) < 0.3
    tab.locator(".pane").first.focus()
    tab.keyboard.press("ArrowDown")
    tab.keyboard.press("Shift+ArrowLeft")
    assert tab.locator(".readout .place").inner_text() == f"{x - 10}, {y + 1}"
    np.testing.assert_allclose(read(), expected(x - 10, y + 1), rtol=0.012)


def test_both_pictures_zoom_and_scroll_in_step(tab):
    choose(tab, "mode", "beside")
    choose(tab, "zoom", 4)
    panes = tab.locator(".pane")
    wide, seen = panes.nth(1).evaluate("e => [e.scrollWidth, e.clientWidth]")
    assert abs(wide - 4 * seen) <= 4
    panes.nth(0).evaluate("e => { e.scrollLeft = 120; e.scrollTop = 77; }")
    tab.wait_for_function("document.querySelector('.over').scrollTop === 77")
    assert panes.nth(1).evaluate("e => e.scrollLeft") == 120


@pytest.mark.parametrize("width", [360, 1200])
def test_light_and_dark_screens_and_telephones(show, written, width):
    tab = show(written[0], viewport={"width": width, "height": 800})
    brightness = []
    for scheme in ("light", "dark"):
        tab.emulate_media(color_scheme=scheme)
        assert tab.evaluate("document.documentElement.scrollWidth") <= width
        seen = opened(tab.screenshot())
        assert seen.std() > 20
        brightness.append(np.median(seen))
    assert brightness[0] > 200
    assert brightness[1] < 60


def test_its_own_policy_lets_it_work(show, written):
    tab = show(written[0])
    tab.locator("input[name=exposure]").fill("2")
    assert tab.locator("output[name=stops]").inner_text() == "+2 stops"
    tab.locator("summary").first.click()
    tab.locator("details .copy").first.click()
    tab.get_by_text(re.compile("^(Copied|Selected)$")).wait_for()


def test_without_scripts_the_pictures_and_words_are_there(show, written):
    tab = show(written[0], java_script_enabled=False)
    assert tab.locator("noscript").inner_text().startswith("Scripts are switched off")
    assert not tab.locator(".viewer").is_visible()
    assert all(image.is_visible() for image in tab.locator(".sheet img").all())
    assert tab.locator(".chart").count() == 4 + 5


def test_paper_has_the_pictures_and_no_controls(tab):
    tab.emulate_media(media="print")
    assert not tab.locator(".controls").is_visible()
    assert not tab.locator("label.wipe").is_visible()
    assert tab.locator(".stage canvas").first.is_visible()
    assert tab.pdf().startswith(b"%PDF")


def test_the_gallery_sorts_by_names_and_by_numbers(show, reports):
    tab = show(reports[0] / "index.html")

    def column(number):
        return [row.locator("td").nth(number).inner_text() for row in tab.locator("tbody tr").all()]

    head = tab.locator("thead th")
    assert column(1) == ["second paint", "paint"]
    head.nth(1).locator("button").press("Enter")
    assert column(1) == ["paint", "second paint"]
    assert head.nth(1).get_attribute("aria-sort") == "ascending"
    for turned in (False, True):
        head.nth(4).locator("button").click()
        errors = [float(text) for text in column(4)]
        assert errors == sorted(errors, reverse=turned)
    tab.locator("tbody a").first.click()
    tab.locator(".viewer").wait_for()


def test_few_samples_in_many_bands_have_a_report(here):
    """Four samples, each in a band of incidences of its own."""
    theta = np.array([20.0, 30, 50, 70])
    few = bk.Measured.from_angles(theta, 0, theta[::-1], 180, theta / 100, name="few")
    path = bk.report(few, ["lambert"], path="few.html", spp=SPP, size=16)
    assert "Half of the measured values are met within" in Page(path).text


def test_what_cannot_be_compared_is_refused_in_a_sentence(here):
    dark = bk.Measured.from_table(np.full((9, 9, 18, 3), -0.1), name="dark")
    with pytest.raises(bk.BrdfkitError, match="dark: no measured value is above 0"):
        bk.report(dark, ["lambert"], path="dark.html", spp=SPP, size=16)
    with pytest.raises(bk.BrdfkitError, match="spp = 0 should be"):
        bk.report("plaster", ["lambert"], path="none.html", spp=0)
    assert not list(here.glob("*.html"))


def test_unknown_errors_are_not_taken_for_figures():
    broken = psnr_and_delta((np.nan,), 30.0, np.nan, 1.0)
    assert broken["psnr"].best_index is None
    assert "not finite" in describe_visibility(broken)
    half_known = PictureError(METRICS["psnr"], (np.nan, 20.0), 30.0)
    assert half_known.best_index == 1
    # after Ctrl-C in the second pass the noise is not known
    assert "noise" not in describe_visibility(psnr_and_delta((30.0,), np.nan, 0.5, np.nan))
    assert describe_visibility(psnr_and_delta((30.0,), np.nan, 0.5, np.nan)).startswith(
        "its picture cannot"
    )
