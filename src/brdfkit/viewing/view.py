"""`view`: an interactive view of a volume in a notebook, or in a browser beside a script."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from brdfkit.core.array_types import AnyArray
from brdfkit.viewing.volumes.application import VolumeApplication
from brdfkit.viewing.volumes.source import find_volume
from brdfkit.viewing.widget import make_widget
from brdfkit.volumes import Volume


def view(volume: Volume | AnyArray | str | Path, state: Mapping[str, Any] | None = None) -> Any:
    """Show a volume as an interactive widget of a notebook.

    The widget orbits the volume, edits its transfer function, exchanges renderers, light and tone
    mapping, and shows slices; its picture converges while nothing moves. The command ``brdfkit
    view`` shows the same in a browser.

    Parameters
    ----------
    volume : Volume, ndarray, str or Path
        The volume; its values (nz, ny, nx); or the file, folder or name that `brdfkit.volumes.load`
        takes.
    state : dict of str to object, optional
        The settings that differ from those with which a view begins, as the page's "Copy as
        Python" writes them.

    Returns
    -------
    anywidget.AnyWidget
        The widget. ``widget.session.state`` has the settings.

    Raises
    ------
    BrdfkitError
        If anywidget is not installed, for a volume that cannot be read, and for a setting that
        does not exist or is impossible.

    Examples
    --------
    >>> bk.view("smoke")    # doctest: +SKIP
    """
    loaded, source = find_volume(volume)
    return make_widget(VolumeApplication(loaded, source, state))
