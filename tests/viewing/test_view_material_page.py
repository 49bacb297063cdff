"""The page of a material beside a model in a browser: sliders, models, the fit, the light."""

import time
from functools import partial

import numpy as np
import pytest
from helpers.view_pages import (
    FAULTS,
    SAID,
    THEMES,
    choose,
    drag,
    number,
    pixels,
    read_axe,
    type_number,
    wait_for_change,
)
from mirrored_samples import mirrored_samples
from playwright.sync_api import expect

import brdfkit as bk
from brdfkit.viewing import server
from brdfkit.viewing.materials.application import MaterialApplication
from brdfkit.viewing.render_thread import is_rendering

WATCH_VALUES = """box => {
    window.values = [];
    const watcher = new MutationObserver(() => values.push(box.ariaValueNow));
    watcher.observe(box, { attributeFilter: ["aria-valuenow"] });
}"""


@pytest.fixture(scope="module")
def address(module_in_llvm):
    """The address of a view of a material, with pictures of few pixels."""
    quick = {"view.scale": 0.25, "view.moving_scale": 0.25}
    make = partial(MaterialApplication, "car_paint", ["ggx"], quick)
    with server.serve(make, server.open_socket(0), "the-token") as address:
        yield address
    end = time.monotonic() + 20
    while is_rendering() and time.monotonic() < end:  # Python's end would break off the last pass
        time.sleep(0.02)


def test_the_page_has_what_is_about_materials_alone(page):
    assert page.get_by_role("button", name="Paint").count() == 0
    summaries = page.locator("summary:visible").all_inner_texts()
    assert summaries == [
        *(
            "Audit of the file",
            "Model and fit",
            "Fit settings",
            "Diffuse term",
            "Highlight",
            "Picture",
            "Light",
            "Tone mapping",
        )
    ]
    page.get_by_role("button", name="Help").click()
    text = page.get_by_role("dialog").inner_text()
    assert ("turn the light" in text, "Slices" in text, "orbit" in text) == (True, False, False)
    page.get_by_role("dialog").get_by_role("button", name="Close").click()


def test_a_slider_changes_the_model_and_a_tie_passes_it_on(page):
    first = pixels(page)
    slider = page.get_by_role("slider", name="α_u", exact=True)
    slider.focus()
    for key in (*["PageDown"] * 3, *["ArrowLeft"] * 3):
        page.keyboard.press(key)
    wait_for_change(page, first)
    assert slider.get_attribute("aria-valuetext") == str(number(page, "α_u"))
    page.wait_for_function("() => !document.querySelector('.idle')?.matches(':focus-within')")
    assert number(page, "α_v") == number(page, "α_u") < 0.2
    page.get_by_text("It equals α_u: the material is isotropic.").wait_for()
    type_number(page, "α_v", 0.5)
    page.get_by_text("It equals α_u").wait_for(state="detached")
    assert not page.get_by_label("α_v equal to α_u").is_checked()


def test_undo_in_a_number_box_is_the_pages(page, monkeypatch):
    change = MaterialApplication.change

    def change_slowly(*arguments):
        time.sleep(0.2)
        return change(*arguments)

    monkeypatch.setattr(MaterialApplication, "change", change_slowly)  # as on a busy machine
    type_number(page, "α_u", 0.05)
    type_number(page, "α_u", 1)
    box = page.get_by_role("spinbutton", name="α_u", exact=True)
    box.evaluate(WATCH_VALUES)
    box.press("Control+z")
    expect(box).to_have_value("0.05")
    box.fill("7")  # is not taken over, and so no step
    box.press("Control+z")
    expect(box).to_have_value("0.05")
    box.press("Control+y")
    expect(box).to_have_value("1")
    page.get_by_role("button", name="Undo").click()
    expect(box).to_have_value("0.05")
    # And not, between, what Python said before it had the undo
    assert page.evaluate("values") == ["0.05", "1", "0.05"]


def test_a_number_box_says_what_it_does_not_take(page):
    box = page.get_by_role("spinbutton", name="α_u", exact=True)
    note = page.locator(".slider", has=box).get_by_role("status")
    box.fill("")
    box.press_sequentially("0,3")
    box.press("Enter")
    assert (box.input_value(), note.inner_text()) == ("0.3", "")
    box.press("ArrowUp")
    assert box.input_value() == "0.3001"
    for typed, shown, says in (
        ("5", "1", "α_u is between 0.001 and 1."),
        ("-1", "0.001", "α_u is between 0.001 and 1."),
        ("much", "0.001", "“much” is no number."),
        ("0.2", "0.2", ""),
    ):
        type_number(page, "α_u", typed)
        assert (box.input_value(), note.inner_text()) == (shown, says)


def test_a_typed_sum_brings_its_parameters(page):
    box = page.get_by_role("combobox", name="Model", exact=True)
    box.fill("ggx+war")
    page.get_by_role("option", name="ggx+ward A highlight with").wait_for()
    box.press("Enter")
    page.get_by_text("Highlight 2").wait_for()
    page.get_by_role("button", name="About the model").click()
    about = page.get_by_role("dialog", name="About ggx and ward")
    assert "4π α" in about.locator(".formula").last.inner_text()
    about.get_by_role("button", name="Close").click()
    assert box.input_value() == "ggx+ward"
    box.fill("gxx")
    box.press("Enter")
    page.get_by_role("alert").get_by_text("did you mean ggx").wait_for()
    page.get_by_role("button", name="Close").click()
    box.fill("slopes, isotropic")  # words of a description
    box.press("ArrowDown")
    page.get_by_role("option", name="ward ", exact=False).first.click()
    page.get_by_text("Highlight 2").wait_for(state="detached")
    assert box.input_value() == "ward"
    page.get_by_role("button", name="Undo").click()
    page.get_by_text("Highlight 2").wait_for()


def test_a_drag_turns_the_light(page):
    first = pixels(page)
    drag(page, (150, 300), (250, 300))
    wait_for_change(page, first)
    assert number(page, "Rotation [°]") == 50
    page.locator(".stage").focus()
    page.keyboard.press("ArrowLeft")
    page.wait_for_function("() => location.hash")
    assert number(page, "Rotation [°]") == 45


def test_a_drag_moves_the_lamp_and_the_right_button_the_view(page):
    said = page.evaluate_handle(SAID)
    choose(page, "Light", "a lamp")
    assert said.json_value()[0] == ["Preparing car_paint and ggx …", ""]
    expect(page.get_by_role("spinbutton", name="Rotation [°]")).to_be_hidden()
    drag(page, (150, 150), (170, 130))
    assert (number(page, "Lamp, around [°]"), number(page, "Lamp, above [°]")) == (-44, 49)
    page.keyboard.press("ArrowDown")
    assert number(page, "Lamp, above [°]") == 44
    drag(page, (150, 150), (50, 150), button="right")
    assert number(page, "View, around [°]") == 50
    expect(page.locator(".lamp")).to_be_visible(timeout=20_000)
    page.keyboard.press("r")
    assert (number(page, "Lamp, above [°]"), number(page, "View, around [°]")) == (39, 0)


def test_both_sides_are_compared_and_enlarged_in_step(page):
    names = page.locator(".caption:visible")
    choose(page, "Compare", "side by side")
    expect(names).to_have_text(["car_paint", "ggx"])
    expect(page.locator(".wipe")).to_be_hidden()
    choose(page, "Compare", "flicker: in turn")
    for name in ("ggx", "car_paint"):
        expect(names).to_have_text([name])
    page.emulate_media(reduced_motion="reduce")
    page.wait_for_timeout(600)  # a turn, after which nothing moves
    expect(names).to_have_text(["car_paint"])
    page.locator(".stage").focus()
    page.keyboard.down("x")
    expect(names).to_have_text(["ggx"])
    page.keyboard.up("x")
    expect(names).to_have_text(["car_paint"])
    for focus in ("label:has-text('channels linked') input", "summary", "body"):
        page.locator(focus).first.evaluate("(own) => (document.activeElement.blur(), own.focus())")
        page.keyboard.down("x")
        expect(names).to_have_text(["ggx"])
        page.keyboard.up("x")
        expect(names).to_have_text(["car_paint"])
    page.emulate_media(reduced_motion="no-preference")
    choose(page, "Compare", "ΔE map")
    expect(page.locator(".scale")).to_contain_text("95 % below")

    whole = pixels(page)
    page.mouse.move(100, 300)
    page.mouse.wheel(0, -500)
    enlarged = wait_for_change(page, whole)
    drag(page, (300, 300), (200, 300), button="middle")
    wait_for_change(page, enlarged)
    page.keyboard.press("0")
    expect(page.locator(".scale")).to_be_visible()
    assert np.abs(pixels(page) - whole).mean() < 5


def test_the_colours_under_the_pointer_are_those_of_the_picture(page):
    value = page.locator(".status .value")
    page.mouse.move(200, 200)  # beside the wipe
    expect(value).to_contain_text("RGB of car_paint")
    before = value.inner_text()
    page.locator(".stage").focus()
    page.keyboard.press("ArrowLeft")
    expect(value).not_to_have_text(before)
    page.get_by_role("button", name="Undo").hover()
    expect(value).to_have_text("")


def test_an_error_stands_below_the_labels_until_the_next_action(page):
    box = page.get_by_role("combobox", name="Model", exact=True)
    box.fill("gxx")
    box.press("Enter")
    notice = page.get_by_role("alert")
    top = notice.bounding_box()["y"]
    for label in page.locator(".side:visible").all():
        below = label.bounding_box()
        assert below["y"] + below["height"] <= top
    type_number(page, "α_u", 0.3)
    expect(notice).to_have_count(0)
    expect(page.get_by_role("button", name="Picture on the whole screen")).to_be_visible()


def test_a_fit_moves_and_marks_the_sliders_and_shows_errors(page):
    page.get_by_role("button", name="Fit", exact=True).click()
    page.locator("table.errors").wait_for(timeout=60_000)
    assert number(page, "α_u") == pytest.approx(0.1148, abs=1e-4)
    slider = page.get_by_role("slider", name="α_u", exact=True)
    assert "fitted: 0.1148 ± 0.00022" in slider.get_attribute("aria-description")
    mark = page.locator(".slider", has_text="α_u").first.locator(".mark span").bounding_box()
    track = slider.bounding_box()
    share = (mark["x"] + mark["width"] / 2 - track["x"] - 8) / (track["width"] - 16)
    assert share == pytest.approx(float(slider.input_value()) / 400, abs=0.02)
    rows = page.locator("table.errors tbody th").all_inner_texts()
    assert rows == ["ggx", "noise"]
    type_number(page, "α_u", 0.3)
    # Back to the fitted value
    page.locator(".name", has_text="α_u").first.dblclick(position={"x": 5, "y": 5})
    assert number(page, "α_u") == pytest.approx(0.1148, abs=1e-4)
    page.get_by_role("button", name="Copy as Python").click()
    assert "brdfkit.fit(" in page.get_by_role("dialog").get_by_role("textbox").input_value()
    page.get_by_role("dialog").get_by_role("button", name="Close").click()


def test_a_pin_has_its_error_and_the_heads_of_the_table_sort(page):
    pin = page.get_by_role("button", name="Pin", exact=True)
    pin.click()
    type_number(page, "α_u", 0.5)
    entry = page.get_by_role("list", name="Pins").get_by_role("listitem").first
    row = page.get_by_role("row", name="1 ggx")
    row.wait_for()
    head = page.get_by_role("columnheader", name="plain").get_by_role("button")
    head.focus()
    pin.evaluate("button => button.click()")  # its errors replace the head that has the focus
    page.get_by_role("row", name="2 ggx").wait_for()
    page.get_by_text("is best by cbrt").wait_for()
    assert entry.locator(".error").inner_text() == row.get_by_role("cell").nth(2).inner_text()
    page.keyboard.press("Enter")
    page.keyboard.press("Enter")
    sorted_by = page.locator("th[aria-sort=descending]")
    assert sorted_by.inner_text() == "plain"
    assert page.locator("table.errors tbody tr").last.inner_text().startswith("noise")
    back = page.get_by_role("button", name="α_u back to")
    value = back.get_attribute("aria-label").split()[-1]
    back.click()
    assert number(page, "α_u") == float(value)
    left = page.get_by_role("button", name="Left of the wipe: pin 2")
    left.click()
    page.locator(".side.left", has_text="2: ggx").wait_for()
    left.click()
    entry.get_by_role("button", name="Show pin 1").click()
    page.get_by_role("button", name="Remove pin 1").click()
    page.get_by_role("button", name="Remove pin 1").wait_for(state="detached")


@pytest.mark.parametrize("theme", THEMES)
def test_axe_finds_no_serious_fault(page, theme):
    page.evaluate(read_axe())
    page.evaluate("document.querySelectorAll('details').forEach((panel) => (panel.open = true))")
    page.emulate_media(**THEMES[theme])
    assert page.evaluate(FAULTS) == []


def test_plots_open_and_mark_what_is_selected(page):
    for name in ("Slices", "Albedo", "Samples"):
        page.get_by_role("button", name=name, exact=True).click()
    page.get_by_role("img", name="Lobes for light at 45°. car_paint: largest at").wait_for()
    page.get_by_role("img", name="ggx / data: typically a factor of").wait_for()
    page.get_by_role("img", name="Albedo, luminance. car_paint: 0.").wait_for()
    page.get_by_role("img", name="2,500 samples").wait_for()
    page.get_by_role("application", name="Samples; arrow keys").focus()
    for key in ("ArrowLeft", "Enter", *["ArrowDown"] * 12, "ArrowRight", "Enter"):
        page.keyboard.press(key)
    chosen = page.get_by_role("region", name="Selection")
    expect(chosen).to_contain_text("samples")
    page.keyboard.press("Escape")
    expect(chosen).to_be_hidden()
    page.get_by_role("button", name="Undo").click()
    expect(chosen).to_contain_text("Farthest first, by ggx / car_paint")
    page.evaluate(read_axe())
    assert page.evaluate(FAULTS) == []
    page.get_by_role("button", name="Clear").click()


def test_the_light_of_the_lobes_is_dragged(page):
    box = page.locator(".plot-polar .surface").bounding_box()
    radius = min(box["width"] / 2 - 30, box["height"] - 42)
    centre = box["x"] + box["width"] / 2, box["y"] + 22 + radius
    centre = centre[0], centre[1] + max((box["height"] - 42 - radius) / 2, 0)
    at = [
        (centre[0] - radius * np.sin(angle), centre[1] - radius * np.cos(angle))
        for angle in np.radians([45, 20])
    ]
    drag(page, *at)
    page.get_by_role("img", name="Lobes for light at 20°").wait_for()
    assert number(page, "θi [°]") == 20
    page.get_by_role("button", name="Undo").click()
    page.get_by_role("img", name="Lobes for light at 45°").wait_for()


def test_a_mirrored_file_is_mended_by_its_button(page, tmp_path):
    """It is dropped on the page, which then shows it; so this test is the last one."""
    bk.save(mirrored_samples(), tmp_path / "mirrored.csv")
    with page.expect_file_chooser() as chooser:
        page.get_by_role("button", name="Open…").click()
    chooser.value.set_files(tmp_path / "mirrored.csv")
    panel = page.locator(".audit")
    expect(panel).to_contain_text("Highlight towards the light", timeout=60_000)
    expect(panel).to_contain_text("CSV, 192 samples")
    click = "(own) => (own.click(), [own.disabled, own.closest('.audit').textContent])"
    disabled, text = panel.get_by_role("button", name="Mirror azimuths").evaluate(click)
    assert (disabled, "Examining the mended file …" in text) == (True, True)
    expect(page.get_by_label("Mirror azimuths")).to_be_checked()
    expect(page.get_by_label("Right of the wipe")).to_have_value("mirrored as the file says")
    panel.get_by_role("button", name="Show ggx there").click()
    expect(page.get_by_label("Right of the wipe")).to_have_value("ggx")
