"""A view that is served in a thread, and its page in a browser that reaches nothing else."""

import time
from contextlib import contextmanager
from functools import partial

import pytest

import brdfkit as bk
from brdfkit.viewing import server
from brdfkit.viewing.render_thread import is_rendering
from brdfkit.viewing.volumes.application import VolumeApplication


@pytest.fixture(scope="module")
def address(module_in_llvm):
    """The address of a view that is served in a thread."""
    volume, listening = bk.volumes.load("smoke", size=16), server.open_socket(0)
    quick = {"view.scale": 0.5}  # pictures of fewer pixels
    make = partial(VolumeApplication, volume, "smoke", quick)
    with server.serve(make, listening, "the-token") as address:
        yield address
    end = time.monotonic() + 20
    while is_rendering() and time.monotonic() < end:  # Python's end would break off the last pass
        time.sleep(0.02)


@contextmanager
def open_page(browser, address):
    """A page; afterwards the console is empty, and no other host was asked for anything."""
    messages, requests = [], []
    cut = {"server": "http://127.0.0.1:9", "bypass": "127.0.0.1"}  # nothing listens there
    context = browser.new_context(viewport={"width": 900, "height": 640}, proxy=cut)
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


@pytest.fixture(scope="module")
def shared_page(browser, address):
    """A page for all tests of a file."""
    with open_page(browser, address) as tab:
        yield tab


@pytest.fixture
def page(shared_page):
    """The page of all tests of a file, with its first settings."""
    shared_page.get_by_role("button", name="Reset").click()
    samples = shared_page.locator(".samples")
    for _ in range(2):  # the first pass may still be one of the settings before
        text = samples.inner_text()
        shared_page.wait_for_function(
            "(text) => document.querySelector('.samples').textContent !== text", arg=text
        )
    return shared_page


@pytest.fixture
def new_page(browser, address):
    """A page of its own, for a test that opens another volume."""
    with open_page(browser, address) as tab:
        yield tab
