"""Starts headless Chromium: the system's, or the one that Playwright has installed."""

import shutil
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from functools import cache
from pathlib import Path

import pytest

NAMES = "chromium", "chromium-browser", "google-chrome"

_started = ExitStack()


@cache
def start_chromium():
    """Start the browser of this process; without one, skip the test and say why."""
    api = pytest.importorskip("playwright.sync_api", reason="Playwright is not installed")
    api.expect.set_options(timeout=30_000)  # the machine may be busy
    playwright = _started.enter_context(api.sync_playwright())
    own = playwright.chromium.executable_path
    found = next(filter(None, map(shutil.which, NAMES)), own if Path(own).exists() else None)
    if not found:
        pytest.skip("there is no Chromium here; install it, or 'playwright install chromium'")
    launched = playwright.chromium.launch(executable_path=found, args=["--no-sandbox"])
    _started.callback(launched.close)
    return launched


def stop_chromium():
    """End the browser, if it was started."""
    _started.close()
    start_chromium.cache_clear()


def execute_beside_chromium(client):
    """Execute the notebook of a client in a thread of its own: Playwright's event loop stays in
    this one, where no other may run."""
    from jupyter_core.utils import ensure_event_loop

    def execute():
        try:
            client.execute()
        finally:
            ensure_event_loop().close()

    with ThreadPoolExecutor(1) as threads:
        threads.submit(execute).result()
