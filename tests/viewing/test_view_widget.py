"""The widget of a view: it carries the messages of a session to a notebook and back."""

import time

import pytest

import brdfkit as bk
from brdfkit.core.errors import BrdfkitError


def test_the_widget_sends_pictures_until_it_is_closed(mi, monkeypatch):
    widget = bk.view(bk.volumes.load("smoke", size=16), {"renderer": "maximum_intensity"})
    sent = []
    monkeypatch.setattr(widget, "_send_message", sent.append)
    widget.thread.add(widget.session, sent.append)
    widget._receive(None, {"type": "hello", "width": 64, "height": 64, "state": None}, [])
    end = time.monotonic() + 60
    while "picture" not in [message["type"] for message, _ in sent]:
        assert time.monotonic() < end
        time.sleep(0.05)
    assert sent[0][0]["type"] == "open"
    assert sent[0][0]["state"]["renderer"] == "maximum_intensity"
    widget.close()
    widget.thread.thread.join(20)
    assert not widget.thread.thread.is_alive()
    assert "export default { render };" in widget._esm


def test_an_impossible_state_is_refused_before_anything_is_shown(mi):
    with pytest.raises(BrdfkitError, match="raster"):
        bk.view("smoke", {"renderer": "raster"})
