"""brdfkit's own archive: lossless, the same bytes each time, and hard to abuse."""

import io
import json
import tracemalloc
import zipfile

import numpy as np
import pytest
from small_files import MATERIALS, assert_same, brushed, place, spectrum, table

from brdfkit.core.errors import BrdfkitError
from brdfkit.materials.formats import npz
from brdfkit.materials.loading import load, save
from brdfkit.materials.measured import Measured


def packed(material=None, **changes):
    """The archive of `material` with some members changed: arrays, bytes, or None to leave out."""
    stream = io.BytesIO()
    npz.write(material or spectrum(), stream)
    with zipfile.ZipFile(stream) as archive:
        members = {i.filename.removesuffix(".npy"): archive.read(i) for i in archive.infolist()}
    for name, content in changes.items():
        if isinstance(content, np.ndarray):
            member = io.BytesIO()
            np.save(member, content)
            content = member.getvalue()
        members[name] = content
    with zipfile.ZipFile(stream := io.BytesIO(), "w") as archive:
        for name, content in members.items():
            if content is not None:
                archive.writestr(f"{name}.npy", content)
    return stream.getvalue()


def about(**changes):
    """The member about of `packed`, with some entries changed."""
    with np.load(io.BytesIO(packed())) as arrays:
        entries = {**json.loads(arrays["about"].tobytes()), **changes}
    return np.frombuffer(json.dumps(entries).encode(), np.uint8)


def with_errors():
    values = np.arange(72.0).reshape(3, 2, 4, 3) + 0.1
    rest = {"phi_d_period": 1.25, "standard_error": values / 7, "info": {"ä": "θ"}}
    return Measured.from_table(values, name="täble #1", **rest)


MEASURED = {name: make for name, make in MATERIALS.items() if name != "fit"}
MEASURED |= {"errors": with_errors, "brushed samples": lambda: spectrum(anisotropic=True)}


@pytest.mark.quick
@pytest.mark.parametrize("name", MEASURED)
def test_lossless_and_the_same_each_time(tmp_path, name):
    material = MEASURED[name]()
    save(material, tmp_path / "a.npz")
    save(MEASURED[name](), tmp_path / "b.npz")
    assert (tmp_path / "a.npz").read_bytes() == (tmp_path / "b.npz").read_bytes()
    back = load(tmp_path / "a.npz")
    assert_same(back.samples, material.samples)
    for attribute in ("name", "channels", "info", "anisotropic", "is_table"):
        assert getattr(back, attribute) == getattr(material, attribute), attribute
    if material.is_table:
        assert back.table.phi_d_period == material.table.phi_d_period
    np.testing.assert_array_equal(back.standard_error, material.standard_error)


@pytest.mark.quick
def test_notes_and_names_become_text(tmp_path):
    some = spectrum().samples
    info = {"T": 21, 7: None, "at": np.arange(3)}
    material = Measured.from_samples(
        some.wi, some.wo, some.values, name=tmp_path / "a", info=info, channels=np.array([*"RGB"])
    )
    save(material, tmp_path / "paint.npz")
    back = load(tmp_path / "paint.npz")
    assert back.info == {"T": "21", "7": "None", "at": "[0 1 2]"}
    assert back.name == str(tmp_path / "a")
    assert back.channels == ("R", "G", "B")


@pytest.mark.quick
@pytest.mark.parametrize("period", [0, -1, 10, np.nan])
def test_no_table_has_such_a_period(period):
    with pytest.raises(BrdfkitError, match=r"grey: phi_d_period is .*; give π"):
        Measured.from_table(np.ones((2, 2, 2, 3)), phi_d_period=period, name="grey")


@pytest.mark.quick
@pytest.mark.parametrize("shape", [7, (9, 9), (9, 9, 0), (9, 9, 2.5), (1, 2, 3, 4, 5)])
def test_no_table_has_such_a_shape(shape):
    with pytest.raises(BrdfkitError, match="was asked for; give three numbers of cells"):
        table().resampled(shape)


@pytest.mark.quick
def test_numpy_opens_it(tmp_path):
    save(table(), tmp_path / "paint.npz")
    with np.load(tmp_path / "paint.npz") as arrays:
        np.testing.assert_array_equal(arrays["table"], table().table.values)
        assert json.loads(arrays["about"].tobytes())["name"] == "paint"


def test_a_lookup_is_stored_as_what_it_gives_in_a_table(tmp_path):
    some = spectrum().samples
    lookup = table().table.eval
    material = Measured.from_samples(some.wi, some.wo, lookup(some.wi, some.wo), lookup=lookup)
    save(material, tmp_path / "paint.npz")
    back = load(tmp_path / "paint.npz")
    assert_same(back.samples, material.samples)
    assert not back.is_table
    found, expected = back.eval(some.wi, some.wo), material.table.eval(some.wi, some.wo)
    np.testing.assert_array_equal(found, expected)
    known = np.isfinite(material.table.values)
    np.testing.assert_allclose(back.table.values[known], material.table.values[known], rtol=1e-9)


@pytest.mark.quick
def test_reads_single_precision(tmp_path):
    values = spectrum().values.astype(np.float32)
    values.view(np.uint32)[0, 0] = 0x7F800001  # a NaN that signals; this row is not valid
    material = load(place(tmp_path, "npz, written", packed(values=values)))
    np.testing.assert_array_equal(material.values, values)


def header(shape, dtype="<f8"):
    text = f"{{'descr': '{dtype}', 'fortran_order': False, 'shape': {shape}, }}".ljust(117) + "\n"
    return b"\x93NUMPY\x01\x00" + len(text).to_bytes(2, "little") + text.encode()


def compressed():
    with zipfile.ZipFile(stream := io.BytesIO(), "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("about.npy", header((10**9,), "|u1") + bytes(10**6))
    return stream.getvalue()


TRAPS = {
    "no archive": (b"PK\x03\x04" + bytes(60), "is no whole zip archive"),
    "cut short": (packed()[:-10], "is no whole zip archive"),
    "a bit changed": (packed().replace(b"450nm", b"451nm"), "is no whole zip archive .*CRC"),
    "compressed": (compressed(), "is compressed inside"),
    "no about": (packed(about=None), "no measured material"),
    "no values": (packed(values=None), "lacks 'table'"),
    "no wi": (packed(wi=None), "lacks 'wi'"),
    "no JSON": (packed(about=np.frombuffer(b"{", np.uint8)), "no measured material"),
    "deep": (packed(about=np.frombuffer(b"[" * 10**5, np.uint8)), "no measured material"),
    "a list": (packed(about=np.frombuffer(b"[1]", np.uint8)), "no measured material"),
    "no name": (packed(about=about(name=None)), "no text"),
    "number as channel": (packed(about=about(channels=[1, 2, 3])), "no text"),
    "two channels": (packed(about=about(channels=["X", "Y"])), r"should be \(n, 2\)"),
    "period": (packed(table(), about=about(phi_d_period=float("nan"))), "phi_d_period is nan"),
    "huge": (packed(values=header((10**12, 3))), "member values is no whole array"),
    "overflowing": (packed(values=header((2**62, 2**62, 4))), "member values is no whole array"),
    "two numbers in one": (packed(values=header("(3 6, 1)")), "member values is no whole array"),
    "empty": (packed(values=header((0, 3))), "member values is no whole array"),
    "objects": (packed(values=np.array([{}])), "member values is no whole array"),
    "complex": (packed(values=spectrum().values * 1j), "member values is no whole array"),
    "big-endian": (packed(values=spectrum().values.astype(">f8")), "member values is no whole"),
    "code": (packed(values=header("().__class__")), "member values is no whole array"),
    "long": (packed(wi=spectrum().samples.wi * 1.5), "no unit vector"),
    "short": (packed(wo=spectrum().samples.wo * 0.5), "no unit vector"),
    "infinite": (packed(wi=np.full((12, 3), np.inf)), "no unit vector"),
    "nothing valid": (packed(valid=np.zeros(12, bool)), "no valid measurement"),
    "valid of another size": (packed(valid=np.ones(5, bool)), "no measured material"),
    "errors of another size": (packed(standard_error=np.ones((5, 3))), "standard errors"),
    "table of another kind": (
        packed(table=np.ones((3, 3)), about=about(phi_d_period=3.0)),
        "a table of shape",
    ),
}


@pytest.mark.quick
@pytest.mark.parametrize("trap", TRAPS)
def test_traps(tmp_path, trap):
    data, match = TRAPS[trap]
    path = tmp_path / "paint.npz"
    path.write_bytes(data)
    tracemalloc.start()
    try:
        with pytest.raises(BrdfkitError, match=rf"paint\.npz: .*{match}") as caught:
            load(path)
        assert tracemalloc.get_traced_memory()[1] < 20e6
    finally:
        tracemalloc.stop()
    assert str(caught.value).endswith(".")
    assert "\n" not in str(caught.value)


@pytest.mark.quick
def test_refuses_what_is_no_material(tmp_path):
    with pytest.raises(BrdfkitError, match="holds a measured material, not a Fit"):
        save(MATERIALS["fit"](), tmp_path / "fit.npz")
    assert not any(tmp_path.iterdir())


@pytest.mark.quick
def test_brushed_table_is_anisotropic(tmp_path):
    save(brushed(), tmp_path / "brushed.npz.xz")
    assert load(tmp_path / "brushed.npz.xz").table.anisotropic
