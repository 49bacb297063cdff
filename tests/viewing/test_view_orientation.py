"""Letters, slices and the voxel under the pointer, however a scan's voxels are stored.

The scans are made and turned by nibabel: a block is bright at the patient's left, front and top.
"""

import io

import nibabel
import numpy as np
import pytest
from nibabel.orientations import axcodes2ornt, io_orientation, ornt_transform
from PIL import Image
from scipy.spatial.transform import Rotation

import brdfkit as bk
from brdfkit.viewing.session import Session
from brdfkit.viewing.volumes.application import VolumeApplication

BLOCK = 255  # value of the block; elsewhere values are smaller
# The voxels' axes, and the degrees by which the patient is turned around x, y and z
STORED = {
    "RAS": ("RAS", (0, 0, 0)),
    "LPS": ("LPS", (0, 0, 0)),  # an axial series of DICOM
    "PSR": ("PSR", (0, 0, 0)),  # a sagittal scan
    "oblique": ("IRA", (18, -15, 20)),
    "plain": ("RAS", (0, 0, 0)),
}
# Names at the left, right, lower and upper edge, and where the block is: -1 at the left or low
PATIENT_SLICES = {
    "Axial": ("RLPA", (1, 1)),
    "Coronal": ("RLIS", (1, 1)),
    "Sagittal": ("APIS", (-1, 1)),
}
PLAIN_SLICES = {"z": ("xy", (-1, 1)), "y": ("xz", (-1, 1)), "x": ("yz", (1, 1))}


def make_scan(codes, degrees):
    """An image of nibabel's with the block, of unequal spacings, whose voxels have some axes."""
    values = np.random.default_rng(0).integers(0, 200, (10, 12, 14)).astype(np.uint8)
    values[1:3, 8:11, 10:13] = BLOCK
    affine = np.diag([1.0, 1.5, 2.5, 1.0])
    affine[:3] = Rotation.from_euler("xyz", degrees, degrees=True).as_matrix() @ affine[:3]
    turn = ornt_transform(io_orientation(affine), axcodes2ornt(codes))
    return nibabel.Nifti1Image(values, affine).as_reoriented(turn)


@pytest.fixture(params=STORED)
def view(request):
    """The session of a scan that is stored in one of the ways, and the scan."""
    scan = make_scan(*STORED[request.param])
    axes = "" if request.param == "plain" else "RAS"
    volume = bk.volumes.Volume(scan.get_fdata().T.astype(np.uint8), scan.affine, axes=axes)
    return Session(VolumeApplication(volume)), scan


def find_block(scan):
    """The voxels (n, 3) of the block."""
    return np.argwhere(scan.get_fdata() == BLOCK)


def show_slices(session, voxel):
    """The planes through a voxel, and their pictures."""
    changes = {"show.slices": True, "slices": voxel.tolist(), "slices.low": 0, "slices.high": 255}
    (message, pictures) = session.handle({"type": "set", "changes": changes})[1]
    return message["planes"], [np.asarray(Image.open(io.BytesIO(data))) for data in pictures]


@pytest.mark.parametrize(("azimuth", "nearer"), [(0, "LS"), (90, "AS")])
def test_the_letters_around_the_box(view, azimuth, nearer):
    """Of two letters at the ends of an axis, the one of the block is nearer to it."""
    session, scan = view
    changes = {"camera.azimuth": azimuth, "camera.elevation": 0.0}
    session.handle({"type": "set", "changes": changes})
    overlay = session.application.overlay(session.state, (64, 64))
    if not session.application.volume.axes:
        assert overlay["ends"] == []
        return
    block = nibabel.affines.apply_affine(scan.affine, find_block(scan).mean(axis=0))
    place = session.application.states.camera(session.state).project(block[None], 1.0)[0, :2]
    corners = np.array(overlay["corners"])[:, :2].reshape(2, 2, 2, 2)  # by the axes of the grid
    distances = {}
    for k, letter in enumerate(overlay["ends"]):
        face = corners.take(k % 2, axis=k // 2).reshape(4, 2).mean(axis=0)
        distances[letter] = np.linalg.norm(face - place)
    assert sorted(distances) == sorted("LRPAIS")
    for letter, other in zip("LAS", "RPI", strict=True):
        if letter in nearer:
            assert distances[letter] < distances[other]


def test_the_slices_are_upright(view):
    session, scan = view
    block = find_block(scan)
    planes, pictures = show_slices(session, block[0])
    expected = PATIENT_SLICES if session.application.volume.axes else PLAIN_SLICES
    assert [plane["name"] for plane in planes] == list(expected)
    for plane, picture in zip(planes, pictures, strict=True):
        ends, sides = expected[plane["name"]]
        assert "".join(plane["ends"]) == ends
        row, column = np.argwhere(picture == BLOCK).mean(axis=0) + 0.5
        height, width = picture.shape
        assert (np.sign(column / width - 0.5), np.sign(0.5 - row / height)) == sides


def test_the_voxel_under_the_pointer_is_the_one_in_the_slice(view):
    session, scan = view
    values, block = scan.get_fdata(), find_block(scan)
    _, pictures = show_slices(session, block[0])
    for number, picture in enumerate(pictures):
        height, width = picture.shape
        for row, column in np.ndindex(picture.shape):
            place = {"x": (column + 0.5) / width, "y": (row + 0.5) / height}
            probe = {"type": "probe_slice", "plane": number, **place}
            ((answer, _),) = session.handle(probe)
            assert values[tuple(answer["voxel"])] == picture[row, column]


def test_the_clipping_box_names_the_axes_of_the_patient(view):
    session, scan = view
    names = session.application.describe()[0]["volume"]["axis_names"]
    words = dict(zip("LRPAIS", ("left", "right", "back", "front", "feet", "head"), strict=True))
    opposite = dict(zip("LRPAIS", "RLAPSI", strict=True))
    patient = [
        f"{words[opposite[to]]}–{words[to]}".capitalize() for to in nibabel.aff2axcodes(scan.affine)
    ]
    assert names == (patient if session.application.volume.axes else ["x", "y", "z"])


# The page

RECORD = """() => {
    window.places = {};
    const write = CanvasRenderingContext2D.prototype.fillText;
    CanvasRenderingContext2D.prototype.fillText = function (text, x, y) {
        const name = this.canvas.getAttribute("aria-label") || "";
        window.places[name.split(" ")[0] + " " + text] = [x, y];
        return write.call(this, text, x, y);
    };
}"""
SIZES = {"Axial": (20, 24), "Coronal": (20, 36), "Sagittal": (24, 36)}  # [mm]
BLOCKS = {"Axial": (12, 4, 16, 9), "Coronal": (12, 6, 16, 15), "Sagittal": (4, 6, 9, 15)}


@pytest.fixture(scope="module")
def opened_page(shared_page, tmp_path_factory):
    """A page with the slices of an axial series, voxels of 1 × 1 × 3 mm with a white block."""
    path = tmp_path_factory.mktemp("scan") / "axial.nii"
    values = np.zeros((20, 24, 12), np.uint8)
    values[4:8, 15:20, 7:10] = BLOCK
    turn = ornt_transform(axcodes2ornt("RAS"), axcodes2ornt("LPS"))
    scan = nibabel.Nifti1Image(values, np.diag([1.0, 1.0, 3.0, 1.0])).as_reoriented(turn)
    scan.to_filename(path)
    shared_page.evaluate(RECORD)
    with shared_page.expect_file_chooser() as chooser:
        shared_page.get_by_role("button", name="Open").click()
    chooser.value.set_files(path)
    shared_page.get_by_text("20 × 24 × 12 voxels").wait_for(timeout=60_000)
    for panel in ("Show slices", "Whole volume"):
        shared_page.locator("details", has_text=panel).evaluate("(own) => (own.open = true)")
    shared_page.get_by_label("Show slices").check()
    return shared_page


@pytest.fixture
def axial_page(opened_page):
    """The page of the axial series, whose slices go through the block."""
    for plane, index in (("Axial", 8), ("Coronal", 6), ("Sagittal", 13)):
        box = opened_page.locator(".slice", has_text=plane).locator("input")
        box.fill(str(index))
        box.press("Enter")
        box.blur()  # a box that is being typed into does not follow the cross
    opened_page.wait_for_timeout(3000)  # until their pictures have come
    return opened_page


def read_indices(page):
    """The indices of the slices: sagittal, coronal, axial."""
    boxes = page.locator(".slice input")
    return [int(boxes.nth(k).input_value()) for k in (2, 1, 0)]


def test_the_page_shows_an_axial_series_upright(axial_page):
    page = axial_page
    clip = [f"{axis} {end}" for axis in ("Right–left", "Front–back") for end in ("from", "to")]
    for name in clip:
        assert page.get_by_role("spinbutton", name=name).count() == 1  # and its unit
    places = page.evaluate("window.places")
    for plane, ends in (("Axial", "RLPA"), ("Coronal", "RLIS"), ("Sagittal", "APIS")):
        left, right, lower, upper = (places[f"{plane} {end}"] for end in ends)
        assert left[0] < upper[0] < right[0]
        assert upper[1] < left[1] < lower[1]
        canvas = page.get_by_label(f"{plane} slice")
        picture = np.asarray(Image.open(io.BytesIO(canvas.screenshot())).convert("RGB"))
        size, (height, width) = SIZES[plane], picture.shape[:2]
        scale = min(width / size[0], height / size[1])
        corner = np.array([width - scale * size[0], height - scale * size[1]]) / 2
        x0, y0, x1, y1 = np.rint(scale * np.array(BLOCKS[plane]) + np.tile(corner, 2)).astype(int)
        white = picture.min(axis=2) > 128
        assert white[y0 + 1 : y1 - 1, x0 + 1 : x1 - 1].mean() > 0.75  # the cross is not white
        white[y0 - 1 : y1 + 1, x0 - 1 : x1 + 1] = False
        assert white[4:-4, 4:-4].mean() < 0.01  # the letters, without the canvas's round corners


def test_clicks_and_keys_move_the_cross_of_an_axial_series(axial_page):
    page = axial_page
    canvas = page.get_by_label("Axial slice")
    box = canvas.bounding_box()
    scale = min(box["width"] / 20, box["height"] / 24)
    # 7.5 mm from the left, 19.5 mm from the back, of which the voxels are stored the other way
    x, y = (20 - 7.5 - 10) * scale + box["width"] / 2, (24 - 19.5 - 12) * scale + box["height"] / 2
    canvas.click(position={"x": x, "y": y})
    assert read_indices(page) == [19 - 7, 23 - 19, 8]
    for plane, key, voxel in (
        ("Axial", "PageUp", [12, 4, 9]),  # towards the head
        ("Coronal", "PageUp", [12, 3, 9]),  # the front
        ("Sagittal", "PageUp", [11, 3, 9]),  # the right
        ("Axial", "ArrowRight", [12, 3, 9]),  # the left
        ("Sagittal", "ArrowLeft", [12, 2, 9]),  # the front
    ):
        page.get_by_label(f"{plane} slice").press(key)
        assert read_indices(page) == voxel
