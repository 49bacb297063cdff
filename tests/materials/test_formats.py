"""Formats × traps: what is read, and the sentence where it cannot be."""

import gzip
import json
import lzma
import os
import tempfile
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from small_files import (
    FILES,
    MERL_SHAPE,
    assert_same,
    astm,
    cornell,
    csv,
    curet,
    curet_table,
    merl,
    mini_diff,
    place,
)

import brdfkit as bk
from brdfkit.core import files
from brdfkit.core.colours import RGB, import_colour_package
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.geometry.directions import from_angles
from brdfkit.materials.formats import list_formats
from brdfkit.materials.loading import load, save
from brdfkit.materials.measured import Measured

PACKED = {"": bytes, ".gz": gzip.compress, ".xz": lzma.compress}


def refused(path, match):
    """Assert that loading `path` gives one sentence that names the file and matches."""
    with pytest.raises(BrdfkitError, match=match) as caught:
        load(path)
    message = str(caught.value)
    assert Path(path).name.partition("#")[0].split(".")[0] in message
    assert message.endswith(".")
    assert "\n" not in message
    assert len(message) < len(str(path)) + 250


# -- every format ---------------------------------------------------------------------------


@pytest.mark.quick
@pytest.mark.parametrize("suffix", PACKED)
@pytest.mark.parametrize("kind", FILES)
def test_reads_plain_and_compressed(tmp_path, kind, suffix):
    name, content = FILES[kind]
    plain = load(place(tmp_path, kind))
    packed = load(str(place(tmp_path, kind, PACKED[suffix](content), name + suffix)))
    assert_same(plain.samples, packed.samples)
    assert packed.name == plain.name == ("CUReT 1" if kind == "curet" else name.split(".")[0])
    assert packed.info["format"]


@pytest.mark.quick
@pytest.mark.parametrize("kind", sorted(FILES.keys() - {"utia"}))  # it has no header
def test_content_decides_and_not_the_suffix(tmp_path, kind):
    right, wrong = place(tmp_path, kind), place(tmp_path, kind, name="misnamed.binary")
    assert_same(load(right).samples, load(wrong).samples)


def replaced(content, old, new):
    assert old in content
    return content.replace(old, new, 1)


TRAPS = {
    "merl": {
        "cut short": (merl()[:-1], r"cut short: 587 bytes .* asks for 588"),
        "header only": (merl()[:12], "cut short: 12 bytes"),
        "half a header": (merl()[:7], "has 7 bytes"),
        "too long": (merl() + b"\0", "too long: 589 bytes"),
        "other size": (merl((3, 2, 5))[:12] + merl()[12:], "cut short"),
        "no cells": (merl((0, 2, 4)), r"0×2×4 cells where 1 to 4096"),
        "negative": (merl((-90, 90, 180), []), "-90×90×180"),
        "huge": (merl((4096, 4096, 4096), []), "asks for 1,649,267,441,676"),
        "beyond": (merl((4097, 1, 1), []), "4097×1×1"),
        "big-endian": (merl(order=">"), r"big-endian \(its header reads 3×2×4"),
        "text": (b"theta_h theta_d phi_d\n90 90 180\n", "check that it is a MERL table"),
        "not a number": (merl(raw=[1.0] * 5 + [np.nan, np.inf] + [1] * 65), r"2 values .* byte 52"),
        "all invalid": (merl(raw=[-1.0] * 72), "every cell"),
    },
    "cornell": {
        "cut short": (cornell()[:-20], r"line 16 has 5 columns where 7 belong"),
        "too long": (cornell()[:-2] + b" 1.0\r\n", "line 16 has 8 columns"),
        "no rows": (cornell()[:95], "no rows"),
        "comments only": (b"# A paint\n", "comments only"),
        "other count": (replaced(cornell(), b"\n3", b"\n4"), "announces 4 .* list 10"),
        "no count": (replaced(cornell(), b"\n3", b"\n3.5"), "line 4 has '3.5'"),
        "twice": (replaced(cornell(), b"450", b"550"), "repeat or are not in nm"),
        "text": (replaced(cornell(), b"0.500000", b"0.5oo"), r"line 11 has '0.5oo'"),
        "underscore": (replaced(cornell(), b"0.500000", b"0_5"), r"line 11 has '0_5'"),
        "degrees": (replaced(cornell(), b"0.500000", b"45.0"), r"line 11 .* 45 .* radians"),
        "not a number": (replaced(cornell(), b"0.500000", b"nan"), "line 11 has the angle nan"),
    },
    "astm": {
        "cut short": (astm()[:-8], "line 10 has 6 columns where 7 belong"),
        "a row short": (b"\n".join(astm().split(b"\n")[:-2]), "announces 3 rows, but 2"),
        "too long": (astm() + b"1,0,1,0,1,1,1\n", "announces 3 rows, but 4"),
        "no rows": (astm()[: astm().index(b"\n0.5")], "no rows"),
        "no VARS": (replaced(astm(), b"VARS", b"RAVS"), "no line VARS"),
        "no theta_s": (astm("theta_i,phi_i,phi_s,R,G,B"), "line 6 names the columns"),
        "twice": (astm("theta_i,phi_i,theta_s,phi_s,R,R,B"), "each once"),
        "strange": (astm("theta_i,phi_i,theta_s,phi_s,X,Y,Z"), "line 6 names the channels X, Y, Z"),
        "one more": (astm("theta_i,phi_i,theta_s,phi_s,R,G,B,A"), "line 8 has 7 columns where 8"),
        "text": (replaced(astm(), b"-0.01", b"dark"), "line 9 has 'dark'"),
        "degrees": (replaced(astm(), b"\n0.5", b"\n30"), "line 8 .* angle 30"),
        "infinite": (replaced(astm(), b"\n0.5", b"\ninf"), "line 8 has the angle inf"),
    },
    "mini_diff": {
        "cut short": (mini_diff()[:-12], "columns where 7"),
        "too long": (mini_diff() + b"1,3,1,0,1,1,1\n", "announces 3 rows, but 4"),
        "all masked": (
            mini_diff().replace(b",0.5,0,", b",1.5,0,").replace(b",1.3089969389957472,", b",1.5,"),
            "no row is a valid",
        ),
    },
    "csv": {
        "cut short": (csv()[:-24], "line 6 has 6 columns where 8 belong"),
        "no rows": (b"\n".join(csv().split(b"\n")[:3]), "has no rows behind the names"),
        "no names": (b"30,0,30,180,0.5\n", "line 1 has numbers where the names of the columns"),
        "comments only": (b"# theta_i\n", "it has no line where the names"),
        "text": (replaced(csv(), b"0,25", b"dark"), "line 5 has 'dark' where a number"),
        "thousands": (
            replaced(csv(), b"0,25", b"1.000,25"),
            "line 4 has a comma and line 5 a point",
        ),
        "column": (
            replaced(csv(), b"theta_o", b"theta_x"),
            "column 'theta_x .* did you mean theta_o",
        ),
        "twice": (replaced(csv(), b"550nm;", b"450;"), "column '450' comes twice"),
        "unit": (replaced(csv(), b"[deg]", b"[mrad]"), "'theta_i .* has the unit 'mrad'"),
        "no azimuth": (replaced(csv(), b"delta_phi [deg]", b"phi_o"), "lacks the columns phi_i"),
        "below": (replaced(csv(), b"-10,5", b"95"), "theta_o is 95° in line 5, which is below"),
        "no angle": (replaced(csv(), b"-10,5", b""), "theta_o is nan in line 5; give a number"),
        "negative error": (replaced(csv(), b"0,02", b"-1"), "error is -1 in line 4; it should be"),
        "anisotropic": (b"# anisotropic: 1\n" + csv(), "says 'anisotropic: 1', where yes or no"),
        "nothing": (
            csv().replace(b"0,5", b"").replace(b"3,0", b"").replace(b"0,25", b""),
            "all fields of 450nm are empty; fill in what was measured",
        ),
    },
    "curet": {
        "cut short": (curet()[:-200], "line 61 has .* columns where 206"),
        "a row short": (curet(60), "60 rows where 61"),
        "too long": (curet(62), "62 rows where 61"),
        "narrow": (curet(geometries=204), "line 1 has 205 columns where 206"),
        "text": (replaced(curet(), b"7.003", b"seven"), "line 7 has 'seven'"),
        "swapped": (replaced(curet(), b"\n7 ", b"\n9 "), "numbered from 1"),
    },
}
CASES = [(kind, trap) for kind, traps in TRAPS.items() for trap in traps]


@pytest.mark.quick
@pytest.mark.parametrize(("kind", "trap"), CASES)
def test_traps(tmp_path, kind, trap):
    data, match = TRAPS[kind][trap]
    refused(place(tmp_path, kind, data), match)


@pytest.mark.quick
@pytest.mark.parametrize("kind", FILES)
def test_empty_and_blank(tmp_path, kind):
    refused(place(tmp_path, kind, b""), "is empty; fetch")
    refused(place(tmp_path, kind, b"\n" * 5), "fetch|header|belong|VARS|#DIM")


@pytest.mark.quick
@pytest.mark.parametrize("suffix", [".gz", ".xz"])
@pytest.mark.parametrize("kind", FILES)
def test_damaged_compression(tmp_path, kind, suffix):
    name, content = FILES[kind]
    packed = PACKED[suffix](content)
    flipped = bytearray(packed)
    flipped[len(packed) // 2] ^= 0xFF
    for data in (packed[:-9], packed[: len(packed) // 2], bytes(flipped), content):
        refused(place(tmp_path, kind, data, name + suffix), "damaged or cut short")
    refused(place(tmp_path, kind, PACKED[suffix](b""), name + suffix), "is empty")


@pytest.mark.quick
@pytest.mark.parametrize("kind", ["cornell", "astm", "mini_diff"])
def test_value_that_is_not_finite_is_masked(tmp_path, kind):
    data = FILES[kind][1].replace(b"0.25", b" nan ", 1).replace(b" nan 0000", b" nan", 1)
    material = load(place(tmp_path, kind, data))
    assert np.isnan(material.values[~material.samples.valid]).any()
    assert np.isfinite(material.values[material.samples.valid]).all()
    assert material.info["not finite"].startswith("1 of")


# -- MERL -----------------------------------------------------------------------------------


@pytest.mark.quick
def test_merl_scale_order_and_negative_before_scaling(tmp_path):
    raw = 1500.0 + np.arange(72).reshape(3, *MERL_SHAPE)
    raw[1, 2, 1, 3] = -1e-9  # one channel of one cell: measured in none
    material = load(place(tmp_path, "merl", merl(raw=raw)))
    values = material.table.values
    np.testing.assert_allclose(
        values[1, 0, 2], raw[:, 1, 0, 2] * [1 / 1500, 1.15 / 1500, 1.66 / 1500]
    )
    unknown = np.isnan(values)
    assert unknown[2, 1, 3].all()
    assert unknown.sum() == 3
    assert material.channels == RGB
    assert material.info["cells without a value"] == "1 of 24"
    assert material.table.phi_d_period == pytest.approx(np.pi)


@pytest.mark.quick
def test_merl_full_circle(tmp_path):
    assert load(place(tmp_path, "merl", merl((3, 2, 8)))).table.phi_d_period == 2 * np.pi


@pytest.mark.quick
def test_merl_theta_h_is_square_root_spaced(tmp_path):
    """θh = 22.5° is a quarter of the right angle and so the border of bin 45 of 90."""
    raw = np.broadcast_to(np.arange(90.0)[:, None, None], (3, 90, 1, 2)) * 1500
    material = load(place(tmp_path, "merl", merl((90, 1, 2), raw)))
    w = from_angles(np.radians([22.5]), np.array([0.0]))  # wi = wo = h
    assert material.eval(w, w)[0, 0] == pytest.approx(44.5)  # half-way between two centres
    lower, upper = np.degrees(material.table.centres[0][[44, 45]])
    assert lower < 22.5 < upper
    assert upper == pytest.approx(90 * (45.5 / 90) ** 2)


tables = st.tuples(*[st.integers(1, 5)] * 3, st.integers(0, 2**32 - 1), st.floats(0, 0.9))


@given(tables)
@settings(deadline=None, max_examples=60)
def test_merl_round_trip(drawn):
    *shape, seed, share = drawn
    random = np.random.default_rng(seed)
    values = np.exp(random.normal(0, 4, (*shape, 3)))
    values[random.uniform(size=shape) < share] = np.nan
    values.flat[:3] = 0, 1, 2  # one cell stays valid
    period = 2 * np.pi if shape[2] == 4 * shape[1] else np.pi
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "table.binary"
        save(Measured.from_table(values, phi_d_period=period), path)
        back = load(path)
    np.testing.assert_array_max_ulp(
        back.table.values[values == values], values[values == values], 2
    )
    np.testing.assert_array_equal(np.isnan(back.table.values), np.isnan(values))
    assert back.table.phi_d_period == period


@pytest.mark.quick
def test_merl_writes_achromatic_negative_and_unknown(tmp_path):
    values = np.full((2, 2, 4, 1), 0.5)
    values[0, 0, 0], values[1, 1, 1] = np.nan, -0.1
    save(Measured.from_table(values, channels=("Y",)), tmp_path / "grey.binary")
    back = load(tmp_path / "grey.binary").table.values
    assert np.isnan(back[0, 0, 0]).all()
    np.testing.assert_array_equal(back[1, 1, 1], 0)
    np.testing.assert_allclose(back[0, 1, 0], 0.5, rtol=1e-15)
    stored = np.frombuffer((tmp_path / "grey.binary").read_bytes(), "<f8", 1, offset=12)
    assert stored == -1


@pytest.mark.quick
def test_merl_refuses_what_it_cannot_hold(tmp_path):
    flat = Measured.from_table(np.ones((2, 2, 3, 3)), phi_d_period=2 * np.pi)
    for obj, match in ((flat, "cannot say .* resample"), ({}, "not a dict")):
        with pytest.raises(BrdfkitError, match=f"flat.binary: .*{match}"):
            save(obj, tmp_path / "flat.binary")
    assert not any(tmp_path.iterdir())


# -- Cornell and ASTM -----------------------------------------------------------------------


@pytest.mark.quick
def test_cornell(tmp_path):
    material = load(place(tmp_path, "cornell"))
    assert material.channels == ("450nm", "550nm", "650nm")
    assert material.values.shape == (6, 3)
    assert material.info["description"] == "A paint; High-gloss"
    assert material.info["clipped"].startswith("33.3%")
    assert "suspicious" not in material.info
    wi, wo = material.samples.wi[0], material.samples.wo[0]
    np.testing.assert_allclose(wo, wi * [-1, -1, 1], atol=1e-6)  # the mirror direction
    assert material.values[0, 0] == material.values.max()


@pytest.mark.quick
def test_cornell_lone_point_is_noted_and_kept(tmp_path):
    material = load(place(tmp_path, "cornell", cornell(spike=True)))
    assert "33.0 times" in material.info["suspicious"]
    assert material.samples.valid.all()
    assert material.values.max() == 99


@pytest.mark.quick
def test_astm_rgb_keeps_negative_values(tmp_path):
    material = load(place(tmp_path, "astm"))
    assert material.channels == RGB
    np.testing.assert_array_equal(material.values[1], [-0.01, 0.25, 0.5])
    assert material.samples.valid.all()
    assert material.info["SAMPLE_NAME"] == "A paint"
    wi, wo = material.samples.wi[0], material.samples.wo[0]
    np.testing.assert_allclose(wo, wi * [-1, -1, 1], atol=1e-6)


@pytest.mark.quick
def test_astm_mini_diff(tmp_path):
    material = load(place(tmp_path, "mini_diff"))
    assert material.channels == RGB
    np.testing.assert_array_equal(material.values[0], [3, 2, 1])  # blue stands first in the file
    np.testing.assert_array_equal(material.samples.valid, [True, True, False])
    wi, wo = material.samples.wi[0], material.samples.wo[0]
    np.testing.assert_allclose(wo, wi * [-1, -1, 1], atol=1e-12)
    assert "630nm, 525nm, 465nm" in material.info["channels"]
    assert material.info["masked"].startswith("1 rows beyond theta_s = 75°")
    assert "phi_s" in material.info["columns"]


@pytest.mark.quick
@pytest.mark.parametrize(
    ("columns", "channels", "first"),
    [
        ("B,G,R", RGB, (1, 2, 3)),
        ("450nm,550nm,650.5nm", ("450nm", "550nm", "650.5nm"), (3, 2, 1)),
    ],
)
def test_astm_channels_by_name(tmp_path, columns, channels, first):
    data = astm(f"theta_i,phi_i,theta_s,phi_s,{columns}")
    material = load(place(tmp_path, "astm", data))
    assert material.channels == channels
    np.testing.assert_array_equal(material.values[0], first)


@pytest.mark.quick
def test_astm_columns_in_another_order(tmp_path):
    data = b"VARS BRDF, phi_s,theta_s,phi_i,theta_i\n0.3,3.14159265,0.5,0,0.5\n"
    material = load(place(tmp_path, "astm", data))
    assert material.channels == ("Y",)
    np.testing.assert_allclose(material.samples.wo, material.samples.wi * [-1, -1, 1], atol=1e-8)
    assert material.values == 0.3


# -- CUReT ----------------------------------------------------------------------------------


@pytest.mark.quick
def test_curet_viewing_comes_first(tmp_path):
    path = place(tmp_path, "curet")
    material = load(str(path).replace("#1", "#61"))
    assert material.name == "CUReT 61"
    assert material.channels == ("Y",)
    assert "overexposed" in material.info
    np.testing.assert_allclose(material.samples.wi[:, 2], np.cos(1.2))
    np.testing.assert_allclose(material.samples.wo[:, 2], np.cos(0.3))
    np.testing.assert_allclose(material.values[:, 0], 61 + np.arange(205) / 1000)


@pytest.mark.quick
@pytest.mark.parametrize("sample", ["", "#", "#0", "#62", "#x", "#-1", "#1.0", "#" + "9" * 5000])
def test_curet_needs_a_sample(tmp_path, sample):
    path = place(tmp_path, "curet")
    text = str(path).replace("#1", "") + sample
    refused(text, r"name one of 1 to 61.* as in 'abrdf\.dat#1'")


@pytest.mark.quick
def test_curet_needs_its_table(tmp_path):
    path = place(tmp_path, "curet")
    table = tmp_path / "table.txt"
    table.unlink()
    refused(path, "needs table.txt beside it")
    table.with_name("table.txt.gz").write_bytes(gzip.compress(curet_table()))
    assert len(load(path).values) == 205
    table.write_bytes(curet_table(204))
    with pytest.raises(BrdfkitError, match=r"table.txt: has 204 rows where 205"):
        load(path)


# -- paths, limits, writing -----------------------------------------------------------------


@pytest.mark.quick
def test_sample_of_a_file_that_holds_one(tmp_path):
    path = place(tmp_path, "astm")
    refused(f"{path}#2", "leave '#2' off")
    hashed = place(tmp_path, "astm", name="paint#2.astm")
    assert load(hashed).name == "paint#2"


@pytest.mark.quick
def test_paths_that_are_no_file(tmp_path):
    refused(tmp_path, "is a folder")
    refused(tmp_path / "none.binary", "no such file")
    refused(tmp_path / ("x" * 300 + "#1"), "cannot be read|no such file")
    os.mkfifo(tmp_path / "pipe.binary")
    refused(tmp_path / "pipe.binary", "no regular file")


@pytest.mark.quick
def test_unknown_formats_are_told_the_known_ones(tmp_path):
    (tmp_path / "photo.jpg").write_bytes(b"\xff\xd8\xff\xe0 nothing measured")
    refused(tmp_path / "photo.jpg", r"ASTM \(.astm\).*MERL \(.binary\).*each also as .gz or .xz")


@pytest.mark.quick
def test_every_format_module_offers_the_protocol():
    assert {"MERL", "Cornell", "ASTM", "CUReT"} <= {module.NAME for module in list_formats()}
    for module in list_formats():
        assert all(s.startswith(".") and s == s.lower() for s in module.SUFFIXES)
        assert not module.sniff(b"")
        assert callable(module.read)


@pytest.mark.quick
@pytest.mark.parametrize("suffix", PACKED)
def test_oversize_is_refused(tmp_path, monkeypatch, suffix):
    path = place(tmp_path, "merl", PACKED[suffix](merl()), "grey.binary" + suffix)
    monkeypatch.setattr(files, "SIZE_LIMIT", len(merl()))
    load(path)
    monkeypatch.setattr(files, "SIZE_LIMIT", len(merl()) - 1)
    refused(path, "more than 587 bytes")


@pytest.mark.quick
@pytest.mark.parametrize("suffix", PACKED)
def test_saves_what_it_loads(tmp_path, suffix):
    material = load(place(tmp_path, "merl"))
    first, second = tmp_path / f"a.binary{suffix}", tmp_path / f"b.binary{suffix}"
    save(material, str(first))
    save(material, second)
    assert first.read_bytes() == second.read_bytes()
    if suffix == ".gz":
        assert first.read_bytes()[4:8] == bytes(4)  # no time of day
    assert_same(load(first).samples, material.samples)
    assert load(first).name == "a"


@pytest.mark.quick
def test_save_refuses_other_suffixes(tmp_path):
    material = load(place(tmp_path, "merl"))
    for name in ("x.jpg", "x", "x.gz"):
        with pytest.raises(BrdfkitError, match=rf"{name}: no format .* MERL \(.binary\)"):
            save(material, tmp_path / name)
    with pytest.raises(BrdfkitError, match=r"no folder .*; create it"):
        save(material, tmp_path / "none" / "x.binary")
    (tmp_path / "folder.binary").mkdir()
    with pytest.raises(BrdfkitError, match="no regular file"):
        save(material, tmp_path / "folder.binary")


@pytest.mark.quick
@pytest.mark.parametrize("failure", [KeyboardInterrupt, RuntimeError, BrdfkitError])
def test_interrupted_writing_leaves_the_old_file(tmp_path, failure):
    target = tmp_path / "copper.json"
    target.write_text("old")

    def half_written():
        with files.write_safely(target) as beside:
            beside.write_text("half")
            assert beside.suffix == ".json"
            raise failure("stop")

    with pytest.raises(failure):
        half_written()
    assert target.read_text() == "old"
    assert [path.name for path in tmp_path.iterdir()] == ["copper.json"]


@pytest.mark.quick
def test_written_leaves_the_old_content_to_who_reads_it(tmp_path):
    target = tmp_path / "copper.json"
    target.write_text("old")
    with target.open() as reader:
        with files.write_safely(target) as beside:
            beside.write_text("new")
        assert reader.read() == "old"
    assert target.read_text() == "new"


@pytest.mark.quick
def test_written_replaces_and_follows_links(tmp_path):
    (tmp_path / "real").mkdir()
    link = tmp_path / "link.txt"
    link.symlink_to(tmp_path / "real" / "file.txt")
    with files.write_safely(link) as beside:
        beside.write_text("new")
        assert not (tmp_path / "real" / "file.txt").exists()
    assert link.is_symlink()
    assert link.read_text() == "new"


@pytest.mark.quick
def test_links_in_a_circle(tmp_path):
    (tmp_path / "a.txt").symlink_to(tmp_path / "b.txt")
    (tmp_path / "b.txt").symlink_to(tmp_path / "a.txt")
    for path in (tmp_path / "a.txt", tmp_path / "a.txt" / "c.txt"):
        for check in (files.require_writable, lambda path: files.write_safely(path).__enter__()):
            with pytest.raises(
                BrdfkitError, match=rf"{path.name}: (is a link that leads|there is no)"
            ):
                check(path)
    refused(tmp_path / "a.txt", "no such file")


@pytest.mark.quick
def test_disk_that_is_full_is_one_sentence(tmp_path):
    def fill():
        with files.write_safely(tmp_path / "x.txt"):
            raise OSError(28, "No space left on device")

    with pytest.raises(BrdfkitError, match=r"x.txt: cannot be written \(No space left"):
        fill()
    assert not any(tmp_path.iterdir())


@pytest.mark.quick
@pytest.mark.skipif(os.geteuid() == 0, reason="root may write anywhere")
def test_protected_files(tmp_path):
    path = place(tmp_path, "astm")
    path.chmod(0)
    refused(path, "cannot be read .*permissions")
    tmp_path.chmod(0o500)
    with (
        pytest.raises(BrdfkitError, match="cannot be written"),
        files.write_safely(tmp_path / "new.txt"),
    ):
        pass
    tmp_path.chmod(0o700)


# -- arrays ---------------------------------------------------------------------------------


@pytest.mark.quick
@pytest.mark.parametrize("valid", [np.ones(2, bool), np.ones((3, 1), bool), True])
def test_valid_is_one_for_each_sample(valid):
    w = from_angles(np.array([0.1, 0.2, 0.3]), 0.0)
    with pytest.raises(BrdfkitError, match=r"grey: the shape of valid, .* should be \(3,\)"):
        Measured.from_samples(w, w, np.ones((3, 3)), valid=valid, name="grey")


@pytest.mark.quick
@pytest.mark.quick
def test_values_of_one_channel_need_no_second_axis():
    w = from_angles(np.array([0.1, 0.2, 0.3]), 0.0)
    values, errors = np.array([0.2, 0.3, 0.4]), np.array([0.01, 0.02, 0.03])
    material = Measured.from_samples(w, w, values, channels=("Y",), standard_error=errors)
    np.testing.assert_array_equal(material.values, values[:, None])
    np.testing.assert_array_equal(material.standard_error, errors[:, None])
    with pytest.raises(BrdfkitError, match=r"values \(2,\) should be \(n, 1\)"):
        Measured.from_samples(w, w, values[:2], channels=("Y",), name="grey")
    assert Measured.from_samples(w, w, values).channels == ("Y",)
    assert Measured.from_samples(w[:1], w[:1], values).channels == RGB
    with pytest.raises(BrdfkitError, match=r"^grey: values \(3, 2\) have 2 columns; say what"):
        Measured.from_samples(w, w, np.ones((3, 2)), name="grey")


@pytest.mark.quick
def test_what_is_infinite_was_not_measured():
    values = np.ones((3, 2, 4, 3))
    values[1, 1, 2, 0], values[2, 0, 1, 2] = np.inf, -np.inf
    before = values.copy()
    material = Measured.from_table(values)
    np.testing.assert_array_equal(values, before)
    assert not material.samples.valid.reshape(3, 2, 4)[[1, 2], [1, 0], [2, 1]].any()
    w = from_angles(np.linspace(0.1, 1.5, 50), np.linspace(0, 6, 50))
    np.testing.assert_allclose(material.eval(w, w[::-1]), 1)
    with pytest.raises(BrdfkitError, match="no valid measurement"):
        Measured.from_table(np.full((3, 2, 4, 3), np.inf))


# -- spectra --------------------------------------------------------------------------------


def spectral(reflectance, wavelengths):
    w = np.tile([0, 0, 1.0], (len(reflectance), 1))
    channels = tuple(f"{nm:g}nm" for nm in wavelengths)
    return Measured.from_samples(w, w, reflectance, channels=channels)


@pytest.mark.quick
@pytest.mark.parametrize(
    "wavelengths", [np.arange(400, 701, 10), [450, 550, 650], [650, 480.5, 610, 400]]
)
def test_white_is_one(wavelengths):
    rgb = spectral(np.ones((1, len(wavelengths))), wavelengths).rgb
    assert rgb.channels == RGB
    np.testing.assert_allclose(rgb.values, 1, atol=1e-6)
    assert "D65" in rgb.info["rgb"]
    assert "CIE 1931" in rgb.info["rgb"]


@pytest.mark.quick
def test_order_of_wavelengths_does_not_matter():
    sorted_ = spectral([[0.1, 0.2, 0.7]], [450, 550, 650]).rgb.values
    shuffled = spectral([[0.7, 0.1, 0.2]], [650, 450, 550]).rgb.values
    np.testing.assert_allclose(shuffled, sorted_, rtol=1e-12)
    assert sorted_[0, 0] > sorted_[0, 1] > sorted_[0, 2]


@pytest.mark.quick
def test_colour_agrees_with_integration_by_colour_science():
    colour = import_colour_package()

    nm = np.arange(400, 701, 10)
    reflectance = 0.4 + 0.3 * np.sin(nm / 40)
    fine = np.arange(360, 781)
    domain = colour.SpectralShape(360, 780, 1)
    spectrum = colour.SpectralDistribution(np.interp(fine, nm, reflectance), fine)
    light = colour.SDS_ILLUMINANTS["D65"].copy().align(domain)
    observer = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"].copy().align(domain)
    xyz = colour.sd_to_XYZ(spectrum, observer, light, method="Integration") / 100
    expected = colour.RGB_COLOURSPACES["sRGB"].matrix_XYZ_to_RGB @ xyz
    np.testing.assert_allclose(spectral(reflectance[None], nm).rgb.values[0], expected, atol=5e-4)


@pytest.mark.quick
def test_saturated_colours_keep_negative_values():
    green = np.exp(-(((np.arange(400, 701, 10) - 520) / 15.0) ** 2))
    red, *rest = spectral(green[None], np.arange(400, 701, 10)).rgb.values[0]
    assert red < 0 < max(rest)


@pytest.mark.quick
@pytest.mark.parametrize(
    ("channels", "match"), [(("X", "Y"), "X, Y .* wavelengths"), (("900nm", "950nm"), "no colour")]
)
def test_channels_without_colour(channels, match):
    up = [[0, 0, 1.0]]
    material = Measured.from_samples(up, up, [[1.0, 1.0]], channels=channels)
    with pytest.raises(BrdfkitError, match=match):
        _ = material.rgb


@pytest.mark.quick
@pytest.mark.quick
def test_a_saved_fit_runs_no_program(tmp_path):
    """The label in a file is the name of a model, never a Python file to load."""
    evil = tmp_path / "evil.py"
    evil.write_text(f"open({str(tmp_path / 'done')!r}, 'w')")
    wi, wo = np.array([[[0.0, 0.0, 1.0]]] * 2)
    data = bk.Measured.from_samples(wi, wo, [[0.2]], channels=("Y",))
    save(bk.fit(data, "lambert"), tmp_path / "fit.json")
    for label in (str(evil), f"{evil}+ward", "mixture:models=" + str(evil) + "+ward"):
        text = (tmp_path / "fit.json").read_text().replace('"lambert"', json.dumps(label))
        (tmp_path / "other.json").write_text(text)
        with pytest.raises(BrdfkitError, match=r"somebody's own|no model"):
            load(tmp_path / "other.json")
    assert not (tmp_path / "done").exists()
