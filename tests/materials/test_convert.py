"""`brdfkit convert` and the writers: what is lost is told, and nothing is half-written."""

import io
import json
import re
from dataclasses import replace

import numpy as np
import pytest
from click.testing import CliRunner
from small_files import (
    FEW_ALL_AROUND,
    FEW_NODES,
    FILES,
    MATERIALS,
    brushed,
    fit,
    place,
    spectrum,
    table,
    written,
)

import brdfkit as bk
from brdfkit.cli import main
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.geometry.directions import from_angles
from brdfkit.materials.converting import convert
from brdfkit.materials.evaluating import albedo
from brdfkit.materials.formats import HEAD, list_formats
from brdfkit.materials.formats.rgl import encoding
from brdfkit.materials.loading import load, save
from brdfkit.materials.measured import Measured

pytestmark = pytest.mark.usefixtures("small_tables")
WRITERS = {m.__name__.rpartition(".")[2]: m for m in list_formats() if hasattr(m, "write")}


@pytest.fixture
def small_tables(monkeypatch):
    """RGL files of few nodes, written at once."""
    monkeypatch.setattr(encoding, "ISOTROPIC", FEW_NODES)
    monkeypatch.setattr(encoding, "ANISOTROPIC", FEW_ALL_AROUND)


def run(*words):
    return CliRunner().invoke(main, ["convert", *map(str, words)])


# -- every writer -----------------------------------------------------------------------------


def test_every_format_has_a_small_file():
    """Else nothing would fuzz it: add it to FILES in small_files.py."""
    recognised = [kind.partition(",")[0] for kind in {**FILES, **written()}]
    missing = {m.__name__.rpartition(".")[2] for m in list_formats()} - set(recognised)
    assert not missing


@pytest.mark.parametrize("kind", {**FILES, **written()})
def test_one_format_recognises_a_file_or_its_suffix_decides(kind):
    name, data = {**FILES, **written()}[kind]
    sniffed = [module for module in list_formats() if module.sniff(data[:HEAD])]
    named = [m for m in list_formats() if any(name.endswith(s) for s in m.SUFFIXES)]
    assert len(sniffed or named) == 1
    assert (sniffed or named)[0] in named


@pytest.mark.parametrize("kind", written())
def test_what_is_written_is_read_and_written_again(tmp_path, kind):
    name, data = written()[kind]
    (tmp_path / name).write_bytes(data)
    save(load(tmp_path / name), tmp_path / f"again {name}")
    load(tmp_path / f"again {name}")
    if kind.partition(",")[0] in ("fit_json", "merl", "npz", "utia"):  # no directions to convert
        assert (tmp_path / f"again {name}").read_bytes() == data


@pytest.mark.parametrize("failure", [KeyboardInterrupt, MemoryError, OSError, BrdfkitError])
@pytest.mark.parametrize("kind", WRITERS)
def test_a_writer_that_fails_leaves_nothing_new(tmp_path, monkeypatch, kind, failure):
    module = WRITERS[kind]
    material = next(make() for make in MATERIALS.values() if writes(module, make()))
    path = tmp_path / f"paint{module.SUFFIXES[0]}"
    path.write_bytes(b"old")

    class Broken:
        def __init__(self, stream):
            self.stream, self.room = stream, 100

        def write(self, data):
            self.stream.write(data[: self.room])
            self.room -= len(data)
            if self.room < 0:
                raise failure("stop")

    write = module.write
    monkeypatch.setattr(module, "write", lambda obj, stream: write(obj, Broken(stream)))
    expected = BrdfkitError if failure is OSError else failure
    with pytest.raises(expected):
        save(material, path)
    assert [p.name for p in tmp_path.iterdir()] == [path.name]
    assert path.read_bytes() == b"old"


def writes(module, obj):
    try:
        module.write(obj, io.BytesIO())
    except BrdfkitError:
        return False
    return True


@pytest.mark.parametrize("kind", WRITERS)
def test_a_writer_refuses_in_one_sentence(tmp_path, kind):
    module = WRITERS[kind]
    path = tmp_path / f"paint{module.SUFFIXES[0]}"
    for obj in (table(), brushed(), fit(), {}):
        if writes(module, obj):
            continue
        with pytest.raises(BrdfkitError, match=rf"^{path}: [^\n]*\.$"):
            save(obj, path)
    assert not any(tmp_path.iterdir())


@pytest.mark.parametrize("name", ["Lack, grün", "漆", "caf\udce9"])  # the last: latin-1 on disk
@pytest.mark.parametrize("suffix", [".brdf", ".astm", ".csv", ".dat", ".npz", ".bsdf"])
def test_any_name_can_be_written(tmp_path, suffix, name):
    material = replace(spectrum(), name=name)
    save(material, tmp_path / f"it{suffix}")
    assert len(load(tmp_path / f"it{suffix}").values)
    if suffix != ".npz":
        told = name.encode(errors="replace")
        assert told in (tmp_path / f"it{suffix}").read_bytes()


@pytest.mark.parametrize("suffix", [".brdf", ".astm", ".csv", ".tsv"])
def test_text_keeps_every_digit(tmp_path, suffix):
    material = spectrum()
    save(material, tmp_path / f"paint{suffix}")
    back, valid = load(tmp_path / f"paint{suffix}"), material.samples.valid
    assert back.channels == material.channels
    np.testing.assert_array_equal(back.values, material.values[valid])
    np.testing.assert_allclose(back.samples.wi, material.samples.wi[valid], atol=1e-15)
    np.testing.assert_allclose(back.samples.wo, material.samples.wo[valid], atol=1e-15)


def times_cosine(wi, wo):
    """f cosθ_o = 0.1 for every pair, as an RGL file may store it: its f has no bound."""
    return 0.1 / wo[:, 2:] * [1, 0.5, 0]


def test_merl_has_the_albedo_of_a_lookup_to_the_horizon(tmp_path):
    wi, wo = from_angles(np.radians([[10], [40]]), 0.0)
    material = Measured.from_samples(wi, wo, times_cosine(wi, wo), lookup=times_cosine)
    save(material, tmp_path / "paint.binary")
    back = load(tmp_path / "paint.binary")
    assert np.nanmax(back.table.values) < 0.1 / np.cos(np.radians(88.4))
    for theta in (85, 88, 89.9):
        w = from_angles(np.radians(theta), 0.3)
        # wo below wi has the value of the exchanged pair: f cosθ_o falls to 0 there
        expected = 0.2 * np.pi * (1 - np.cos(np.radians(theta)) / 2)
        assert albedo(back, w) == pytest.approx([expected, expected / 2, 0], rel=0.03)
    wi, wo = from_angles(np.radians([[80, 10, 50], [20, 75, 50]]), [0, 1, 3])
    np.testing.assert_allclose(back.eval(wi, wo), back.eval(wo, wi), rtol=1e-9)


@pytest.mark.parametrize("name", ["acrylic_felt_green", "paper_white"])
def test_merl_of_an_rgl_file(tmp_path, measured_data, name):
    material = load(measured_data / "rgl" / f"{name}_rgb.bsdf")
    save(material, tmp_path / "it.binary")
    back = load(tmp_path / "it.binary")
    for theta in (85, 88, 89.5):
        w = from_angles(np.radians(theta), 0.3)
        assert albedo(back, w) == pytest.approx(albedo(material, w), rel=0.03)


def named(*channels):
    """Samples with these channels."""
    n = len(channels)
    return replace(spectrum(), channels=channels, standard_error=None).mix_channels(
        np.ones((3, n)), channels
    )


UNREADABLE = [
    (".astm", ("A", "B", "C"), "holds R,G,B or wavelengths .* and paint has the channels A B C"),
    (".astm", ("R", "R", "B"), "holds R,G,B or wavelengths"),
    (".astm", ("450nm", "550nm", "450nm"), "holds R,G,B or wavelengths"),
    (".astm", ("theta_i",), "holds R,G,B or wavelengths"),
    (".astm", ("a,b",), "holds R,G,B or wavelengths"),
    (".astm", ("a b",), "holds R,G,B or wavelengths"),
    (".astm", ("",), "holds R,G,B or wavelengths"),
    (".csv", ("A", "B", "C"), "holds R, G, B, or wavelengths .* and paint has the channels A B C"),
    (".csv", ("450nm", "550nm", "450nm"), "holds R, G, B, or wavelengths"),
    (".csv", ("Y", "Y_error"), "holds R, G, B, or wavelengths"),
    (".tsv", ("1nm", "550nm"), "the format TSV holds .* of 100 to 100,000 nm"),
    (".brdf", ("450nm", "550nm", "450nm"), "each once"),
    (".brdf", ("1nm", "550nm", "600nm"), "of 100 to 100,000 nm"),
    (".bsdf", ("450nm", "550nm", "450nm"), "repeat or are not above 0 nm"),
    (".bsdf", ("0nm", "550nm"), "repeat or are not above 0 nm"),
]


@pytest.mark.parametrize(("suffix", "channels", "match"), UNREADABLE)
def test_channels_that_could_not_be_read_again(tmp_path, suffix, channels, match):
    path = tmp_path / f"paint{suffix}"
    for write in (save, lambda obj, path: convert(obj, path)):
        with pytest.raises(BrdfkitError, match=rf"^{path}: .*{match}.*\.$"):
            write(named(*channels), path)
    assert not any(tmp_path.iterdir())


@pytest.mark.parametrize("channels", [("B", "G", "R"), ("Y",), ("450nm",), ("450nm", "550.5nm")])
def test_channels_that_astm_knows(tmp_path, channels):
    save(named(*channels), tmp_path / "paint.astm")
    assert set(load(tmp_path / "paint.astm").channels) == set(channels)


def test_convert_writes_nothing_that_cannot_be_read_again(tmp_path, monkeypatch):
    write = WRITERS["astm"].write
    monkeypatch.setattr(
        WRITERS["astm"], "write", lambda obj, stream: [write(obj, stream), stream.write(b"dark\n")]
    )
    path = tmp_path / "paint.astm.gz"
    path.write_bytes(b"old")
    with pytest.raises(BrdfkitError) as caught:
        convert(spectrum(), path)
    assert re.fullmatch(
        rf"{path}: the file could not be read again \(NUM_POINTS announces .*\)\.",
        str(caught.value),
    )
    assert [p.name for p in tmp_path.iterdir()] == ["paint.astm.gz"]
    assert path.read_bytes() == b"old"


def test_errors_that_are_not_known_do_not_mask_the_values(tmp_path):
    material = spectrum()
    errors = np.full_like(material.values, np.nan)
    done = convert(replace(material, standard_error=errors), tmp_path / "paint.dat")
    assert len(load(done.path).values) == material.samples.valid.sum()


# -- what is lost -----------------------------------------------------------------------------


def test_nothing_lost(tmp_path):
    for make in (table, spectrum):
        assert str(convert(make(), tmp_path / "paint.npz")).endswith("paint.npz (nothing lost)")


def test_what_is_lost_is_told(tmp_path):
    told = convert(spectrum(), tmp_path / "paint.astm").changes
    assert re.fullmatch(
        r"valid 11 of 12 → 11 of 11; standard error 0\.\d+ sr⁻¹ in the median → none",
        "; ".join(told),
    )
    told = "; ".join(convert(spectrum(), tmp_path / "paint.dat").changes)
    assert "channels 450nm 550nm 650nm → R G B" in told
    told = "; ".join(convert(table(), tmp_path / "paint.dat").changes)
    assert "kind 3×2×4 table → samples" in told
    assert "without note" in told
    told = "; ".join(convert(spectrum(), tmp_path / "paint.bin").changes)
    assert "kind samples → anisotropic samples" in told
    assert "valid 11 of 12 → 82,944 of 82,944" in told
    assert "negative 3.03% of the values → 0.00% of the values" in told


def test_what_is_extrapolated_is_told(tmp_path):
    """Of a model that was sampled below 40°, in a file of all angles."""
    ggx = bk.models()["ggx"](alpha_u=0.2)
    theta, phi = np.radians(np.random.default_rng(0).uniform(0, [[[40]], [[360]]], (2, 2, 60)))
    wi, wo = from_angles(theta, phi)
    few = Measured.from_samples(wi, wo, ggx.eval(wi, wo) * np.ones(3))
    told = convert(few, tmp_path / "paint.bsdf").changes[0]
    number = r"\d+%"
    assert re.match(f"{number} of the new samples are extrapolated and {number} interpolated", told)
    assert re.search(r"; the maximum rises from [\d.]+ to [\d.]+ sr⁻¹$", told)
    assert not convert(few, tmp_path / "paint.npz").changes
    assert not any("extrapolated" in c for c in convert(ggx, tmp_path / "ggx.bsdf").changes)


def waves(wi, wo):
    """A lookup too wild for a table."""
    return (1.1 + np.sin(60 * wi[:, 2:]) * np.sin(60 * wo[:, 2:])) * [1, 1, 1]


def test_another_interpolation_is_told(tmp_path):
    wi, wo = from_angles(np.radians([[10], [40]]), 0.0)
    material = Measured.from_samples(wi, wo, waves(wi, wo), lookup=waves)
    (told,) = convert(material, tmp_path / "paint.npz").changes
    number = r"(\d+\.\d)%"
    median, most = re.fullmatch(
        f"between the samples: {number} in the median, 95 of 100 within {number}", told
    ).groups()
    back = load(tmp_path / "paint.npz")
    theta, phi = np.radians(np.random.default_rng(9).uniform(0, [[[80]], [[360]]], (2, 2, 2000)))
    pairs = from_angles(theta, phi)
    apart = 1 - np.minimum(*(values := [waves(*pairs), back.eval(*pairs)])) / np.maximum(*values)
    # shares of 4,000 and of 2,000 pairs: at the quantiles 50 % and 95 %, 4.5 standard deviations
    for said, share in ((median, 0.5), (most, 0.95)):
        bound = 4.5 * np.sqrt(share * (1 - share) * (1 / 4000 + 1 / 2000))
        low, high = np.quantile(apart, np.clip([share - bound, share + bound], 0, 1))
        assert low - 5e-4 <= float(said) / 100 <= high + 5e-4


def test_a_model_is_evaluated(tmp_path):
    ward = bk.models()["ward"](alpha_u=0.2, specular_reflectance=0.3)
    done = convert(ward, tmp_path / "ward.npz")
    assert done.changes == (
        "ward evaluated at 274,142 direction pairs",
        "between the samples: 0.0% in the median, 95 of 100 within 0.2%",
    )
    back = load(tmp_path / "ward.npz")
    assert not back.anisotropic
    np.testing.assert_allclose(back.values, ward.eval(back.samples.wi, back.samples.wo), rtol=1e-9)


def test_an_anisotropic_model_stays_anisotropic(tmp_path):
    ward = bk.models()["ward"](alpha_u=0.2, alpha_v=0.4)
    convert(ward, tmp_path / "ward.bin")  # on UTIA's grid, without a table in between
    back = load(tmp_path / "ward.bin")
    expected = ward.eval(back.samples.wi, back.samples.wo)
    np.testing.assert_allclose(back.values, np.tile(expected, 3), rtol=1e-12)
    with pytest.raises(BrdfkitError, match="isotropic materials, and ward is anisotropic"):
        convert(ward, tmp_path / "ward.binary")


# -- the command ------------------------------------------------------------------------------


def test_command(tmp_path):
    path = place(tmp_path, "cornell")
    done = run(path, tmp_path / "paint.npz")
    assert done.exit_code == 0
    assert done.output == f"written: {tmp_path}/paint.npz (nothing lost)\n"
    done = run(path, tmp_path / "paint.dat", "--json")
    told = json.loads(done.output)
    assert told["written"] == f"{tmp_path}/paint.dat"
    assert "channels 450nm 550nm 650nm → R G B" in told["changes"]
    assert run(path, tmp_path / "paint.dat", "--quiet").output == ""


def test_command_takes_models_with_parameters(tmp_path):
    done = run("lambert", tmp_path / "grey.bin", "-p", "diffuse_reflectance=0.314159265")
    assert done.exit_code == 0, done.output
    np.testing.assert_allclose(load(tmp_path / "grey.bin").values, 0.1, rtol=1e-6)


@pytest.mark.parametrize(
    ("source", "target", "match"),
    [
        ("paint.brdf", "paint.brdf", "is a file to read; name another to write"),
        ("abrdf.dat#4", "abrdf.dat", "is a file to read"),
        ("paint.brdf", "none/paint.npz", "there is no folder"),
        ("paint.brdf", "paint.jpg", "no format with this suffix; written are ALTA"),
        ("paint.brdf", "paint.json", "holds a fit, not a Measured"),
        ("none.brdf", "paint.npz", "no such file"),
        ("lambert", "grey.brdf", "lambert has the channels Y; choose another suffix"),
    ],
)
def test_command_refuses(tmp_path, source, target, match):
    place(tmp_path, "cornell")
    place(tmp_path, "curet")
    before = {p.name: p.read_bytes() for p in tmp_path.iterdir()}
    source = source if source == "lambert" else tmp_path / source
    done = run(source, tmp_path / target)
    assert done.exit_code == 2
    assert re.search(match, done.output)
    assert done.output.startswith("brdfkit: ")
    assert done.output.count("\n") == 1
    assert {p.name: p.read_bytes() for p in tmp_path.iterdir()} == before
