"""The page of a view in a browser: what is dragged, typed and chosen changes the picture."""

import io
import re

import nibabel
import numpy as np
import pytest
from helpers.view_pages import (
    SAID,
    choose,
    drag,
    number,
    pixels,
    read_address,
    type_number,
    wait_for_change,
    wait_until,
)
from PIL import Image
from playwright.sync_api import expect

DROP = """async ([name, letters]) => {
    const bytes = Uint8Array.from(atob(letters), (letter) => letter.charCodeAt(0));
    const dataTransfer = new DataTransfer();
    dataTransfer.items.add(new File([bytes], name));
    for (const type of ["dragenter", "dragover", "drop"]) {
        document.querySelector(".stage").dispatchEvent(
            new DragEvent(type, { dataTransfer, bubbles: true, cancelable: true }));
    }
}"""


WRITTEN = """() => {
    const written = [];
    const { fillText, clearRect } = CanvasRenderingContext2D.prototype;
    const isOverlay = ({ canvas }) => canvas.className === "overlay";
    Object.assign(CanvasRenderingContext2D.prototype, {
        clearRect(...place) {
            if (isOverlay(this)) written.length = 0;
            clearRect.apply(this, place);
        },
        fillText(text, x, y) {
            if (isOverlay(this)) written.push([text, x, y, this.measureText(text).width]);
            fillText.call(this, text, x, y);
        },
    });
    return written;
}"""


def test_a_drag_turns_the_volume_and_undo_turns_it_back(page):
    first = pixels(page)
    assert first.std() > 5  # something is visible
    drag(page, (200, 300), (284, 300))
    wait_for_change(page, first)
    assert "state=" in page.url
    undo = page.get_by_role("button", name="Undo")
    undo.click()
    page.get_by_text("Camera", exact=True).click()
    assert number(page, "Azimuth [°]") == 30


def test_a_renderer_is_chosen_and_a_number_is_typed(page):
    before = pixels(page)
    choose(page, "Renderer", "Isosurface")
    surface = wait_for_change(page, before)
    type_number(page, "Surface's value", 0.8)
    wait_for_change(page, surface, 0.3)


def test_the_page_says_what_it_prepares(page):
    said = page.evaluate_handle(SAID)
    choose(page, "Renderer", "Maximum intensity")
    page.wait_for_function("(said) => said.some(([text]) => text === '')", arg=said)
    # The statistics are no longer those of the old picture
    assert said.json_value()[0] == ["Preparing Maximum intensity …", ""]
    choose(page, "Right of the wipe", "Isosurface")
    assert said.json_value()[-1][0] == "Preparing Isosurface …"
    page.locator(".side.right", has_text="Isosurface").wait_for()


def test_keys_work_after_a_click_on_nothing(page):
    page.get_by_role("button", name="Redo").dblclick(force=True)
    assert page.evaluate("() => getSelection().toString()") == ""
    page.locator(".status").click()
    page.keyboard.press("1")
    page.locator("details", has_text="Field of view").evaluate("(own) => (own.open = true)")
    assert number(page, "Elevation [°]") == 0


def point_colour(page):
    """The colour of the last handle of the transfer function."""
    return page.locator(".handle").last.evaluate("(handle) => handle.style.backgroundColor")


def test_a_bump_is_dragged_typed_widened_and_removed(page):
    colour = point_colour(page)
    choose(page, "Renderer", "Emission and absorption")
    # The bumps begin as the points, which Python changes with the renderer
    wait_until(page, lambda: point_colour(page) != colour, "the points keep their colours")
    choose(page, "Drawn by", "bumps over values and gradients")
    assert page.locator(".head option:checked").first.inner_text() == "edited"
    handle = page.get_by_role("button", name="bump 1 of 1")
    assert number(page, "Value") > 0.85  # where the points have their peak
    assert number(page, "Opacity") == 1
    type_number(page, "Value", 0.5)
    page.wait_for_timeout(1000)
    before = pixels(page)
    handle.scroll_into_view_if_needed()
    box, plot = handle.bounding_box(), page.locator(".plot canvas").bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    drag(page, (x, y), (x + 60, y - 20))
    after = wait_for_change(page, before)
    low, high = 0.0, 1.0  # of the values of smoke
    shift = 60 / (plot["width"] - 40)  # the plot has margins for its numbers
    assert number(page, "Value") == pytest.approx(0.5 + (high - low) * shift, abs=0.005)
    assert "bump 1 of 1" in handle.get_attribute("aria-label")
    type_number(page, "Opacity", 0)
    wait_until(page, lambda: pixels(page).std() < after.std() / 2, "the smoke stays")
    dark = pixels(page)
    width = number(page, "Width")
    handle.focus()
    page.keyboard.press("]")
    assert number(page, "Width") == pytest.approx(1.1 * width, rel=2e-3)
    page.keyboard.press("Delete")
    page.get_by_role("button", name="Add bump").click()
    assert number(page, "Opacity") == 0.5
    wait_for_change(page, dark)
    page.get_by_role("button", name="Add bump").click()
    page.get_by_role("button", name="bump 2 of 2").wait_for()
    places = [own.get_attribute("aria-label") for own in page.locator(".handle").all()]
    assert [place.split(", ")[0] for place in places] == ["bump 1 of 2: 0.5", "bump 2 of 2: 0.25"]


def test_the_menu_says_when_the_points_are_no_longer_those_of_the_preset(page):
    preset = page.get_by_role("combobox", name="Preset")
    shown = "([own, text]) => own.selectedOptions[0].textContent === text"
    colour = point_colour(page)
    choose(page, "Preset", "intensity")
    wait_until(page, lambda: point_colour(page) != colour, "the points keep their colours")
    page.locator(".handle").last.focus()
    page.keyboard.press("ArrowDown")
    for text, button in (("edited", "Undo"), ("intensity", "Undo"), ("default", "Redo")):
        page.wait_for_function(shown, arg=[preset.element_handle(), text])
        page.get_by_role("button", name=button).click()


def test_two_points_stay(page):
    remove = page.get_by_role("button", name="Remove", exact=True)
    while remove.is_enabled():
        remove.click()
    assert page.get_by_role("button", name="point 2 of 2").count() == 1
    page.get_by_role("button", name="point 1 of 2").focus()
    type_number(page, "Value", 1)  # where the other one is, too
    assert number(page, "Value") < 1
    assert page.get_by_role("alert").count() == 0


def test_the_plot_shows_a_part_of_the_values(page):
    plot = page.locator(".plot canvas")
    plot.scroll_into_view_if_needed()
    box = plot.bounding_box()
    ends = "The plot shows values from", "The plot shows values to"
    page.mouse.move(box["x"] + 30 + (box["width"] - 40) / 4, box["y"] + 60)
    page.keyboard.down("Control")
    page.mouse.wheel(0, -500)
    page.keyboard.up("Control")
    wait_until(page, lambda: number(page, ends[1]) < 1)
    low, high = (number(page, end) for end in ends)
    assert high - low == pytest.approx(np.exp(-1), abs=1e-3)
    assert low + (high - low) / 4 == pytest.approx(0.25, abs=4e-3)  # to a pixel, it stays
    drag(page, (box["x"] + 100, box["y"] + 12), (box["x"] + 80, box["y"] + 12))
    moved = 20 / (box["width"] - 40) * (high - low)
    assert number(page, ends[0]) == pytest.approx(low + moved, abs=2e-3)
    type_number(page, ends[0], 0.5)
    handle = page.locator(".handle").first
    assert "outside" in handle.get_attribute("class")
    handle.focus()
    assert "outside" not in handle.get_attribute("class")
    page.keyboard.press("0")
    assert [number(page, end) for end in ends] == [0, 1]


def test_the_second_renderer_has_its_controls_and_the_wipe_its_keys(page):
    choose(page, "Renderer", "Maximum intensity")
    level = page.get_by_role("spinbutton", name="Surface's value")
    level.wait_for(state="hidden")
    choose(page, "Right of the wipe", "Isosurface")
    level.wait_for()
    page.wait_for_timeout(1500)
    before = pixels(page)
    page.get_by_role("slider", name="Wipe between the two pictures").focus()
    page.keyboard.press("Home")
    wait_for_change(page, before)
    assert number(page, "Wipe") == 0


def compute_grey(place):
    """The mean grey of a part of the page."""
    return np.asarray(Image.open(io.BytesIO(place.screenshot())).convert("L"), float).mean()


def test_the_target_and_the_slices(page):
    before = pixels(page)
    panel = page.locator("details", has_text="Field of view")
    panel.evaluate("(own) => (own.open = true)")
    type_number(page, "Target z", 0.4)
    wait_for_change(page, before)
    page.locator("details", has_text="Show slices").evaluate("(own) => (own.open = true)")
    page.get_by_label("Show slices").check()
    slice_ = page.get_by_label("z slice")
    slice_.wait_for()
    box = slice_.bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    grey = compute_grey(slice_)
    white = number(page, "White at")
    drag(page, (x, y), (x, y - 40), button="right")
    assert number(page, "White at") < white
    wait_until(page, lambda: compute_grey(slice_) > grey + 5, "the slice grows no brighter")


def test_the_slices_go_to_the_voxel_under_the_pointer(page):
    choose(page, "Renderer", "Isosurface")
    box = page.locator(".stage").bounding_box()
    page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    value = page.locator(".status .value", has_text="at voxel")
    value.wait_for()
    page.wait_for_timeout(3000)  # the first value may be that of the renderer before
    voxel = [int(n) for n in re.search(r"voxel (\d+), (\d+), (\d+)", value.inner_text()).groups()]
    page.locator(".stage").press("c")
    page.get_by_label("z slice").wait_for()
    boxes = page.locator(".slice input")
    assert [int(boxes.nth(k).input_value()) for k in (2, 1, 0)] == voxel


def test_the_picture_fills_the_screen_and_leaves_it(page):
    for whole in (True, False):
        page.locator(".stage").press("f")
        page.wait_for_function(
            "(whole) => Boolean(document.fullscreenElement) === whole", arg=whole
        )


def test_a_click_copies_the_command(page):
    page.get_by_role("button", name="Copy as command").click()
    dialog = page.get_by_role("dialog")
    dialog.get_by_text("It is on the clipboard.").wait_for()
    assert "brdfkit" in dialog.get_by_role("textbox").input_value()
    dialog.get_by_role("button", name="Close").click()


def test_the_picture_is_saved_as_a_file(page):
    page.get_by_text("Save", exact=True).first.click()
    with page.expect_download() as download:
        page.get_by_role("button", name="Picture (PNG)").click()
    content = Image.open(download.value.path())
    assert download.value.suggested_filename == "smoke.png"
    assert np.asarray(content).std() > 5


def test_values_become_labels_by_a_tick(new_page, tmp_path):
    path = tmp_path / "atlas.nii"
    tissues = np.indices((6, 7, 8), np.uint8).sum(0, dtype=np.uint8) // 4
    nibabel.save(nibabel.Nifti1Image(tissues, np.eye(4)), path)
    with new_page.expect_file_chooser() as chooser:
        new_page.get_by_role("button", name="Open").click()
    chooser.value.set_files(path)
    new_page.get_by_text("atlas may hold labels, not densities").wait_for(timeout=60_000)
    new_page.get_by_role("button", name="Close").click()
    before = pixels(new_page)
    box = new_page.get_by_label("Values are labels")
    box.check()
    wait_for_change(new_page, before)
    new_page.get_by_role("button", name="Undo").click()
    expect(box).not_to_be_checked(timeout=60_000)


@pytest.mark.parametrize("way", ["key", "button"])
def test_an_orbit_is_cancelled(page, way):
    files = page.get_by_role("group", name="Files and history")
    files.get_by_role("button", name="Save").click()
    files.get_by_role("button", name="Orbit (GIF)").click()
    cancel = page.get_by_role("button", name="Cancel")
    cancel.wait_for()
    page.locator(".stage").press("ArrowLeft")  # whose answer does not hide the progress
    page.wait_for_timeout(500)
    assert cancel.is_visible()
    if way == "key":
        page.locator(".stage").press("Escape")
    else:
        cancel.click()
    cancel.wait_for(state="hidden")
    page.get_by_text("Rendering the orbit").wait_for(state="hidden")


@pytest.fixture
def scan(tmp_path):
    """A file with a volume of 6 × 7 × 8 voxels."""
    path = tmp_path / "two_blocks.nii.gz"
    values = np.zeros((6, 7, 8), np.float32)
    values[1:3], values[4:] = 1, 2
    nibabel.save(nibabel.Nifti1Image(values, np.diag([2, 2, 2, 1])), path)
    return path


def check_lengths_and_labels(page):
    """Clip the volume of 12 × 14 × 16 mm, and turn it: no two labels lie over each other."""
    for panel in ("Camera", "Clipping box"):
        page.get_by_text(panel, exact=True).click()
    type_number(page, "Back–front to [mm]", 7)
    assert number(page, "Back–front to [mm]") == 7
    written = page.evaluate_handle(WRITTEN)
    for azimuth in (0, 35, 70):
        written.evaluate("(own) => (own.length = 0)")
        type_number(page, "Azimuth [°]", azimuth)
        page.wait_for_function("(own) => own.length > 0", arg=written)
        labels = written.json_value()
        assert {"S", "16 mm", "5 mm"} <= {text for text, *_ in labels}
        for k, (_, x, y, width) in enumerate(labels):
            for _, u, v, other in labels[:k]:
                assert abs(x - u) > (width + other) / 2 or abs(y - v) > 12


@pytest.mark.parametrize("way", ["dialog", "drop"])
def test_a_volume_is_opened_from_a_file(new_page, scan, way):
    assert new_page.locator(".stage").evaluate("(own) => own.matches(':focus')")
    if way == "drop":
        import base64

        new_page.evaluate(DROP, [scan.name, base64.b64encode(scan.read_bytes()).decode()])
    else:
        with new_page.expect_file_chooser() as chooser:
            new_page.get_by_role("button", name="Open").click()
        chooser.value.set_files(scan)
    new_page.get_by_text("6 × 7 × 8 voxels of 2").wait_for(timeout=60_000)
    assert number(new_page, "The plot shows values to") == 2
    if way == "drop":  # the volume of the command is not shown with its settings
        wait_until(new_page, lambda: "two_blocks" in read_address(new_page))
        new_page.reload()
        new_page.get_by_text("The address has settings of two_blocks of 6×7×8 voxels").wait_for()
        new_page.get_by_text("16 × 16 × 16 voxels").wait_for()
    else:
        check_lengths_and_labels(new_page)


def test_a_stroke_hides_and_shows_instead_of_orbiting(page):
    before = pixels(page)
    page.get_by_role("button", name="Paint", exact=True).click()
    stage, preset = page.locator(".stage"), page.get_by_role("combobox", name="Preset")
    shown = "([own, text]) => own.selectedOptions[0].textContent === text"
    box = stage.bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    page.keyboard.down("Shift")
    drag(page, (x - 20, y), (x + 20, y))
    page.keyboard.up("Shift")
    page.wait_for_function(shown, arg=[preset.element_handle(), "edited"])
    wait_for_change(page, before)
    page.get_by_role("button", name="Undo").click()
    page.wait_for_function(shown, arg=[preset.element_handle(), "default"])
    stage.focus()
    page.keyboard.press("Shift+Enter")
    page.wait_for_function(shown, arg=[preset.element_handle(), "edited"])
    drag(page, (box["x"] + 30, box["y"] + 60), (box["x"] + 40, box["y"] + 60))
    notice = page.get_by_role("alert")
    assert "stroke" in notice.inner_text()
    notice.get_by_role("button", name="Close").click()
    page.keyboard.press("p")
    assert page.get_by_role("button", name="Paint", pressed=False).count() == 1
    page.locator("details", has_text="Field of view").evaluate("(own) => (own.open = true)")
    assert number(page, "Azimuth [°]") == 30
