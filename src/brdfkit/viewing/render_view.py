"""`render_view`: the picture of a view's state, from a script."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from brdfkit.core.arguments import to_whole_number
from brdfkit.core.array_types import AnyArray
from brdfkit.core.jit.threads import in_turn
from brdfkit.materials.resolve import MaterialLike
from brdfkit.rendering.render_materials import to_picture_size
from brdfkit.rendering.result import Rendering
from brdfkit.viewing.choosing import make_application
from brdfkit.viewing.picture_files import render_state
from brdfkit.volumes import Volume


@in_turn
def render_view(
    subject: Volume | AnyArray | MaterialLike,
    state: Mapping[str, Any] | None = None,
    *,
    models: MaterialLike | Iterable[MaterialLike] = (),
    size: int | tuple[int, int] = 512,
    spp: int = 64,
    seed: int = 0,
) -> Rendering:
    """Render the picture that an interactive view shows in a state.

    The page's "Copy as Python" writes calls of this function.

    Parameters
    ----------
    subject : Volume, ndarray, Measured, Model, Fit, str, Path or dict
        The volume or the material, or its file, folder or name, as for `brdfkit.view`.
    state : dict of str to object, optional
        The settings that differ from those with which a view begins, by name. "light.environment"
        and "transfer.preset" may be files.
    models : str, Model, Fit or Path, or several
        The models beside a material, as for `brdfkit.view`; the first is shown.
    size : int or (int, int), default 512
        Side of the picture, or its width and height [pixels].
    spp : int, default 64
        Samples per pixel, 1 or more.
    seed : int, default 0
        Seed of the samples.

    Returns
    -------
    Rendering
        The picture; ``write`` makes a PNG, tone-mapped as on the page, or an OpenEXR file.

    Raises
    ------
    BrdfkitError
        For what is no volume or material, or cannot be read, and for a setting that does not exist
        or is impossible.

    Examples
    --------
    >>> view = {"renderer": "maximum_intensity", "camera.azimuth": 90}
    >>> brdfkit.viewing.render_view("smoke", view, spp=1, size=64)    # doctest: +SKIP
    """
    spp, seed = to_whole_number("spp", spp, 1), to_whole_number("seed", seed, 0)
    size = to_picture_size(size)
    if isinstance(models, str | dict) or not isinstance(models, Iterable):
        models = [models]
    application = make_application(subject, models, state)
    return render_state(application, application.first_state(), size, spp, seed)
