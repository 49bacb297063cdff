"""Starts headless Chromium: the system's, or the one that Playwright has installed."""

import shutil
from contextlib import contextmanager
from pathlib import Path

import pytest

NAMES = "chromium", "chromium-browser", "google-chrome"


@contextmanager
def open_chromium():
    """Start the browser, and end it after the block; without one, skip the test and say why."""
    api = pytest.importorskip("playwright.sync_api", reason="Playwright is not installed")
    api.expect.set_options(timeout=30_000)  # the machine may be busy
    with api.sync_playwright() as playwright:
        own = playwright.chromium.executable_path
        found = next(filter(None, map(shutil.which, NAMES)), own if Path(own).exists() else None)
        if not found:
            pytest.skip("there is no Chromium here; install it, or 'playwright install chromium'")
        launched = playwright.chromium.launch(executable_path=found, args=["--no-sandbox"])
        yield launched
        launched.close()
