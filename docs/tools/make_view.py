"""Makes docs/view.jpg: the page of `brdfkit view smoke`, as Chromium shows it."""

import shutil
import threading
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
    listening = server.open_socket(0)
    port = listening.getsockname()[1]
    app = server.make_app(lambda: VolumeApplication(volume, "smoke", STATE), port, "picture")
    runner = server.make_runner(app)
    thread = threading.Thread(target=runner.run, args=([listening],), daemon=True)
    thread.start()
    with sync_playwright() as playwright:
        chromium = shutil.which("chromium")  # without the system's, Playwright starts its own
        browser = playwright.chromium.launch(executable_path=chromium)
        page = browser.new_page(viewport=SIZE)
        page.goto(f"http://{server.HOST}:{port}/picture/")
        page.wait_for_function(ENOUGH, timeout=PATIENCE)
        page.screenshot(path=path, type="jpeg", quality=88)
        browser.close()
    runner.should_exit = True
    thread.join()
    app.state.thread.stop()


if __name__ == "__main__":
    make_picture(Path(__file__).parents[1] / "view.jpg")
