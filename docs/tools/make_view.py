"""Makes docs/view.jpg: the page of `brdfkit view smoke`, as Chromium shows it."""

import shutil
from functools import partial
from pathlib import Path

from playwright.sync_api import sync_playwright

import brdfkit as bk
from brdfkit.viewing import server
from brdfkit.viewing.volumes.application import VolumeApplication

SIZE = {"width": 1280, "height": 800}  # of the window [pixels]
STATE = {"show.slices": True, "camera.azimuth": 40.0, "light.sun": True}
# Whether the status line says that each pixel has 64 samples
ENOUGH = "() => /(\\d+) samples/.exec(document.body.innerText)?.[1] >= 64"
PATIENCE = 600_000  # [ms]


def make_picture(path: Path) -> None:
    """Serve a view, open its page, and write a picture of it when the noise is low."""
    volume = bk.volumes.load("smoke", size=128)
    make = partial(VolumeApplication, volume, "smoke", STATE)
    with server.serve(make, server.open_socket(0)) as address, sync_playwright() as playwright:
        chromium = shutil.which("chromium")  # without the system's, Playwright starts its own
        browser = playwright.chromium.launch(executable_path=chromium)
        page = browser.new_page(viewport=SIZE)
        page.goto(address)
        page.wait_for_function(ENOUGH, timeout=PATIENCE)
        page.screenshot(path=path, type="jpeg", quality=88)
        browser.close()


if __name__ == "__main__":
    make_picture(Path(__file__).parents[1] / "view.jpg")
