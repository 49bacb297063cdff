"""The widget of a view in Jupyter notebooks, by anywidget."""

from __future__ import annotations

import base64
from typing import Any

from brdfkit.core.errors import BrdfkitError
from brdfkit.viewing.application import Application, Message
from brdfkit.viewing.drops import DropSession
from brdfkit.viewing.encoding import encode_png
from brdfkit.viewing.front_end import read_module, read_page_file
from brdfkit.viewing.picture_files import render_state
from brdfkit.viewing.render_thread import RenderThread

STILL_SIZE, STILL_SAMPLES = (256, 256), 16  # of the picture beside the widget


def make_widget(application: Application) -> Any:
    """Return the widget of a view; raise `BrdfkitError` if anywidget is missing."""
    try:
        import anywidget
    except ImportError:
        raise BrdfkitError(
            'A view in a notebook needs anywidget: pip install "brdfkit[notebook]".'
        ) from None

    class View(anywidget.AnyWidget):
        """An interactive view; its `session` has the state."""

        _esm = read_module()
        _css = read_page_file("viewer.css")

        def __init__(self) -> None:
            super().__init__()
            self.session, self.thread = DropSession(application), RenderThread()
            self._still = ""
            self.on_msg(self._receive)
            self.thread.add(self.session, self._send_message)

        def __repr__(self) -> str:
            return f"<view of {self.session.application.name}, which a running notebook shows>"

        def _repr_mimebundle_(self, **options: Any) -> Any:
            """Return the widget, with a picture for where no Python runs behind the notebook."""
            bundle: Any = super()._repr_mimebundle_(**options)
            data, metadata = bundle
            return data | {"image/png": self._draw_still()}, metadata

        def _draw_still(self) -> str:
            """Return a small picture of the settings when it is first drawn: a PNG in base 64."""
            if not self._still and self.session.application.sides(self.session.state):
                shown, state = self.session.application, self.session.state
                rendering = render_state(shown, state, STILL_SIZE, STILL_SAMPLES)
                (picture,) = rendering.pictures.values()
                colours = shown.develop(state, {0: picture}, False)[0]
                self._still = base64.b64encode(encode_png(colours)).decode()
            return self._still

        def _receive(self, _: Any, message: dict[str, Any], buffers: list[Any]) -> None:
            data = bytes(buffers[0]) if buffers else b""
            for answer in self.session.handle(message, data):
                self._send_message(answer)
            self.thread.wake()

        def _send_message(self, message: Message) -> None:
            content, buffers = message
            self.send(content, buffers)

        def close(self) -> None:
            """Stop to render, and remove the widget."""
            self.thread.stop()
            super().close()

    return View()
