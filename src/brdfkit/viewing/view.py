"""`view`: an interactive view of a volume, or of a material, in a notebook."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from brdfkit.core.array_types import AnyArray
from brdfkit.materials.resolve import MaterialLike
from brdfkit.viewing.choosing import make_application
from brdfkit.viewing.widget import make_widget
from brdfkit.volumes import Volume


def view(
    subject: Volume | AnyArray | MaterialLike | None = None,
    *models: MaterialLike,
    state: Mapping[str, Any] | None = None,
) -> Any:
    """Show a volume, or a material beside a model, as an interactive widget of a notebook.

    Of a volume, the widget orbits it, edits its transfer function, exchanges renderers, light and
    tone mapping, and shows slices. Of a measured material, it shows the material left and a model
    right of a wipe, with the model's parameters as sliders and a button that fits it. The picture
    converges while nothing moves. A file that is dropped on the widget is shown instead; without a
    `subject`, the widget waits for one. The command ``brdfkit view`` shows the same in a browser.

    Parameters
    ----------
    subject : Volume, ndarray, Measured, Model, Fit, str, Path or dict, optional
        The volume, its values (nz, ny, nx), or the file, folder or name that `brdfkit.volumes.load`
        takes; or the material, its name or its path. A model or a fit is shown alone unless
        `models` are given.
    *models : str, Model, Fit or Path
        The models beside a material: labels such as ``"ggx+ggx"``, models with values, or fits; by
        default ggx. The first is shown, and the page's menu begins with the others.
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
        If anywidget is not installed, for what is no volume or material, or cannot be read, and for
        a setting that does not exist or is impossible.

    Examples
    --------
    >>> bk.view("smoke")    # doctest: +SKIP
    >>> bk.view("car_paint", "ggx", "ward")    # doctest: +SKIP
    """
    return make_widget(make_application(subject, models, state))
