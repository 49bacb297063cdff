"""Paints on the picture of a volume: a stroke changes the transfer function.

Values that distinguish the stroke from the rest of the picture become more opaque, or less. With
the transmittance T of a whole ray, and its way dl through voxels of the value v, the weights are

    s(v) = mean of ∫ σ T dl        over the rays of the stroke
    r(v) = mean of ∫ σ T(l) dl     over all other rays; T(l) is the transmittance in front of dl
    w(v) = max((s - 2 r) / (s + 2 r), 0)

s is the derivative of the stroke's mean opacity, 1 - T, with respect to A(v), r that of what v adds
to the rest of the picture. w is 1 for a value that only the stroke has, and 0 if the rest has half
as much of it. A is raised by the smallest multiple of w that changes the stroke as much as wanted.
To hide something, s and r are means of what v contributes to the opacity, and A is reduced by a
share of itself.

A stroke should raise its opacity by 0.15 and change the rest at most half as much. Of trial strokes
over places that were not opaque yet, 93 % did with these weights, 75 % with s - r, which is the
gradient itself, and 80 % with differences of the histograms of values.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.viewing.controls import State
from brdfkit.viewing.volumes import transfer_table
from brdfkit.viewing.volumes.rays import LARGEST_LABEL_COUNT, Rays, cast_rays, list_values
from brdfkit.viewing.volumes.state import FIRST_BUMP, VolumeState
from brdfkit.viewing.volumes.volume_controls import DENSE

BRUSH = 0.02  # radius of the stroke, as a share of the picture's shorter side; as in paint.js
STROKE_RAYS, REST_RAYS = 64, 24  # the latter along each side of the picture
REST_WEIGHT = 2.0  # of r against s
NOISE = 0.03  # of s, as a share of its largest value
CHANGE, SHARE = 0.25, 0.6  # wanted: this opacity, but at most this share of what is possible
LEAST_CHANGE = 0.05  # of the stroke's opacity, below which it has failed
LARGEST_HARM = 0.5  # change of the rest over that of the stroke, above which it has failed
LEAST_AMOUNT, LARGEST_AMOUNT, HALVINGS = 1e-5, 4.0, 8  # of the search for the multiple of w
LARGEST_PLACE_COUNT = 1000  # of a stroke


def paint(
    states: VolumeState, state: State, stroke: Any, aspect: float, hide: bool = False
) -> dict[str, Any]:
    """Return the changes of a state with which a stroke shows what is under it, or hides it.

    `stroke` are places [x, y] in the picture, 0 to 1 from its top left; `aspect` is the picture's
    width over its height. Raises `BrdfkitError` if what is under the stroke cannot be changed
    without the rest of the picture.
    """
    if not {state["renderer"], state["second"]} & set(DENSE["renderer"]):
        raise BrdfkitError("Painting changes opacities, which this renderer does not have.")
    painted = _Stroke(states, _use_points(states, state), _check_stroke(stroke), aspect, hide)
    weights = painted.find_weights()

    def change(amount: float) -> dict[str, Any]:
        return painted.change(np.minimum(amount * weights, 1))

    changes = change(_find_amount(lambda amount: painted.measure(change(amount)), painted.wanted))
    done = painted.measure(changes)
    if done < LEAST_CHANGE or painted.measure_harm(changes) > LARGEST_HARM * done:
        raise BrdfkitError(
            "The values under the stroke do not differ enough from those of the rest of the "
            "picture; draw elsewhere, or turn or clip the volume."
        )
    return changes


class _Stroke:
    """A stroke over the picture of a state, and rays through it and through the rest."""

    def __init__(
        self, states: VolumeState, state: State, places: FloatArray, aspect: float, hide: bool
    ) -> None:
        self.states, self.state, self.hide = states, state, hide
        self.extinction = state["transfer.extinction"] * state["density"]
        under, rest = _choose_places(places, aspect)
        self.under, self.rest = self._cast(under, aspect), self._cast(rest, aspect)
        if not len(self.under.length) or not len(self.rest.length):
            raise BrdfkitError("The stroke does not meet the volume; draw over it.")
        self.depths, self.rest_depths = (
            self._find_depths(rays, {}) for rays in (self.under, self.rest)
        )
        transmittance = float(np.exp(-self.depths.sum(axis=1)).mean())
        possible = 1 - transmittance if hide else transmittance
        if SHARE * possible < LEAST_CHANGE:
            raise BrdfkitError(
                "Nothing is visible under the stroke."
                if hide
                else "The picture is opaque under the stroke; hide what is in front, with Shift."
            )
        self.wanted = min(CHANGE, SHARE * possible)

    def _cast(self, places: FloatArray, aspect: float) -> Rays:
        """Return the rays through places (n, 2) that meet the volume."""
        camera, clip = self.states.camera(self.state), np.array(self.state["clip"], float)
        rays = cast_rays(self.states.live, camera, places, aspect, clip)
        return rays.select(rays.length > 0)

    def _find_depths(self, rays: Rays, changes: dict[str, Any]) -> FloatArray:
        """Return the optical depths of the samples of rays after changes of the state."""
        return rays.depths(self.states.functions.table(self.state | changes), self.extinction)

    def find_weights(self) -> FloatArray:
        """Return the weights w (bins,), scaled so that the largest is 1."""
        from scipy.ndimage import gaussian_filter1d

        if self.hide:
            s = self.under.mean_contributions(self.depths)
            r = self.rest.mean_contributions(self.rest_depths)
        else:
            s = self.under.mean_slopes(self.depths, self.extinction)
            r = self.rest.mean_own_slopes(self.rest_depths, self.extinction)
        if not self.states.volume.labels:
            s, r = gaussian_filter1d(s, 1.0), gaussian_filter1d(r, 1.0)
        r = REST_WEIGHT * r
        weights = np.maximum(s - r, 0) / (s + r + NOISE * s.max() + 1e-30)
        return weights / max(weights.max(), 1e-30)

    def measure(self, changes: dict[str, Any]) -> float:
        """Return by how much the stroke's mean opacity rises, or how much of it is replaced."""
        after = self._find_depths(self.under, changes)
        if self.hide:
            return _measure_shifts(self.under, self.depths, after)[0]
        return float((np.exp(-self.depths.sum(axis=1)) - np.exp(-after.sum(axis=1))).mean())

    def measure_harm(self, changes: dict[str, Any]) -> float:
        """Return how much opacity the values of the rest of the picture lose or gain."""
        after = self._find_depths(self.rest, changes)
        return max(_measure_shifts(self.rest, self.rest_depths, after))

    def change(self, weights: FloatArray) -> dict[str, Any]:
        """Return the transfer function whose A is raised by weights, or reduced by shares."""
        if self.state["transfer.mode"] == "points":
            values, labels = list_values(self.states.live), self.states.volume.labels
            points = transfer_table.change_points(
                self.state["transfer.points"],
                values,
                weights,
                self.hide,
                LARGEST_LABEL_COUNT if labels else transfer_table.POINTS,
            )
            return {"transfer.mode": "points", "transfer.points": points}
        at = np.linspace(0, 1, len(weights))
        bumps = [dict(bump) for bump in self.state["transfer.bumps"]]
        if not self.hide and len(bumps) >= transfer_table.LARGEST_BUMPS:
            raise BrdfkitError(
                f"A stroke adds a bump, and {len(bumps)} are the most that can be; remove one."
            )
        if not self.hide:
            return {"transfer.bumps": [*bumps, _fit_bump(at, weights)]}
        for bump in bumps:
            nearness = np.exp(-(((at - bump["x"]) / bump["sx"]) ** 2))
            bump["a"] *= 1 - float((weights * nearness).max())
        return {"transfer.bumps": bumps}


def _use_points(states: VolumeState, state: State) -> State:
    """Return a state whose preset, if it has one, is replaced by points; labels have one each."""
    if state["transfer.mode"] != "preset":
        return state
    points = state["transfer.points"]
    if states.volume.labels:
        values = list_values(states.live)
        rgba = states.functions.load(state["transfer.preset"])(values)
        points = [
            [value, transfer_table.format_colour(colour[:3]), float(colour[3])]
            for value, colour in zip(values.tolist(), rgba, strict=True)
        ]
    return state | {"transfer.mode": "points", "transfer.points": points}


def _check_stroke(stroke: Any) -> FloatArray:
    """Return the places (n, 2) of a stroke; raise `BrdfkitError` if it is none."""
    try:
        places = np.asarray(stroke, float)
    except (TypeError, ValueError, OverflowError):
        places = np.zeros(0)
    if places.ndim != 2 or places.shape[1] != 2 or not np.isfinite(places).all():
        raise BrdfkitError("The page sent no stroke; draw it again.")
    if not 1 <= len(places) <= LARGEST_PLACE_COUNT:
        raise BrdfkitError("The stroke is too long; draw a shorter one.")
    return np.clip(places, 0, 1)


def _choose_places(stroke: FloatArray, aspect: float) -> tuple[FloatArray, FloatArray]:
    """Return places (n, 2) under the brush along a stroke, and places of the rest."""
    random = np.random.default_rng(0)
    scale = np.array([max(aspect, 1.0), max(1 / aspect, 1.0)])  # to shares of the shorter side
    stroke = stroke * scale
    way = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(stroke, axis=0), axis=1))])
    along = random.uniform(0, way[-1], STROKE_RAYS)
    middles = np.stack([np.interp(along, way, x) for x in stroke.T], axis=1)
    radius = BRUSH * np.sqrt(random.uniform(0, 1, STROKE_RAYS))
    angle = random.uniform(0, 2 * np.pi, STROKE_RAYS)
    under = middles + radius[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    cells = np.indices((REST_RAYS, REST_RAYS)).reshape(2, -1).T
    rest = (cells + random.uniform(0, 1, cells.shape)) / REST_RAYS * scale
    apart = np.linalg.norm(rest[:, None] - middles, axis=2).min(axis=1) > 2 * BRUSH
    return under / scale, rest[apart] / scale


def _measure_shifts(rays: Rays, before: FloatArray, after: FloatArray) -> tuple[float, float]:
    """Return how much mean opacity of rays is lost by some values, and gained by others."""
    shift = rays.mean_contributions(after) - rays.mean_contributions(before)
    return float(np.maximum(-shift, 0).sum()), float(np.maximum(shift, 0).sum())


def _find_amount(measure: Callable[[float], float], wanted: float) -> float:
    """Return the smallest amount at which `measure` reaches what is wanted, or the largest."""
    low, high = LEAST_AMOUNT, LARGEST_AMOUNT
    if measure(high) < wanted:
        return high
    for _ in range(HALVINGS):
        middle = float(np.sqrt(low * high))
        low, high = (low, middle) if measure(middle) >= wanted else (middle, high)
    return high


def _fit_bump(at: FloatArray, weights: FloatArray) -> dict[str, Any]:
    """Return a bump over all gradients, at the highest peak of weights (bins,)."""
    peak = int(weights.argmax())
    gaps = np.flatnonzero(weights <= 0)
    low, high = gaps[gaps < peak].max(initial=-1) + 1, gaps[gaps > peak].min(initial=len(at))
    at_peak, part = at[low:high], np.maximum(weights[low:high], 1e-30)
    x = float(np.average(at_peak, weights=part))
    width = float(np.sqrt(2 * np.average((at_peak - x) ** 2, weights=part)))
    place = {"x": x, "y": 0.5, "sx": max(width, float(at[1])), "sy": 4.0}
    return FIRST_BUMP | place | {"a": float(weights[peak])}
