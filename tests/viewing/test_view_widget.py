"""The widget of a view: it carries the messages of a session to a notebook and back."""

import base64
import io
import time

import numpy as np
import pytest
from PIL import Image

import brdfkit as bk
from brdfkit.core.errors import BrdfkitError


def test_the_widget_sends_pictures_until_it_is_closed(mi, monkeypatch):
    widget = bk.view(bk.volumes.load("smoke", size=16), state={"renderer": "maximum_intensity"})
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


def test_the_widget_has_a_picture_for_pages_without_python(mi):
    """Of an array here; it is rendered once."""
    values = bk.volumes.load("smoke", size=8).values
    widget = bk.view(values, state={"renderer": "maximum_intensity"})
    assert repr(widget) == "<view of volume, which a running notebook shows>"
    data, _ = widget._repr_mimebundle_()
    assert "application/vnd.jupyter.widget-view+json" in data
    assert data["text/plain"] == repr(widget)
    picture = Image.open(io.BytesIO(base64.b64decode(data["image/png"])))
    assert np.ptp(np.asarray(picture)) > 100
    assert widget._repr_mimebundle_()[0]["image/png"] is data["image/png"]
    widget.close()
    (same,) = bk.viewing.render_view(values, spp=1, size=32).pictures.values()
    assert same.shape == (32, 32, 3)


def test_an_impossible_state_is_refused_before_anything_is_shown(mi):
    with pytest.raises(BrdfkitError, match="raster"):
        bk.view("smoke", state={"renderer": "raster"})
