"""The widget of a view in Jupyter notebooks, by anywidget."""

from __future__ import annotations

from typing import Any

from brdfkit.core.errors import BrdfkitError
from brdfkit.viewing.application import Application, Message
from brdfkit.viewing.front_end import read_module, read_page_file
from brdfkit.viewing.render_thread import RenderThread
from brdfkit.viewing.session import Session


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
            self.session, self.thread = Session(application), RenderThread()
            self.on_msg(self._receive)
            self.thread.add(self.session, self._send_message)

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
