"""Files of volumes × their traps: written by other libraries, and read as these read them."""

import gzip
import struct
import tracemalloc
import warnings
import zlib
from pathlib import Path

import numpy as np
import psutil
import pytest
import small_volumes as small
import tifffile
from small_volumes import ORIGIN, SHAPE, SPACING, TO_WORLD, values

import brdfkit as bk
from brdfkit.core.errors import BrdfkitError
from brdfkit.volumes import made
from brdfkit.volumes.formats import list_formats
from brdfkit.volumes.transfer.files import list_presets

LPS = np.diag([-1, -1, 1, 1])


def assert_alike(volume, expected, to_world):
    """The values to the last bit, and the transform to 1e-5 of a voxel: headers have float32."""
    np.testing.assert_array_equal(volume.values, expected)
    np.testing.assert_allclose(volume.to_world, to_world, atol=2e-5)


# Right ones

ITK = {
    "a.nii": {},
    "a.nii.gz": {},
    "a.hdr": {},
    "a.nrrd": {"compressed": True},
    "b.nrrd": {},
    "a.nhdr": {},
    "a.mha": {"compressed": True},
    "b.mha": {"dtype": np.float64},
    "a.mhd": {},
    "b.mhd": {"compressed": True, "dtype": np.uint8},
}


@pytest.mark.parametrize("name", ITK)
def test_what_itk_writes(tmp_path, name):
    """Oblique axes, LPS to RAS, uneven spacing; packed, and beside a header."""
    small.by_itk(tmp_path / name, **ITK[name])
    volume = bk.volumes.load(tmp_path / name)
    assert_alike(volume, *small.read_by_itk(tmp_path / name))
    assert_alike(volume, values(ITK[name].get("dtype", np.int16)), LPS @ TO_WORLD)
    assert (volume.axes, volume.unit, volume.name) == ("RAS", "mm", name[0])
    assert volume.labels is False


@pytest.mark.parametrize(
    "how",
    [
        {"sform": 1},
        {"sform": 1, "qform": 1},  # which differ: the sform counts
        {"sform": 0, "qform": 1},
        {"order": ">", "dtype": np.float32},
        {"slope": 0.5, "intercept": -1000.0},
        {"intent_code": 1002, "dtype": np.uint8},
        {"xyzt_units": 3, "dtype": np.int32},
    ],
    ids=str,
)
def test_nifti(tmp_path, how):
    path = tmp_path / "a.nii"
    small.nifti(path, **how)
    volume = bk.volumes.load(path)
    expected = values(how.get("dtype", np.int16)) * how.get("slope", 1) + how.get("intercept", 0)
    assert_alike(volume, expected, TO_WORLD)
    assert volume.labels == (how.get("intent_code") == 1002)
    assert volume.unit == ("µm" if "xyzt_units" in how else "mm")
    expected, to_world = small.read_by_itk(path)
    if "xyzt_units" in how:  # which ITK makes mm
        to_world = np.diag([1000, 1000, 1000, 1]) @ to_world
    assert_alike(volume, expected, to_world)


def test_a_point_in_time_of_nifti(tmp_path):
    import nibabel

    path = tmp_path / "a.nii.gz"
    times = np.stack([values(), values() + 1], axis=-1)
    nibabel.save(nibabel.Nifti1Image(np.moveaxis(times, -1, 0).T, TO_WORLD), path)
    assert_alike(bk.volumes.load(f"{path}#1"), values() + 1, TO_WORLD)
    assert bk.volumes.load(f"{path}#1").name == "a#1"
    with pytest.raises(BrdfkitError, match=r"has 2 volumes; name one, from 0: a\.nii\.gz#0"):
        bk.volumes.load(path)
    with pytest.raises(BrdfkitError, match=r"no volume '#2'; name one of 0 to 1"):
        bk.volumes.load(f"{path}#2")


@pytest.mark.parametrize("encoding", ["raw", "gzip", "bzip2", "ascii"])
@pytest.mark.parametrize("detached", [False, True])
def test_nrrd(tmp_path, encoding, detached):
    """Of pynrrd, in a space of its own, and a segmentation."""
    import nrrd

    header = {
        "space": "left-anterior-superior",
        "space directions": TO_WORLD[:3, :3].T,
        "space origin": ORIGIN,
        "encoding": encoding,
        "Segment0_ID": "Segment_1",
    }
    path = tmp_path / ("a.nhdr" if detached else "a.nrrd")
    nrrd.write(str(path), values(np.uint16), header, index_order="C", detached_header=detached)
    volume = bk.volumes.load(path)
    assert_alike(volume, values(np.uint16), np.diag([-1, 1, 1, 1]) @ TO_WORLD)
    assert (volume.labels, volume.axes) == (True, "RAS")


def test_headers_of_others(tmp_path):
    """By hand: no space, the other byte order, data at the end of their file, text."""
    raw = b"some header" + values(">i2").tobytes()
    (tmp_path / "a.raw").write_bytes(raw)
    sizes = " ".join(map(str, SHAPE[::-1]))
    nhdr = f"NRRD0004\ntype: short\ndimension: 3\nsizes: {sizes}\nspacings: 0.5 0.75 2\n"
    nhdr += "endian: big\nencoding: raw\nbyte skip: -1\ndata file: a.raw\n\n"
    mhd = f"NDims = 3\nDimSize = {sizes}\nElementType = MET_SHORT\nElementSpacing = 0.5 0.75 2\n"
    detached = f"{mhd}BinaryDataByteOrderMSB = True\nHeaderSize = -1\nElementDataFile = a.raw\n"
    text = f"{mhd}BinaryData = False\nElementDataFile = LOCAL\n"
    text += " ".join(map(str, values().ravel()))
    for name, header in {"a.nhdr": nhdr, "a.mhd": detached, "a.mha": text}.items():
        (tmp_path / name).write_text(header)
        volume = bk.volumes.load(tmp_path / name)
        frame = np.eye(4) if name == "a.nhdr" else LPS
        assert_alike(volume, values(), frame @ np.diag([*SPACING, 1]))
    with pytest.raises(BrdfkitError, match=r"has no header; open its header, a\.mhd\.$"):
        bk.volumes.load(tmp_path / "a.raw")


VTK = [
    {"mode": "ascii", "cells": True},
    {"mode": "ascii", "dtype": np.float64},
    *[
        {"mode": mode, "encoded": encoded, "packed": packed, "wide": wide, "cells": wide}
        for mode, encoded in (("binary", True), ("appended", True), ("appended", False))
        for packed in (True, False)
        for wide in (True, False)
    ],
]


@pytest.mark.parametrize("how", VTK, ids=str)
def test_what_vtk_writes(tmp_path, how):
    """Points and cells, oblique; text, and blocks in each of their codings."""
    small.vti(tmp_path / "a.vti", **how)
    volume = bk.volumes.load(tmp_path / "a.vti")
    middle = TO_WORLD @ np.array([0.5, 0.5, 0.5, 1]) if how.get("cells") else TO_WORLD[:, 3]
    to_world = np.column_stack([TO_WORLD[:, :3], middle])
    assert_alike(volume, values(how.get("dtype", np.int16)), to_world)
    assert (volume.axes, volume.unit, volume.labels) == ("", "", False)


def test_several_arrays_of_vtk(tmp_path):
    small.vti(tmp_path / "a.vti", mode="ascii")
    text = (tmp_path / "a.vti").read_text().replace(' Scalars="density"', "")
    start, end = text.index("<DataArray"), text.index("</DataArray>") + len("</DataArray>")
    second = text[start:end].replace("density", "facies").replace("-50", "-51")
    (tmp_path / "b.vti").write_text(text[:end] + second + text[end:])
    assert bk.volumes.load(f"{tmp_path}/b.vti#facies").values.min() == -51
    with pytest.raises(BrdfkitError, match=r"density, facies; name one: b\.vti#density"):
        bk.volumes.load(tmp_path / "b.vti")
    with pytest.raises(BrdfkitError, match=r"no array 'face'; did you mean facies\?"):
        bk.volumes.load(f"{tmp_path}/b.vti#face")


SLICES = {"spacing": 2, "unit": "um", "axes": "ZYX"}
IMAGEJ = {"imagej": True, "resolution": (2, 4), "metadata": SLICES}
SEVERAL = (  # OME's metadata of a volume in two files
    '<OME xmlns="http://www.openmicroscopy.org/Schemas/OME/2016-06" UUID="urn:uuid:a">'
    '<Image ID="Image:0"><Pixels ID="Pixels:0" DimensionOrder="XYZCT" Type="uint16" '
    'SizeX="{}" SizeY="{}" SizeZ="4" SizeC="1" SizeT="1"><Channel ID="Channel:0:0"/>'
    '<TiffData FirstZ="0" PlaneCount="2"><UUID FileName="a.ome.tif">urn:uuid:a</UUID></TiffData>'
    '<TiffData FirstZ="2" PlaneCount="2"><UUID FileName="b.ome.tif">urn:uuid:b</UUID></TiffData>'
    "</Pixels></Image></OME>"
)
OME = {"PhysicalSizeX": 0.5, "PhysicalSizeY": 0.25, "PhysicalSizeZ": 2, "axes": "ZYX"}


@pytest.mark.parametrize(
    ("how", "spacing"),
    [
        ({}, (1, 1, 1)),
        ({"compression": "zlib", "byteorder": ">"}, (1, 1, 1)),
        (IMAGEJ, (0.5, 0.25, 2)),
        ({"ome": True, "metadata": OME}, (0.5, 0.25, 2)),
        ({"bigtiff": True, "byteorder": ">"}, (1, 1, 1)),
    ],
)
def test_tiff(tmp_path, how, spacing):
    how = {"photometric": "minisblack", **how}
    tifffile.imwrite(tmp_path / "a.tif", values(np.uint16), **how)
    volume = bk.volumes.load(tmp_path / "a.tif")
    assert_alike(volume, values(np.uint16), np.diag([*spacing, 1]))
    assert volume.unit == ("µm" if spacing != (1, 1, 1) else "")


def test_a_tiff_of_several_is_read_alone(tmp_path):
    """OME's metadata may name files of any folder; this ended in an error of NumPy's."""
    of_one, of_two = values(np.uint16)[:2], values(np.uint16)[2:4]
    for name, layers in (("a", of_one), ("b", of_two)):
        tifffile.imwrite(
            tmp_path / f"{name}.ome.tif",
            layers,
            description=SEVERAL.format(*layers.shape[::-1]),
            photometric="minisblack",
            metadata=None,
        )
    assert_alike(bk.volumes.load(tmp_path / "a.ome.tif"), of_one, np.eye(4))


def test_a_folder_of_tiff(tmp_path):
    """In the order of the numbers in the names, 2 before 10."""
    for k, layer in enumerate(values(np.uint8)):
        tifffile.imwrite(tmp_path / f"slice{4 * k + 2}.tif", layer)
    (tmp_path / "notes.txt").write_text("not a slice")
    volume = bk.volumes.load(tmp_path, spacing=SPACING)
    assert_alike(volume, values(np.uint8), np.diag([*SPACING, 1]))
    tifffile.imwrite(tmp_path / "slice99.tif", values(np.uint8)[0, :2])
    with pytest.raises(BrdfkitError, match=r"slice99\.tif and slice2\.tif differ"):
        bk.volumes.load(tmp_path)


def test_dicom(tmp_path):
    """Sorted by place, not by name; slope and intercept; one file of it is a slice."""
    small.dicom(tmp_path, slope=0.5, intercept=-1024)
    volume = bk.volumes.load(tmp_path)
    assert_alike(volume, *small.read_by_itk(tmp_path))
    assert_alike(volume, values() * 0.5 - 1024, LPS @ TO_WORLD)
    assert (volume.axes, volume.unit, volume.values.dtype) == ("RAS", "mm", np.float32)
    assert bk.volumes.load(tmp_path / "s19.dcm").size == (6, 5, 1)


def test_what_is_wrong_with_series_of_dicom(tmp_path):
    for name, how in {"gap": {"gap": 2}, "twice": {"twice": True}, "two": {}}.items():
        (tmp_path / name).mkdir()
        small.dicom(tmp_path / name, **how)
    small.dicom(tmp_path / "two", intercept=7, series=2)
    sentences = {
        "gap": "slices are missing: 4 mm between the slices 2 and 3, elsewhere",
        "twice": "has several slices at one place",
        "two": r"has several series, with the numbers 1 \(4 slices\), 2 \(4 slices\); name one",
    }
    for name, sentence in sentences.items():
        with pytest.raises(BrdfkitError, match=sentence):
            bk.volumes.load(tmp_path / name)
    assert bk.volumes.load(f"{tmp_path}/two#2").values.min() == values().min() + 7


def test_what_mitsuba_writes(tmp_path, llvm_variant):
    mi = llvm_variant
    grid = mi.VolumeGrid(values(np.float32)[..., None])
    grid.write(str(tmp_path / "a.vol"))
    volume = bk.volumes.load(tmp_path / "a.vol")
    np.testing.assert_array_equal(volume.values, values(np.float32))
    np.testing.assert_allclose(volume.bounds, [[0, 0, 0], [1, 1, 1]], atol=1e-6)
    np.testing.assert_allclose(volume.cube_to_world, np.eye(4), atol=1e-6)


def test_raw(tmp_path):
    data = values(">i2")
    (tmp_path / "b.raw").write_bytes(b"header" + data.tobytes())
    (tmp_path / "a_6x5x4_int16.raw").write_bytes(data.astype("<i2").tobytes())
    told = {"size": SHAPE[::-1], "dtype": ">i2", "offset": 6, "spacing": SPACING}
    assert_alike(bk.volumes.load(tmp_path / "b.raw", **told), values(), np.diag([*SPACING, 1]))
    assert_alike(bk.volumes.load(tmp_path / "a_6x5x4_int16.raw"), values(), np.eye(4))
    for change, sentence in (
        ({"size": None}, r"has no header; name it .*, as b_256x256x128_uint8\.raw, or give size="),
        ({"offset": 4}, r"has 246 bytes, where 6×5×4 voxels of >i2 behind 4 bytes make 244"),
        ({"dtype": "float32"}, "480 bytes, but the file has only 240 bytes for them"),
        ({"dtype": "colour"}, "dtype = 'colour' is no type of numbers"),
        ({"size": (1, 2)}, r"size = \(1, 2\) should be one or three whole numbers above 0"),
        ({"spacing": 0}, "spacing = 0 should be one or three numbers above 0"),
        ({"size": 4.7}, "size = 4.7 should be one or three whole numbers above 0"),
        ({"size": np.inf}, "size = inf should be one or three whole numbers above 0"),
        ({"offset": -6}, "offset = -6 should be a whole number, at least 0"),
    ):
        with pytest.raises(BrdfkitError, match=sentence):
            bk.volumes.load(tmp_path / "b.raw", **(told | change))


# Downsampling, labels and memory


def test_downsampling_while_reading_is_that_of_the_volume(tmp_path):
    small.nifti(tmp_path / "a.nii")
    small.nifti(tmp_path / "b.nii", intent_code=1002)
    for name in ("a.nii", "b.nii"):
        whole = bk.volumes.load(tmp_path / name)
        for factor in (2, 3, 9):
            read = bk.volumes.load(tmp_path / name, downsample=factor)
            assert_alike(read, whole.resized(factor).values, whole.resized(factor).to_world)
    assert read.values.dtype == np.int16
    labels = bk.volumes.load(tmp_path / "a.nii", downsample=2, labels=True)
    assert set(labels.values.ravel()) < set(values().ravel())


@pytest.mark.parametrize("dtype", ["uint8", "float32"])
def test_means_of_what_may_be_labels_are_told(tmp_path, recwarn, dtype):
    """Not where the user says what they are, nor of many values, nor of halves."""
    given = {"size": 20, "dtype": dtype, "downsample": 2}
    tissues = np.arange(8000) // 1000
    for name, kept in {"a": tissues, "b": np.arange(8000) % 250, "c": tissues / 2 + 0.25}.items():
        kept.astype(dtype).tofile(tmp_path / f"{name}.raw")
    with pytest.warns(UserWarning, match="a has 8 different values, all whole, and was averaged"):
        bk.volumes.load(tmp_path / "a.raw", **given)
    recwarn.clear()
    for labels in (True, False):
        bk.volumes.load(tmp_path / "a.raw", **given, labels=labels)
    bk.volumes.load(tmp_path / "a.raw", **given | {"downsample": 1})
    for name in "bc" if dtype == "float32" else "b":
        bk.volumes.load(tmp_path / f"{name}.raw", **given)
    assert not recwarn.list


def test_memory_is_asked_for_before_voxels_are_read(tmp_path, monkeypatch):
    """The header of a file of 24 GB that has room for them, sparse; and what would fit."""
    size = (2000, 2000, 3000)
    header = f"NDims = 3\nDimSize = {size[0]} {size[1]} {size[2]}\nElementType = MET_SHORT\n"
    with (tmp_path / "a.mha").open("wb") as stream:
        stream.write(f"{header}ElementDataFile = LOCAL\n".encode())
        stream.truncate(2 * 2000 * 2000 * 3000 + 1000)
    have = psutil.virtual_memory()._replace(available=4_000_000_000)
    monkeypatch.setattr(psutil, "virtual_memory", lambda: have)
    said = r"its 2000×2000×3000 voxels would take about 29 GB of memory, of which 4 GB are "
    with pytest.raises(BrdfkitError, match=f"{said}available; load it with downsample=3"):
        bk.volumes.load(tmp_path / "a.mha")
    have = have._replace(available=1000)
    with pytest.raises(BrdfkitError, match="check that it is the right file"):
        bk.volumes.load(tmp_path / "a.mha")


# Bad ones


@pytest.fixture(scope="module")
def good(tmp_path_factory):
    """A file of each format, by its suffix."""
    folder = tmp_path_factory.mktemp("good")
    for name in ("a.nii", "a.nii.gz", "a.nrrd", "a.mha", "c.mha"):
        small.by_itk(folder / name, compressed=name == "c.mha")
    small.vti(folder / "a.vti", encoded=False)
    small.vti(folder / "b.vti", mode="binary", packed=False)
    for name, how in {"a.tif": {}, "b.tif": {"compression": "zlib", "metadata": None}}.items():
        tifffile.imwrite(folder / name, values(np.uint16), photometric="minisblack", **how)
    small.dicom(folder)
    box = struct.pack("<3sB5i6f", b"VOL", 3, 1, *SHAPE[::-1], 1, 0, 0, 0, 1, 1, 1)
    (folder / "a.vol").write_bytes(box + values(np.float32).tobytes())
    (folder / "a_6x5x4_int16.raw").write_bytes(values().tobytes())
    for unwanted in folder.glob("s1[678].dcm"):
        unwanted.unlink()
    return {path.name: path.read_bytes() for path in sorted(folder.iterdir())}


def assert_refused(path):
    """One sentence, which names the file."""
    with pytest.raises(BrdfkitError) as told:
        bk.volumes.load(path)
    assert path.name.partition("_")[0] in str(told.value)
    assert "\n" not in str(told.value)
    assert str(told.value).endswith(".")


def test_files_cut_short(tmp_path, good):
    """At any place."""
    assert {name.partition(".")[2] for name in good} >= {"nii", "nii.gz", "mha", "vti", "dcm"}
    for name, data in good.items():
        path = tmp_path / name
        for length in (0, 3, 100, len(data) // 2, len(data) - 40):
            path.write_bytes(data[:length])
            assert_refused(path)


@pytest.mark.parametrize(
    ("name", "old", "new", "sentence"),
    [
        ("s19.dcm", b"0.75\\0.5", b"0.7x\\0.5", r"the header of s19\.dcm is damaged"),
        ("s19.dcm", b"MONOCHROME2", b"MONOCHROME1", r"is MONOCHROME1; only MONOCHROME2"),
        ("a.nrrd", b"NRRD0004\n", b"NRRD0004#", "its NRRD header is damaged"),
        ("a.nrrd", b"origin: (10,", b"origin: (inf,", "no invertible 4×4 matrix"),
        ("a.nrrd", b"type: short", b"type: shirt", "its type 'shirt' is not read"),
        ("a.mha", b"= LOCAL", b"= a\0\x1b.z", "needs a.z beside it"),
        ("a.mha", b"MET_SHORT", b"MET_OTHER", "has 1 channels of MET_OTHER"),
        ("a.vti", b"vtkZLibDataCompressor", b"vtkLZ4DataCompressor", "packed by vtkLZ4DataCom"),
        ("a.vti", b'type="Int16"', b'type="Int17"', "its header is damaged"),
        ("a.vol", b"VOL\x03", b"VOL\x02", "has version 2 and encoding 1"),
    ],
)
def test_damaged_headers(tmp_path, good, name, old, new, sentence):
    assert old in good[name]
    (tmp_path / name).write_bytes(good[name].replace(old, new, 1))
    assert_refused(tmp_path / name)
    with pytest.raises(BrdfkitError, match=sentence):
        bk.volumes.load(tmp_path / name)


def test_a_checksum_that_differs(tmp_path, good):
    """Of gzip's last eight bytes the first four; what is damaged between may still unpack."""
    data = bytearray(good["a.nii.gz"])
    data[-8] ^= 1
    (tmp_path / "a.nii.gz").write_bytes(data)
    assert_refused(tmp_path / "a.nii.gz")


def test_files_that_are_something_else(tmp_path, good):
    """Text under each suffix; and what is mislabelled is read by what it is."""
    for name in good:
        (tmp_path / name).write_bytes(b"This is a letter, not a volume. " * 20)
        assert_refused(tmp_path / name)
    (tmp_path / "b.vol").write_bytes(good["c.mha"])
    np.testing.assert_array_equal(bk.volumes.load(tmp_path / "b.vol").values, values())
    (tmp_path / "b.vol").write_bytes(good["a.nii.gz"])
    with pytest.raises(BrdfkitError, match=r"is NIfTI by its content; rename it to \.nii"):
        bk.volumes.load(tmp_path / "b.vol")


@pytest.mark.parametrize(
    ("name", "old", "new"),
    [
        ("a.nii", struct.pack("<4h", 3, 6, 5, 4), struct.pack("<4h", 3, 30000, 30000, 30000)),
        ("a.nii", struct.pack("<4h", 3, 6, 5, 4), struct.pack("<4h", 3, 6, -5, 4)),
        ("a.nrrd", b"sizes: 6 5 4", b"sizes: 90000 90000 90000"),
        ("a.nrrd", b"sizes: 6 5 4", b"sizes: 6 5 0"),
        ("a.mha", b"DimSize = 6 5 4", b"DimSize = 90000 90000 90000"),
        ("c.mha", b"DimSize = 6 5 4", b"DimSize = 90000 90000 90000"),
        ("c.mha", b"DimSize = 6 5 4", b"DimSize = 6 5 5"),
        ("a.vti", b"0 5 0 4 0 3", b"0 90000 0 90000 0 90000"),
        ("a.vti", b"0 5 0 4 0 3", b"0 5 0 4 0 4"),
        ("a.vti", b"0 5 0 4 0 3", b"0 99999999999999999999 0 4 0 3"),
        ("b.vti", b"0 5 0 4 0 3", b"0 5 0 4 0 2"),
        ("a.vol", struct.pack("<3i", 6, 5, 4), struct.pack("<3i", 90000, 90000, 90000)),
        ("a_6x5x4_int16.raw", b"", b""),
    ],
)
def test_dimensions_that_lie(tmp_path, good, name, old, new, monkeypatch):
    """Refused before anything is allocated for the voxels."""
    if not old:
        path = tmp_path / "a_6x5x90000_int16.raw"
        path.write_bytes(good[name])
    else:
        path = tmp_path / name
        assert old in good[name]
        path.write_bytes(good[name].replace(old, new))
    empty, allocated = np.empty, []

    def recorded(shape, *args, **how):
        allocated.append(int(np.prod(shape)))
        return empty(shape, *args, **how)

    monkeypatch.setattr(np, "empty", recorded)
    assert_refused(path)
    assert max(allocated, default=0) <= 150


def test_blocks_and_pages_that_lie(tmp_path, good):
    """What lies behind the header is held to the size of the file, too."""
    path, said = tmp_path / "a.vti", "cut short or damaged"
    small.vti(path, encoded=False, wide=True)
    data, sizes = path.read_bytes(), struct.pack("<3Q", 4, 64, 48)  # blocks, of 64 bytes, the last
    assert data.count(sizes) == 1
    for lie in (sizes + struct.pack("<Q", 2**62), struct.pack("<3Q", 2**61, 0, 240) + bytes(8)):
        at = data.index(sizes)
        path.write_bytes(data[:at] + lie + data[at + len(lie) :])
        with pytest.raises(BrdfkitError, match=said):
            bk.volumes.load(path)
    bomb = zlib.compress(bytes(2**26))
    tracemalloc.start()
    path.write_bytes(data[: data.index(sizes)] + struct.pack("<4Q", 1, 240, 0, len(bomb)) + bomb)
    with pytest.raises(BrdfkitError, match="all voxels are 0"):
        bk.volumes.load(path)

    page = struct.pack("<2H2I", 257, 4, 1, SHAPE[1])  # of TIFF: its number of rows
    data, longer = good["b.tif"], struct.pack("<2H2I", 257, 4, 1, 10**8)
    at = data.index(page, data.index(page) + 1)  # of the second page
    (tmp_path / "b.tif").write_bytes(data[:at] + longer + data[at + len(page) :])
    with pytest.raises(BrdfkitError, match="cannot be read as TIFF"):
        bk.volumes.load(tmp_path / "b.tif")
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 2**25


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        (lambda v: np.where(v == 0, np.nan, v), r"1 of 120 voxels are not finite"),
        (lambda v: 0 * v, "all voxels are 0"),
        (lambda v: np.where(v == 3, np.inf, v), r"1 of 120 voxels are not finite"),
        (lambda v: v * 1e300, "of 120 voxels are not finite"),
    ],
)
def test_values_that_cannot_be_rendered(tmp_path, change, sentence):
    import nrrd

    nrrd.write(str(tmp_path / "a.nrrd"), change(values(float)), index_order="C")
    with pytest.raises(BrdfkitError, match=sentence):
        bk.volumes.load(tmp_path / "a.nrrd")


def test_what_no_format_reads(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "empty").mkdir()
    (tmp_path / "colours.tif").write_bytes(b"")
    tifffile.imwrite("colours.tif", np.zeros((4, 5, 6, 3), np.uint8), photometric="rgb")
    (tmp_path / "a.xyz").write_text("a")
    (tmp_path / "a.mha.gz").write_bytes(gzip.compress(b"ObjectType = Image"))
    for name, sentence in {
        "smok": "no file or volume 'smok'; did you mean smoke",
        "none.nii": "there is no such file",
        "empty": "the folder is empty",
        "a.xyz": r"is in no known format of volumes; the known formats are DICOM \(\.dcm",
        "colours.tif": "colours, channels or times",
        "a.mha.gz": "is MetaImage packed by gzip, which is not read; unpack it",
    }.items():
        with pytest.raises(BrdfkitError, match=sentence):
            bk.volumes.load(name)
    with pytest.raises(BrdfkitError, match="smoke is synthetic: it takes only size and downsample"):
        bk.volumes.load("smoke", dtype="uint8")
    with pytest.raises(BrdfkitError, match=r"smoke: .* of memory, .* give a smaller size"):
        bk.volumes.load("smoke", size=100_000)
    with pytest.raises(
        BrdfkitError,
        match=r"and no ndarray; make a volume of an array by brdfkit.volumes.Volume\(array\)",
    ):
        bk.volumes.load(values())


def test_a_package_that_is_missing_is_named(tmp_path, monkeypatch):
    small.nifti(tmp_path / "a.nii")
    monkeypatch.setitem(__import__("sys").modules, "nibabel", None)
    with pytest.raises(BrdfkitError, match=r'needs the package nibabel; pip install "brdfkit\[vol'):
        bk.volumes.load(tmp_path / "a.nii")


def test_the_page_of_volumes_names_what_there_is():
    page = (Path(__file__).parents[2] / "docs/volumes.md").read_text("utf-8")
    for module in list_formats():
        suffixes = " ".join(f"`{suffix}`" for suffix in module.SUFFIXES)
        assert f"| {module.NAME} | {suffixes}" in page
    for name in (*made.list_volume_names(), *list_presets()):
        assert f"`{name}`" in page
        assert name in bk.volumes.load.__doc__ or name in list_presets()


def test_no_two_formats_take_one_suffix():
    suffixes = [suffix for module in list_formats() for suffix in module.SUFFIXES]
    assert len(suffixes) == len(set(suffixes))


def test_a_sparse_file_packed_by_bzip2_is_whole(tmp_path):
    """bzip2 makes 40 bytes of millions of equal ones."""
    nrrd = pytest.importorskip("nrrd")
    sparse = np.zeros((64, 64, 64), np.uint8)
    sparse[30, 30, 30] = 200
    nrrd.write(str(tmp_path / "sparse.nrrd"), sparse, header={"encoding": "bzip2"})
    assert bk.volumes.load(tmp_path / "sparse.nrrd").values.sum() == 200


def test_names_of_a_stack_may_have_any_digits(tmp_path):
    for name in ("1²3.tif", "1²10.tif", "①.tif"):
        tifffile.imwrite(tmp_path / name, np.ones((8, 8), np.uint8))
    assert bk.volumes.load(tmp_path).values.shape == (3, 8, 8)


@pytest.mark.parametrize(("offset", "told"), [(0.0, False), (1e9, True)])
def test_rounding_to_single_precision_is_told(tmp_path, offset, told):
    nrrd = pytest.importorskip("nrrd")
    exact = offset + np.random.default_rng(0).uniform(0, 100, (6, 6, 6))
    nrrd.write(str(tmp_path / "double.nrrd"), exact)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        found = bk.volumes.load(tmp_path / "double.nrrd")
    assert np.abs(found.values - exact.T).max() <= 32
    assert any("errors up to 3" in str(w.message) for w in caught) == told
