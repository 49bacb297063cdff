"""`compare`: techniques of shadow maps on a scene of the user's, scored against exact shadows."""

from __future__ import annotations

import itertools
from collections.abc import Iterable
from functools import partial
from typing import Any

import numpy as np

from brdfkit.core.errors import BrdfkitError, no_such
from brdfkit.core.jit.llvm import use_variant
from brdfkit.core.jit.loops import raise_first_cause
from brdfkit.core.progress_bar import Progress
from brdfkit.mitsuba_bridge.registration.registering import refuse_scalar
from brdfkit.shadows.comparison.arguments import to_names, to_scene, to_size, to_texels
from brdfkit.shadows.comparison.comparison import ShadowComparison
from brdfkit.shadows.comparison.exact_shadow import Seen
from brdfkit.shadows.comparison.map_pictures import MapPictures
from brdfkit.shadows.comparison.pictures import Pictures, title_of
from brdfkit.shadows.comparison.scores import Scores
from brdfkit.shadows.comparison.scoring import score
from brdfkit.shadows.comparison.tracked_points import Watched
from brdfkit.shadows.comparison.without_maps import OTHERS
from brdfkit.shadows.maps.light_shadow import LightShadow
from brdfkit.shadows.maps.placement import Placement
from brdfkit.shadows.maps.techniques import FILES

PROJECTIONS = tuple(FILES["projection"])
FILTERS = "depth", "percentage_closer", "variance", "moment"


def compare(
    scene: Any,
    projections: Iterable[str] | None = None,
    *,
    filters: Iterable[str] | None = None,
    partitions: Iterable[str] = ("whole",),
    others: Iterable[str] = (),
    resolution: int = 512,
    size: tuple[int, int] = (512, 512),
    progress: Progress | None = None,
) -> ShadowComparison:
    """Compare shadow techniques with exact shadows, in all views and lights of a scene.

    Ctrl-C ends with the views and lights that are finished; in the first of them, with the
    techniques that are.

    Parameters
    ----------
    scene : path, str or mitsuba.Scene
        A scene file of Mitsuba's (.xml), or a loaded scene. Its lights are point, spot or
        directional ones, its cameras perspective ones; each camera is a view. Or the name of a
        scene that comes with brdfkit, of four views and two suns: ``"street"``, ``"foliage"`` or
        ``"objects_on_a_ground"``.
    projections : iterable of str, optional
        Names of projections, by default all. Every combination of projections, filters and
        partitions is scored; the plugin `shadow_map` lists them.
    filters : iterable of str, optional
        Names of filters, by default depth, percentage_closer, variance and moment.
    partitions : iterable of str, default ("whole",)
        Names of partitions.
    others : iterable of str, default ()
        Techniques that look up no map: ``"shadow_volume"`` and ``"hybrid_shadow"``; see the plugins
        of these names.
    resolution : int, default 512
        Texels along a side of each map.
    size : (int, int), default (512, 512)
        Width and height of the pictures [pixels].
    progress : callable, optional
        Called with (done, total); see `brdfkit.progress`.

    Returns
    -------
    ShadowComparison
        The scores of each technique; prints as a table, and `write` makes a page with pictures.

    Raises
    ------
    BrdfkitError
        For a name that is no technique or no scene, for a scene without a camera or with other
        lights, for one in which nothing that is seen is in a light, and for shapes that have no
        shadow volume where one is asked for.

    Examples
    --------
    >>> bk.shadows.compare("street", ["focused", "trapezoidal"])    # doctest: +SKIP
    """
    use_variant()
    refuse_scalar("compare")
    projections = PROJECTIONS if projections is None else projections
    filters = FILTERS if filters is None else filters
    kinds = {"projection": projections, "filter": filters, "partition": partitions}
    kinds = {kind: to_names(f"{kind}s", names) for kind, names in kinds.items()}
    resolution, size = to_texels(resolution), to_size(size)
    techniques = functions(kinds, to_names("others", others), resolution)
    scene = to_scene(scene, size)
    places = list(itertools.product(enumerate(scene.sensors()), enumerate(scene.emitters())))
    report, requested = progress or (lambda done, total: None), len(places) * len(techniques)
    found: list[tuple[Pictures, dict]] = []
    try:
        for (view, sensor), (light, emitter) in places:
            seen = Seen.by(scene, sensor, emitter, size[::-1])
            pictures = Pictures.of(seen, title_of(view, sensor, light, emitter))
            scores: dict[str, Scores] = {}
            found.append((pictures, scores))
            if not pictures.is_lit:
                score_nothing(pictures, scores, techniques)
                continue
            placement = Placement.of_scene(scene, sensor, emitter)
            with raise_first_cause():
                pictures.maps = pictures_of_maps(seen, placement, kinds, resolution)
                watched = (
                    Watched.by_moving_camera(seen, placement),
                    Watched.by_moving_light(seen, placement),
                )
            for label, shadow_of in techniques.items():
                report((len(found) - 1) * len(techniques) + len(scores), requested)
                with raise_first_cause():  # Ctrl-C, for one
                    one, lit = score(seen, placement, watched, shadow_of)
                pictures.keep(label, lit)
                scores[label] = one
    except KeyboardInterrupt:
        if not (found and found[0][1]):
            raise
    if not any(pictures.is_lit for pictures, _ in found):
        raise BrdfkitError(
            "no camera sees a surface that a light shines on: turn a camera, or move a light."
        )
    finished = [place for place in found if len(place[1]) == len(techniques)] or found[:1]
    shown, each = zip(*finished, strict=True)
    by_label = {label: tuple(scores[label] for scores in each) for label in each[0]}
    return ShadowComparison(by_label, len(scene.emitters()), requested, shown)


def score_nothing(pictures, scores, techniques):
    """Fill in a view in which nothing is in the light: no technique can be right or wrong."""
    for label in techniques:
        pictures.keep(label, np.ones(pictures.exact.size))
        scores[label] = Scores()


def functions(kinds, others, resolution):
    """Label → function (seen, placement) of the shadow, of all techniques that are asked for.

    Raises `BrdfkitError` for an unknown name, and where there is none at all.
    """
    for name in others:
        if name not in OTHERS:
            raise no_such("technique without maps", name, OTHERS)
    maps = {
        label: partial(of_maps, **technique, resolution=resolution)
        for label, technique in combinations(kinds).items()
    }
    techniques = maps | {name: partial(OTHERS[name], resolution=resolution) for name in others}
    if not techniques:
        raise BrdfkitError(
            "no technique is asked for: name a projection, a filter and a partition, or others."
        )
    return techniques


def of_maps(seen, placement, **technique):
    """The `LightShadow` of a technique, of what a camera sees."""
    return LightShadow(seen.scene, placement, **technique)


def combinations(names):
    """Label → keyword arguments of `LightShadow`, of all combinations of `names` by kind.

    What all have in common is not in the label. Raises `BrdfkitError` for an unknown name.
    """
    for kind, its in names.items():
        for name in its:
            if name not in FILES[kind]:
                raise no_such(kind, name, FILES[kind])
    several = [kind for kind, its in names.items() if len(its) > 1] or list(names)[:1]
    chosen = [
        dict(zip(names, picked, strict=True)) for picked in itertools.product(*names.values())
    ]
    return {" + ".join(each[kind] for kind in several): each for each in chosen}


def pictures_of_maps(seen, placement, kinds, resolution):
    """Label → `MapPictures` of every projection in every partition; filters change nothing."""
    chosen = combinations({kind: kinds[kind] for kind in ("projection", "partition")})
    return {
        label: MapPictures.of(seen, placement, **technique, resolution=resolution)
        for label, technique in chosen.items()
    }
