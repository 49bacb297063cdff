"""A view that is served in a thread, for the tests of its server and of its page."""

import threading
import time

import pytest

import brdfkit as bk
from brdfkit.viewing import server
from brdfkit.viewing.volumes.application import VolumeApplication


@pytest.fixture(scope="module")
def address(module_in_llvm):
    """The address of a view that is served in a thread."""
    volume = bk.volumes.load("smoke", size=16)
    listening = server.open_socket(0)
    port = listening.getsockname()[1]
    app = server.make_app(lambda: VolumeApplication(volume, "smoke"), port, "the-token")
    runner = server.make_runner(app)
    thread = threading.Thread(target=runner.run, args=([listening],), daemon=True)
    thread.start()
    while not runner.started:
        time.sleep(0.02)
    yield f"http://127.0.0.1:{port}/the-token/"
    runner.should_exit = True
    thread.join(20)
    app.state.thread.stop()
    listening.close()
