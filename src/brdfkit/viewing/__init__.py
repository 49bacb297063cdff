"""Interactive views in a browser or a notebook: `view`, and `render_view` for scripts.

`session.py` is the state machine of one page, without web code; `render_thread.py` renders its
pictures; `server.py` and `widget.py` carry its messages to the page, whose files are in `page/`.
`volumes/` is the application for volumes, `materials/` that for a material beside models, and
`choosing.py` chooses between them.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
