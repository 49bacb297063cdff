"""Files that are dropped on a page: what they open, and that nothing of them stays."""

import json
import math
import os
import shutil
import tempfile
import threading

import nibabel
import numpy as np
import psutil
import pydicom
import pytest
import small_volumes

import brdfkit as bk
from brdfkit.cli.commands import view
from brdfkit.core.errors import BrdfkitError
from brdfkit.lighting.environments.map_files import write_map
from brdfkit.rendering.progressive import derive_seed
from brdfkit.viewing import uploads
from brdfkit.viewing.drops import DropSession
from brdfkit.viewing.volumes import source
from brdfkit.viewing.volumes.application import VolumeApplication
from brdfkit.volumes import formats

GRID = np.arange(4 * 5 * 6, dtype=np.uint8).reshape(6, 5, 4)  # (nz, ny, nx)
MHD = "ObjectType = Image\nNDims = 3\nDimSize = 4 5 6\nElementType = MET_UCHAR\n"
NHDR = "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 4 5 6\nencoding: raw\n"
HEADER = {"type": "raw", "size": [4, 5, 6], "dtype": "uint8", "spacing": [1, 1, 2], "offset": 0}


@pytest.fixture(scope="module")
def volume():
    return bk.volumes.load("smoke", size=16)


@pytest.fixture
def session(mi, volume, tmp_path, monkeypatch):
    """A session whose uploads lie in `tmp_path`."""
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    session = DropSession(VolumeApplication(volume, "smoke"))
    session.handle({"type": "hello", "width": 64, "height": 64, "state": None})
    yield session
    session.close()
    assert list(tmp_path.glob("brdfkit-view-*")) == []


def kinds(messages):
    return [message["type"] for message, _ in messages]


def pieces(files):
    """The messages by which the page sends files, by name, and their bytes."""
    for index, (name, content) in enumerate(files.items()):
        message = {"type": "upload", "name": name, "size": len(content), "count": len(files)}
        message |= {"index": index}
        half = len(content) // 2
        yield message | {"offset": 0}, content[:half]
        yield message | {"offset": half}, content[half:]


def drop(session, files):
    """Drop files, by name; return Python's answers to the last piece."""
    for message, data in pieces(files):
        answers = session.handle(message, data)
    return [message for message, _ in answers]


def nifti_pair(folder):
    """The bytes of a NIfTI pair."""
    nibabel.save(nibabel.Nifti1Pair(GRID.T, np.diag([2, 2, 3, 1])), folder / "head.img")
    return {name: (folder / name).read_bytes() for name in ("head.hdr", "head.img")}


def radiance(folder):
    """The bytes of an environment map of Radiance's."""
    rows = b"".join(bytes([128, 128, 128, 129]) for _ in range(4 * 2))
    return b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 4\n" + rows


@pytest.mark.parametrize("reverse", [False, True])
@pytest.mark.parametrize("kind", ["mhd", "nhdr", "elsewhere", "nifti"])
def test_a_header_and_its_voxels_are_one_volume(session, tmp_path, kind, reverse):
    files = {
        "mhd": {"a.mhd": f"{MHD}ElementDataFile = a.raw\n".encode(), "a.raw": GRID.tobytes()},
        "elsewhere": {
            "a.mhd": f"{MHD}ElementDataFile = data/a.raw".encode(),
            "a.raw": GRID.tobytes(),
        },
        "nhdr": {"a.nhdr": f"{NHDR}data file: ./a.raw\n".encode(), "a.raw": GRID.tobytes()},
    }.get(kind) or nifti_pair(tmp_path)
    names = sorted(files, reverse=reverse)
    opened = drop(session, {n: files[n] for n in names})[0]
    assert (opened["type"], opened["volume"]["size"]) == ("open", (4, 5, 6))
    assert (session.application.volume.values == GRID).all()


ELSEWHERE = {  # lines of headers, by the suffix of the file
    ".mhd": [
        *(f"{blank}ElementDataFile = SECRET" for blank in ("", "\xa0", "\x85", "\x1c")),
        *(f"ElementDataFile={name}" for name in ("..", "data/", "..\\secret.raw", "a" * 999)),
    ],
    ".mha": ["ElementDataFile\xa0= SECRET", "ElementDataFile=../secret.raw"],
    ".nhdr": [
        *(f"{before}data file: SECRET\n" for before in ("", "\xa0", 9999 * "# long\n")),
        *(f"{key}: SECRET\n" for key in ("datafile", "da\xffta file", "data\xfffile")),
    ],
}


@pytest.mark.parametrize(
    ("suffix", "line"),
    [(suffix, line) for suffix, lines in ELSEWHERE.items() for line in lines],
    ids=lambda text: ascii(text)[:30],
)
def test_a_header_names_no_file_of_another_folder(session, tmp_path, suffix, line):
    """Whatever bytes the readers of headers take for blanks, or leave out."""
    secret = tmp_path / "secret.raw"
    secret.write_bytes(GRID.tobytes())
    header = (NHDR if suffix == ".nhdr" else MHD) + line.replace("SECRET", str(secret)) + "\n"
    (error, _) = drop(session, {f"a{suffix}": header.encode("latin-1")})
    assert error["type"] == "error"
    assert "in one" in error["text"]


def test_a_header_names_no_link_to_another_folder(tmp_path):
    (tmp_path / "secret.raw").write_bytes(GRID.tobytes())
    folder = tmp_path / "folder"
    folder.mkdir()
    (folder / "a.raw").symlink_to(tmp_path / "secret.raw")
    (folder / "a.mhd").write_text(f"{MHD}ElementDataFile = a.raw\n")
    assert bk.volumes.load(folder / "a.mhd").size == (4, 5, 6)
    with formats.confine_headers(), pytest.raises(BrdfkitError, match="of another folder"):
        bk.volumes.load(folder / "a.mhd")


def test_a_hdr_is_an_environment_map_if_it_is_radiance(session, tmp_path):
    opened = drop(session, {"lamp.hdr": radiance(tmp_path)})[0]
    assert opened["state"]["light.environment"] == "lamp.hdr"
    assert session.application.volume.name == "smoke"


def dicom(folder, description):
    """The bytes of a series of DICOM slices."""
    small_volumes.dicom(folder)
    for path in folder.glob("*.dcm"):
        header = pydicom.dcmread(path)
        header.SeriesDescription = description
        header.save_as(path)
    return {path.name: path.read_bytes() for path in sorted(folder.glob("*.dcm"))}


@pytest.mark.parametrize(
    ("description", "name"), [("T1 MPRAGE/sag ", "T1 MPRAGE_sag"), ("", "s16"), ("..", "s16")]
)
def test_a_dropped_series_is_named_by_its_description(session, tmp_path, description, name):
    (tmp_path / "scan").mkdir()
    files = dicom(tmp_path / "scan", description)
    (opened,) = drop(session, files)
    assert (opened["title"], opened["volume"]["size"]) == (name, (6, 5, 4))
    assert session.application.source.path == name
    opened, notice = drop(session, {"s16.dcm": files["s16.dcm"]})
    assert notice["text"].startswith("s16.dcm is one slice: drop all files of a scan together")


@pytest.mark.parametrize("names", [["a.txt"], ["a.txt", "b.txt"]])
def test_a_file_of_another_kind_is_refused_by_what_the_page_opens(session, names):
    error, _ = drop(session, dict.fromkeys(names, b"hello"))
    assert error["text"].startswith("a.txt: is no file that the page opens")
    assert error["text"].endswith("transfer functions and settings (.json).")


def test_a_volume_and_a_map_in_one_drop(session, tmp_path):
    files = {"lamp.hdr": radiance(tmp_path)} | nifti_pair(tmp_path)
    opened = drop(session, files)
    assert (opened[-1]["title"], opened[-1]["state"]["light.environment"]) == ("head", "lamp.hdr")


def test_another_map_of_the_same_name_replaces_the_first(session, tmp_path):
    pictures = []
    for colour in ((1, 0, 0), (0, 0, 1)):
        path = write_map(np.full((2, 4, 3), colour, np.float32), tmp_path / "lamp.exr")
        drop(session, {"lamp.exr": path.read_bytes()})
        assert session.has_work()
        session.work()
        session.handle({"type": "shown", "number": session.number})
        pictures.append(session.accumulated[0].picture)
    assert session.passes == 1
    assert np.abs(pictures[1] - pictures[0]).max() > 0.1
    names = [value for value, _ in session.application.states.controls["light.environment"].choices]
    assert names.count("lamp.exr") == 1


@pytest.mark.parametrize(
    "answer",
    [HEADER, HEADER | {"size": None}, HEADER | {"dtype": "U8"}, HEADER | {"size": [4, 5]}, None],
    ids=str,
)
def test_raw_voxels_leave_nothing_behind(session, tmp_path, answer):
    """Whether their header is given, wrong or cancelled, or the page goes."""
    question = drop(session, {"tissue_4x5x6_uint8.raw": GRID.tobytes()})[0]
    assert (question["type"], question["guess"]["size"]) == ("ask_raw", [4, 5, 6])
    assert len(list(tmp_path.iterdir())) == 1
    if answer is not None:
        session.handle(answer)
        assert list(tmp_path.iterdir()) == []


def test_another_drop_and_an_error_leave_nothing_behind(session, tmp_path):
    drop(session, {"a.raw": GRID.tobytes()})
    drop(session, {"b.raw": GRID.tobytes()})
    assert len(list(tmp_path.iterdir())) == 1
    error = drop(session, {"x.nii": b"abc"})[0]
    assert error["text"].startswith("x.nii: ")  # without the folder, which is gone
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    "wrong",
    [
        {"offset": 3},
        {"offset": -1},
        {"index": 1},
        {"index": 7},
        {"count": 0},
        {"count": -2},
        {"count": 10**9},
        {"size": 10},
        {"size": "many"},
        {"size": float("nan")},
        {"offset": None},
    ],
    ids=str,
)
def test_a_piece_in_a_wrong_place_is_a_sentence(session, tmp_path, wrong):
    piece = {"type": "upload", "name": "x.raw", "size": 64, "offset": 0}
    piece |= {"index": 0, "count": 2}
    session.handle(piece, b"x" * 32)
    (error, _), _ = session.handle(piece | {"offset": 32} | wrong, b"x" * 32)
    assert error["type"] == "error"
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("room", ["memory", "disk", "limit"])
def test_too_large_a_file_is_refused_before_it_is_sent(session, tmp_path, monkeypatch, room):
    memory, disk = psutil.virtual_memory(), shutil.disk_usage(tmp_path)
    monkeypatch.setattr(
        psutil, "virtual_memory", lambda: memory._replace(available=room != "memory" and 2**40)
    )
    monkeypatch.setattr(
        shutil, "disk_usage", lambda _: disk._replace(free=room != "disk" and 2**40)
    )
    size = uploads.LARGEST_UPLOAD + 1 if room == "limit" else 1000
    piece = {"type": "upload", "name": "x.raw", "offset": 0, "index": 0}
    (error, _), _ = session.handle(piece | {"size": size, "count": 1}, b"x")
    assert "too many to send" in error["text"]
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    "name", ["", "..", "/", "a\0b.raw", "é" * 300 + ".raw", "\ud800.raw", 3, None]
)
def test_any_name_of_a_file_is_one_in_the_folder(session, tmp_path, name):
    upload = session.upload
    piece = {"type": "upload", "name": name, "size": 2, "offset": 0}
    assert kinds(session.handle(piece | {"index": 0, "count": 1}, b"x")) == ["uploaded"]
    (path,) = upload.files
    assert path.is_file()
    assert path.parent.parent == tmp_path
    assert path.suffix == (".raw" if str(name).endswith(".raw") else "")


def test_slices_of_one_name_in_two_folders_are_kept_both(session, tmp_path):
    upload = session.upload
    for index in (0, 1):
        piece = {"type": "upload", "name": f"{index}/1.dcm", "size": 1}
        upload.add(piece | {"offset": 0, "index": index, "count": 3}, bytes([index]))
    assert [path.read_bytes() for path in upload.files] == [b"\0", b"\1"]


@pytest.mark.parametrize("made", [False, True])
def test_a_folder_that_cannot_be_written_is_a_sentence(session, tmp_path, monkeypatch, made):
    """Be it one for all temporary files, or later that of the drop."""
    session.handle({"type": "set", "changes": {"renderer": "maximum_intensity"}})
    session.work()
    begin = {"type": "upload", "name": "x.raw", "size": 2, "offset": 0}
    begin |= {"index": 0, "count": 1}
    messages = [begin, {"type": "save", "kind": "exr"}]
    if made:
        session.handle(begin, b"x")
        shutil.rmtree(session.upload.folder.name)
        messages = [begin | {"offset": 1}]
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "none"))
    for message in messages:
        (error, _), _ = session.handle(message, b"x")
        assert "No such file or directory); make room, or set TMPDIR" in error["text"]


def test_the_end_deletes_a_file_that_is_still_read(session, tmp_path, monkeypatch):
    """Without the session's lock, which the long answer has."""
    statuses = []
    monkeypatch.setattr(os, "_exit", statuses.append)
    drop(session, {"a.raw": GRID.tobytes()})
    with session.lock:
        thread = threading.Thread(target=view._exit_at_once)
        thread.start()
        thread.join(10)
    assert statuses == [130]
    assert list(tmp_path.iterdir()) == []


# Memory


def test_a_file_that_is_too_large_is_averaged_as_it_says(tmp_path, monkeypatch, volume):
    path = tmp_path / "a.nii"
    nibabel.save(nibabel.Nifti1Image(np.ones((40, 40, 40), np.int16), np.eye(4)), path)
    memory = psutil.virtual_memory()

    def have(available):
        monkeypatch.setattr(psutil, "virtual_memory", lambda: memory._replace(available=available))

    have(1_000_000)
    with pytest.warns(UserWarning, match="and 2³ voxels become one"):
        loaded, where = source.load_within_memory(path)
    assert (loaded.size, where.settings) == ((20, 20, 20), {"downsample": 2})
    have(100_000)  # too little for loading it whole
    with pytest.warns(UserWarning, match=r"and \d³ voxels become one"):
        loaded, where = source.load_within_memory(path, downsample=2)
    factor = where.settings["downsample"]
    assert loaded.size == (-(-40 // factor),) * 3
    assert source.VOXEL_BYTES * loaded.values.size <= 100_000
    have(1000)
    with pytest.raises(BrdfkitError, match="check that it is the right file"):
        source.load_within_memory(path)


def test_a_downsampling_that_suffices_is_taken(tmp_path, recwarn):
    loaded, where = source.load_within_memory("smoke", downsample=2, size=16)
    assert (loaded.size, where.settings) == ((8, 8, 8), {"size": 16, "downsample": 2})
    assert not recwarn.list


# Scripts


def run_script(session, folder, **replaced):
    """Run the copied script with one sample, in a folder; return its picture and its text."""
    ((message, _),) = session.handle({"type": "copy", "kind": "python"})
    text = message["text"]
    for old, new in ({"spp=64": "spp=1", "picture.write": "str"} | replaced).items():
        text = text.replace(old, new)
    names = {}
    exec(text, names)
    (picture,) = names["picture"].pictures.values()
    return picture, message["text"]


def render(session):
    """The picture of the session's state with one sample."""
    return session.application.render(session.state, 0, session.size, False, derive_seed(0, 0))


def test_the_script_of_uploaded_raw_voxels_loads_them_alike(session, tmp_path, monkeypatch):
    (tmp_path / "a.raw").write_bytes(GRID.tobytes())
    drop(session, {"a.raw": GRID.tobytes()})
    session.handle(HEADER)
    session.handle({"type": "set", "changes": {"renderer": "maximum_intensity"}})
    picture, text = run_script(session, tmp_path, **{"'a.raw'": repr(str(tmp_path / "a.raw"))})
    assert text.startswith("# Write the folder of a.raw before its name")
    np.testing.assert_allclose(picture, render(session), rtol=1e-5, atol=1e-6)
    ((error, _), _) = session.handle({"type": "copy", "kind": "command"})
    assert "copy Python" in error["text"]


def test_the_script_of_uploaded_light_and_functions_loads_them_alike(session, tmp_path):
    write_map(np.full((2, 4, 3), 0.2, np.float32), tmp_path / "lamp.exr")
    session.application.states.functions.load("emission").save(tmp_path / "own.json")
    for name in ("lamp.exr", "own.json"):
        drop(session, {name: (tmp_path / name).read_bytes()})
    session.handle({"type": "set", "changes": {"transfer.mode": "preset"}})
    named = {f"'{n}'": repr(str(tmp_path / n)) for n in ("lamp.exr", "own.json")}
    picture, text = run_script(
        session, tmp_path, **named, **{"load('smoke')": "load('smoke', size=16)"}
    )
    assert text.count("# Write the folder of") == 2
    np.testing.assert_allclose(picture, render(session), rtol=1e-5, atol=1e-6)
    session.handle({"type": "set", "changes": {"transfer.mode": "points"}})
    picture, text = run_script(
        session, tmp_path, **named, **{"load('smoke')": "load('smoke', size=16)"}
    )
    assert "own.json" not in text  # its points say all
    np.testing.assert_allclose(picture, render(session), rtol=1e-5, atol=1e-6)


def test_the_script_keeps_what_was_changed_of_a_preset(session, tmp_path):
    """Such as its colour, which loading the preset reset."""
    session.handle({"type": "set", "changes": {"transfer.preset": "emission"}})
    session.handle({"type": "set", "changes": {"transfer.mode": "preset"}})
    session.handle({"type": "set", "changes": {"transfer.colour": "albedo"}})
    picture, _ = run_script(session, tmp_path, **{"load('smoke')": "load('smoke', size=16)"})
    np.testing.assert_allclose(picture, render(session), rtol=1e-5, atol=1e-6)


def test_the_command_has_the_downsampling(mi):
    volume = bk.volumes.load("smoke", size=8)
    own = DropSession(VolumeApplication(volume, source.Source("smoke", {"downsample": 2})))
    ((message, _),) = own.handle({"type": "copy", "kind": "command"})
    assert message["text"].startswith("brdfkit view smoke --downsample 2 --state '{")
    assert message["text"].endswith("-o smoke.png")
    assert json.loads(message["text"].split("'")[1]) == {}


def drop_bump(session, r, g, b):
    """Drop a bump of VPT; return the first answer."""
    bump = {"position": {"x": 0.3, "y": 0.6}, "size": {"x": 0.2, "y": 0.1}}
    text = json.dumps([bump | {"color": {"r": r, "g": g, "b": b, "a": 0.7}}])
    return drop(session, {"tf.json": text.encode()})[0]


def test_bumps_of_vpt_are_shown(session):
    message = drop_bump(session, 1, 0.5, 0)
    (shown,) = message["state"]["transfer.bumps"]
    assert shown == {"x": 0.3, "y": 0.6, "sx": 0.2, "sy": 0.1, "a": 0.7, "colour": "#ff8000"}
    assert message["state"]["transfer.mode"] == "bumps2d"


def test_any_bump_of_vpt_has_a_colour_or_is_a_sentence(session):
    for component, shown in (
        (1e308, "ff"),
        (2, "ff"),
        (-1, "00"),
        (math.inf, "ff"),
        (10**400, "ff"),
    ):
        message = drop_bump(session, 1, component, 0)
        assert message["state"]["transfer.bumps"][0]["colour"] == f"#ff{shown}00"
    for component in (math.nan, "1", None):
        assert "is no transfer function" in drop_bump(session, 1, component, 0)["text"]


def test_a_file_without_settings_is_a_sentence(session):
    for content, sentence in ((b"[1]", "is no transfer function"), (200_000 * b"[", "is no JSON")):
        (error, _) = drop(session, {"a.json": content})
        assert error["text"].startswith("a.json: ")
        assert sentence in error["text"]


@pytest.mark.parametrize(
    ("state", "sentence"),
    [
        *((state, "should be settings by name") for state in (5, [1], "renderer", [], "")),
        ({"light.environment": "a" * 5000}, "'aaa.*' is not possible"),
        ({"light.environment": "a\0"}, "is not possible"),
        ({"transfer.preset": "a" * 5000}, "is not possible"),
        ({1: 2}, "there is no setting 1"),
    ],
    ids=lambda value: str(value)[:30],
)
def test_a_state_that_is_none_is_a_sentence(volume, state, sentence):
    for make in (VolumeApplication, bk.viewing.render_view):
        with pytest.raises(BrdfkitError, match=f"(?i){sentence}"):
            make(volume, **{"state" if make is bk.viewing.render_view else "changes": state})
