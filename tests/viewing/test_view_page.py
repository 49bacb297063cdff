"""The page of a view in a browser: what is dragged, typed and chosen changes the picture."""

import io

import nibabel
import numpy as np
import pytest
from PIL import Image


@pytest.fixture
def page(browser, address):
    """The page; afterwards the console is empty, and no other host was asked for anything."""
    messages, requests = [], []
    context = browser.new_context(viewport={"width": 900, "height": 640})
    tab = context.new_page()
    tab.on("console", lambda message: messages.append(message.text))
    tab.on("pageerror", lambda error: messages.append(str(error)))
    tab.on("request", lambda request: requests.append(request.url))
    tab.goto(address)
    tab.get_by_text("samples ·").wait_for(timeout=90_000)
    yield tab
    context.close()
    assert messages == []
    host = address.split("/")[2]
    assert [url for url in requests if not url.startswith(("blob:", f"http://{host}/"))] == []


def pixels(page):
    """The pixels of the picture (height, width, 3)."""
    shot = page.locator("canvas").first.screenshot()
    return np.asarray(Image.open(io.BytesIO(shot)).convert("RGB"), float)


def wait_for_change(page, before, least=1.0):
    """Wait until the picture differs from another one by a mean of `least`."""
    for _ in range(200):
        now = pixels(page)
        if np.abs(now - before).mean() > least:
            return now
        page.wait_for_timeout(100)
    raise AssertionError("the picture does not change")


def test_a_drag_turns_the_volume_and_undo_turns_it_back(page):
    first = pixels(page)
    assert first.std() > 5  # something is visible
    page.mouse.move(200, 300)
    page.mouse.down()
    for step in range(8):
        page.mouse.move(200 + 12 * step, 300)
    page.mouse.up()
    wait_for_change(page, first)
    assert "state=" in page.url
    page.get_by_role("button", name="Undo").click()
    page.get_by_role("button", name="Undo").wait_for(state="attached")
    page.wait_for_function("() => document.querySelector('button[disabled]') !== null")


def test_a_renderer_is_chosen_and_a_number_is_typed(page):
    before = pixels(page)
    page.get_by_label("Renderer").select_option(label="Isosurface")
    surface = wait_for_change(page, before)
    level = page.get_by_role("spinbutton", name="Surface's value")
    level.fill("0.8")
    level.press("Enter")
    wait_for_change(page, surface, 0.3)


def test_a_volume_is_opened_from_a_file(page, tmp_path):
    path = tmp_path / "two_blocks.nii.gz"
    values = np.zeros((6, 7, 8), np.float32)
    values[1:3], values[4:] = 1, 2
    nibabel.save(nibabel.Nifti1Image(values, np.diag([2, 2, 2, 1])), path)
    with page.expect_file_chooser() as chooser:
        page.get_by_role("button", name="Open").click()
    chooser.value.set_files(path)
    page.get_by_text("6 × 7 × 8 voxels of 2").wait_for(timeout=60_000)


def test_the_picture_is_saved_as_a_file(page):
    page.get_by_text("Save", exact=True).first.click()
    with page.expect_download() as download:
        page.get_by_role("button", name="Picture (PNG)").click()
    content = Image.open(download.value.path())
    assert download.value.suggested_filename == "smoke.png"
    assert np.asarray(content).std() > 5
