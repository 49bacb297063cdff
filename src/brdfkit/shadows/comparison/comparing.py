"""`compare`: scores shadow techniques on a user's scene against exact shadows."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable, Mapping
from functools import partial
from typing import Any, TypeAlias

import numpy as np

from brdfkit.core.arguments import to_whole_number
from brdfkit.core.errors import BrdfkitError, no_such_error
from brdfkit.core.jit.llvm import use_variant
from brdfkit.core.jit.loops import raise_first_cause
from brdfkit.core.progress_bar import Progress
from brdfkit.mitsuba_bridge.registration.registering import require_vectorised
from brdfkit.shadows.comparison.arguments import (
    MAX_SIDE,
    check_names,
    check_picture_size,
    load_scene,
)
from brdfkit.shadows.comparison.comparison import ShadowComparison
from brdfkit.shadows.comparison.exact_shadow import LitView
from brdfkit.shadows.comparison.map_pictures import MapPictures
from brdfkit.shadows.comparison.pictures import Pictures, make_title
from brdfkit.shadows.comparison.scores import Scores
from brdfkit.shadows.comparison.scoring import score_technique
from brdfkit.shadows.comparison.tracked_points import TrackedPoints
from brdfkit.shadows.comparison.without_maps import WITHOUT_MAPS
from brdfkit.shadows.maps.light_shadow import LightShadow
from brdfkit.shadows.maps.placement import Placement
from brdfkit.shadows.maps.techniques import FILES

PROJECTIONS = tuple(FILES["projection"])
FILTERS = "depth", "percentage_closer", "variance", "moment"

# A technique is a function from a view, and the placement of its camera and light, to a shadow: an
# object whose `visibility(p, n, active)` says how much light arrives at points p with normals n
Technique: TypeAlias = Callable[[LitView, Placement], Any]


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

    After Ctrl-C, the result has the finished pairs of a view and a light; if not even the first
    pair is finished, it has the techniques that are finished in this pair.

    Parameters
    ----------
    scene : path, str or mitsuba.Scene
        A Mitsuba scene file (.xml), or a loaded scene, with point, spot or directional lights and
        perspective cameras; each camera is a view. Or the name of a scene that comes with brdfkit,
        with four views and two suns: ``"street"``, ``"foliage"`` or ``"objects_on_a_ground"``.
    projections : iterable of str, optional
        Names of projections, by default all. Every combination of a projection, a filter and a
        partition is scored; ``brdfkit plugins shadow_map`` lists the names.
    filters : iterable of str, optional
        Names of filters, by default depth, percentage_closer, variance and moment.
    partitions : iterable of str, default ("whole",)
        Names of partitions.
    others : iterable of str, default ()
        Techniques without maps: ``"shadow_volume"`` and ``"hybrid_shadow"``; see the plugins of
        these names.
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
        For an unknown technique or scene; for a scene without a camera, with other lights, or in
        which no light shines on a visible surface; and for shapes that have no shadow volume where
        one is needed.

    Examples
    --------
    >>> bk.shadows.compare("street", ["focused", "trapezoidal"])    # doctest: +SKIP
    """
    use_variant()
    require_vectorised("compare")
    projections = PROJECTIONS if projections is None else projections
    filters = FILTERS if filters is None else filters
    named = {"projection": projections, "filter": filters, "partition": partitions}
    kinds = {kind: check_names(f"{kind}s", names) for kind, names in named.items()}
    resolution = to_whole_number("resolution", resolution, 1, MAX_SIDE)
    size = check_picture_size(size)
    techniques = choose_techniques(kinds, check_names("others", others), resolution)
    scene = load_scene(scene, size)
    places = list(itertools.product(enumerate(scene.sensors()), enumerate(scene.emitters())))
    report, requested = progress or (lambda done, total: None), len(places) * len(techniques)
    results: list[tuple[Pictures, dict[str, Scores]]] = []
    try:
        for (view_index, sensor), (light_index, emitter) in places:
            view = LitView.from_sensor(scene, sensor, emitter, size[::-1])
            title = make_title(view_index, sensor, light_index, emitter)
            pictures = Pictures.from_view(view, title)
            scores: dict[str, Scores] = {}
            results.append((pictures, scores))
            if not pictures.is_lit:
                score_unlit_view(pictures, scores, techniques)
                continue
            placement = Placement.from_scene(scene, sensor, emitter)
            with raise_first_cause():
                pictures.maps = draw_maps(view, placement, kinds, resolution)
                tracked = (
                    TrackedPoints.by_moving_camera(view, placement),
                    TrackedPoints.by_moving_light(view, placement),
                )
            for label, technique in techniques.items():
                report((len(results) - 1) * len(techniques) + len(scores), requested)
                with raise_first_cause():  # Dr.Jit would hide Ctrl-C in a RuntimeError
                    scores_here, lit = score_technique(view, placement, tracked, technique)
                pictures.add_technique(label, lit)
                scores[label] = scores_here
    except KeyboardInterrupt:
        if not (results and results[0][1]):
            raise
    if not any(pictures.is_lit for pictures, _ in results):
        raise BrdfkitError(
            "no camera sees a surface that a light shines on: turn a camera, or move a light."
        )
    finished = [result for result in results if len(result[1]) == len(techniques)] or results[:1]
    shown, each = zip(*finished, strict=True)
    by_label = {label: tuple(scores[label] for scores in each) for label in each[0]}
    return ShadowComparison(by_label, len(scene.emitters()), requested, shown)


def score_unlit_view(
    pictures: Pictures, scores: dict[str, Scores], techniques: Mapping[str, Technique]
) -> None:
    """Give each technique unknown scores in a view without lit surfaces, where none can be wrong.

    pictures, scores : the view's pictures and its scores by technique, which are filled in.
    """
    for label in techniques:
        pictures.add_technique(label, np.ones(pictures.exact.size))
        scores[label] = Scores()


def choose_techniques(
    kinds: Mapping[str, tuple[str, ...]], others: tuple[str, ...], resolution: int
) -> dict[str, Technique]:
    """Return all techniques to compare: label of the technique → function that makes its shadow.

    kinds : the names of map techniques by kind, such as "filter"; all combinations are compared.
    others : names of techniques without maps.
    resolution : number of texels along a side of a map.

    Raises `BrdfkitError` for an unknown name, and if there is no technique.
    """
    for name in others:
        if name not in WITHOUT_MAPS:
            raise no_such_error("technique without maps", name, WITHOUT_MAPS)
    techniques: dict[str, Technique] = {
        label: partial(make_map_shadow, **names, resolution=resolution)
        for label, names in combine_technique_names(kinds).items()
    }
    techniques |= {name: partial(WITHOUT_MAPS[name], resolution=resolution) for name in others}
    if not techniques:
        raise BrdfkitError(
            "no technique is asked for: name a projection, a filter and a partition, or others."
        )
    return techniques


def make_map_shadow(view: LitView, placement: Placement, **settings: Any) -> LightShadow:
    """Make the shadow of a view by shadow maps, with settings of `LightShadow`."""
    return LightShadow(view.scene, placement, **settings)


def combine_technique_names(names: Mapping[str, tuple[str, ...]]) -> dict[str, dict[str, Any]]:
    """Combine projections, filters and partitions: label → keyword arguments of `LightShadow`.

    A label leaves out the kinds that have a single name. Raises `BrdfkitError` for an unknown name.

    names : the names of techniques by kind: "projection", "filter" and "partition".
    """
    for kind, its in names.items():
        for name in its:
            if name not in FILES[kind]:
                raise no_such_error(kind, name, FILES[kind])
    several = [kind for kind, its in names.items() if len(its) > 1] or list(names)[:1]
    chosen = [
        dict(zip(names, picked, strict=True)) for picked in itertools.product(*names.values())
    ]
    return {" + ".join(each[kind] for kind in several): each for each in chosen}


def draw_maps(
    view: LitView, placement: Placement, kinds: Mapping[str, tuple[str, ...]], resolution: int
) -> dict[str, MapPictures]:
    """Draw the shadow maps of a view for every pair of a projection and a partition, by its label.

    kinds : the names of techniques by kind, such as "projection".
    resolution : number of texels along a side of a map.
    """
    chosen = combine_technique_names({kind: kinds[kind] for kind in ("projection", "partition")})
    return {
        label: MapPictures.from_view(view, placement, **names, resolution=resolution)
        for label, names in chosen.items()
    }
