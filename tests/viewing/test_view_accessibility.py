"""The page of a view for everybody: axe-core finds no fault, and all of it has labels and keys."""

import pytest
from helpers.view_pages import FAULTS, THEMES, read_axe


@pytest.fixture(scope="module")
def opened(shared_page):
    """The page with everything that it can show: all panels, the slices, bumps and the wipe."""
    page = shared_page
    page.evaluate(read_axe())
    page.get_by_label("Right of the wipe").select_option(label="Isosurface")
    page.get_by_label("Drawn by").select_option(label="bumps over values and gradients")
    page.evaluate("document.querySelectorAll('details').forEach((panel) => (panel.open = true))")
    page.get_by_label("Show slices").check()
    page.get_by_label("Sun", exact=True).check()
    page.get_by_label("z slice").wait_for()
    page.get_by_role("button", name="Pause").click()
    return page


@pytest.mark.parametrize("width", [1280, 768])
@pytest.mark.parametrize("theme", THEMES)
def test_axe_finds_no_serious_fault(opened, theme, width):
    opened.set_viewport_size({"width": width, "height": 900})
    opened.emulate_media(**THEMES[theme])
    assert opened.evaluate(FAULTS) == []
    for opener, closer in (("Help", "Close"), ("Copy as Python", "Close")):
        opened.get_by_role("button", name=opener, exact=True).click()
        opened.get_by_role("dialog").wait_for()
        assert opened.evaluate(FAULTS) == []
        opened.get_by_role("dialog").get_by_role("button", name=closer).click()


def test_axe_sees_a_button_without_a_name(opened):
    button = opened.evaluate_handle(
        "document.querySelector('.status').appendChild(document.createElement('button'))"
    )
    assert opened.evaluate(FAULTS) == ["button-name: <button></button>"]
    button.evaluate("(own) => own.remove()")


def test_every_slider_has_a_label_and_a_number_box(opened):
    sliders = opened.locator("input[type=range]:visible").all()
    assert len(sliders) > 20
    for slider in sliders:
        name = slider.evaluate("(own) => own.labels[0].textContent")
        box = slider.locator("xpath=ancestor::div[1]").get_by_role("spinbutton")
        assert box.get_attribute("aria-label").startswith(name)
        assert box.input_value() == slider.get_attribute("aria-valuetext").split(" ")[0]


def test_all_is_reached_by_the_tab_key(opened):
    """Except handles, of which one is: arrow keys and Page Up reach the others."""
    beside = opened.evaluate("""() => [...document.querySelectorAll(
        "button:enabled, input:enabled, select, summary, [role=slider], .stage, .slice canvas")]
        .filter((own) => own.checkVisibility() && own.tabIndex < 0).map((own) => own.outerHTML)""")
    assert [html for html in beside if 'class="handle' not in html] == []
