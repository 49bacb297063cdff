"""`compare`: techniques of shadow maps on a scene of the user's, scored against exact shadows."""

import itertools
from collections.abc import Callable, Iterable
from typing import Any

from brdfkit.errors import BrdfkitError, no_such
from brdfkit.jit.llvm import use_variant
from brdfkit.rendering.scene_file import load_scene_file
from brdfkit.shadow_maps.placement import Placement
from brdfkit.shadow_maps.techniques import FILES
from brdfkit.shadows.comparison import ShadowComparison
from brdfkit.shadows.measuring import score
from brdfkit.shadows.seen import Seen

PROJECTIONS = tuple(FILES["projection"])
FILTERS = "depth", "percentage_closer", "variance", "moment"


def compare(
    scene: Any,
    projections: Iterable[str] = PROJECTIONS,
    filters: Iterable[str] = FILTERS,
    partitions: Iterable[str] = ("whole",),
    resolution: int = 512,
    size: tuple[int, int] = (512, 512),
    progress: Callable[[int, int], object] | None = None,
) -> ShadowComparison:
    """Compare techniques of shadow maps with exact shadows, in all views and lights of a scene.

    Parameters
    ----------
    scene : path or mitsuba.Scene
        A scene file of Mitsuba's (.xml), or a loaded scene. Its lights are point, spot or
        directional ones, its cameras perspective ones; each camera is a view.
    projections, filters, partitions : iterable of str
        Names of techniques, of which every combination is scored; see the plugin `shadow_map`.
    resolution : int, default 512
        Texels along a side of each map.
    size : (int, int), default (512, 512)
        Width and height of the pictures [pixels].
    progress : callable, optional
        Called with (done, total); see `brdfkit.progress`.

    Returns
    -------
    ShadowComparison
        The scores of each technique; prints as a table.

    Raises
    ------
    BrdfkitError
        For a name that is no technique, and for a scene without a camera or with other lights.

    Examples
    --------
    >>> bk.shadows.compare("street.xml", ["focused", "trapezoidal"])    # doctest: +SKIP
    """
    use_variant()
    named = {"projection": projections, "filter": filters, "partition": partitions}
    techniques = combinations({kind: tuple(names) for kind, names in named.items()})
    scene = scene if hasattr(scene, "sensors") else load_scene_file(scene)
    if not scene.emitters():
        raise BrdfkitError("the scene has no light; add a point, spot or directional one.")
    places = list(itertools.product(scene.sensors(), scene.emitters()))
    found: dict[str, list] = {label: [] for label in techniques}
    for number, (sensor, emitter) in enumerate(places):
        seen = Seen.by(scene, sensor, emitter, size[::-1])
        placement = Placement.of_scene(scene, sensor, emitter)
        for done, (label, technique) in enumerate(techniques.items(), number * len(techniques)):
            if progress:
                progress(done, len(places) * len(techniques))
            scores, _ = score(seen, placement, {**technique, "resolution": resolution})
            found[label].append(scores)
    lights = len(scene.emitters())
    return ShadowComparison({label: tuple(all_of) for label, all_of in found.items()}, lights)


def combinations(names):
    """Label → keyword arguments of `LightShadow`, of all combinations of `names` by kind.

    What all have in common is not in the label. Raises `BrdfkitError` for an unknown name.
    """
    for kind, its in names.items():
        for name in its:
            if name not in FILES[kind]:
                raise no_such(kind, name, FILES[kind])
    several = [kind for kind, its in names.items() if len(its) > 1] or ["projection"]
    chosen = [
        dict(zip(names, picked, strict=True)) for picked in itertools.product(*names.values())
    ]
    return {" + ".join(each[kind] for kind in several): each for each in chosen}
