"""The scene that `compare` is given: by its name, as a file, or loaded."""

from pathlib import Path

from brdfkit.core.errors import BrdfkitError, no_such
from brdfkit.mitsuba_bridge.scene_file import load_scene_file
from brdfkit.shadows.maps.scenes import SCENES, in_all_views


def load(given, size):
    """The `mitsuba.Scene` of a name in `SCENES`, of a path, or the `given` one itself.

    size : (width, height) of the pictures of a scene by name [pixels].

    Raises `BrdfkitError` for anything else, and for a file that cannot be loaded.
    """
    import mitsuba as mi

    if isinstance(given, mi.Scene):
        return given
    if not isinstance(given, str | Path):
        raise BrdfkitError(
            f"scene should be a name ({', '.join(SCENES)}), the path of a scene file of Mitsuba's "
            f"or a mitsuba.Scene, not of the type {type(given).__name__}; load it by "
            "mitsuba.load_dict."
        )
    if given in SCENES:
        return mi.load_dict(in_all_views(given, size), parallel=False)
    if not Path(given).suffix and not Path(given).exists():
        raise no_such("scene or scene file", str(given), SCENES)
    return load_scene_file(given)
