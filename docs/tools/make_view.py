"""Makes docs/view.jpg and docs/how_to/view_material.jpg: pages of `brdfkit view` in Chromium."""

import shutil
from collections.abc import Callable
from functools import partial
from pathlib import Path

from playwright.sync_api import Browser, Page, sync_playwright

import brdfkit as bk
from brdfkit.viewing import server
from brdfkit.viewing.application import Application
from brdfkit.viewing.materials.application import MaterialApplication
from brdfkit.viewing.volumes.application import VolumeApplication

DOCS = Path(__file__).parents[1]
SIZE = {"width": 1280, "height": 800}  # of the window [pixels]
VOLUME = {"show.slices": True, "camera.azimuth": 40.0, "light.sun": True}
MODELS = ["ggx", "ward", "ggx+ggx"]
# Whether the status line says that each pixel has 64 samples; a fit says how many it has, too
ENOUGH = "() => /(\\d+) samples ·/.exec(document.body.innerText)?.[1] >= 64"
PATIENCE = 600_000  # [ms]


def fit_all(page: Page) -> None:
    """Fit all models on the page of a material, and wait for the table of their errors."""
    page.get_by_text("samples ·").wait_for(timeout=PATIENCE)
    page.get_by_role("button", name="Fit all").click()
    page.locator("table.errors").wait_for(timeout=PATIENCE)
    page.get_by_role("button", name="Cancel").wait_for(state="hidden", timeout=PATIENCE)


def make_picture(
    browser: Browser,
    path: Path,
    make_application: Callable[[], Application],
    prepare: Callable[[Page], None] = lambda page: None,
) -> None:
    """Serve a view, open and prepare its page, and write a picture of it when the noise is low."""
    with server.serve(make_application, server.open_socket(0)) as address:
        page = browser.new_page(viewport=SIZE)
        page.goto(address)
        prepare(page)
        page.wait_for_function(ENOUGH, timeout=PATIENCE)
        page.screenshot(path=path, type="jpeg", quality=88)
        page.close()


def make_pictures() -> None:
    """Write both pictures."""
    volume = bk.volumes.load("smoke", size=128)
    with sync_playwright() as playwright:
        chromium = shutil.which("chromium")  # without the system's, Playwright starts its own
        browser = playwright.chromium.launch(executable_path=chromium)
        smoke = partial(VolumeApplication, volume, "smoke", VOLUME)
        make_picture(browser, DOCS / "view.jpg", smoke)
        paint = partial(MaterialApplication, "car_paint", MODELS)
        make_picture(browser, DOCS / "how_to" / "view_material.jpg", paint, fit_all)
        browser.close()


if __name__ == "__main__":
    make_pictures()
