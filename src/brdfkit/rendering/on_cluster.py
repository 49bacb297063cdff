"""Renders the passes of pictures on a cluster, and adds them up here.

A task is a piece of one picture: some passes of it, with the seeds that they have without a
cluster. A worker returns the mean of its passes as float32, which counts as one pass with all their
samples. So pictures and noise are computed as always, and equal seeds give equal pictures on any
cluster, but for rounding.
"""

from __future__ import annotations

from collections.abc import Generator, Sequence
from contextlib import closing
from dataclasses import dataclass
from math import ceil
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from brdfkit.core.cluster import count_cluster_slots, require_result, run_tasks
from brdfkit.core.discovery import plugin_files
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.interrupts import delay_signals
from brdfkit.core.jit.llvm import use_variant
from brdfkit.core.jit.threads import in_turn
from brdfkit.images.errors.noise import Accumulated
from brdfkit.mitsuba_bridge.registration.users_plugins import load_plugins
from brdfkit.rendering.progressive import Progressive, render_pass
from brdfkit.rendering.shown import Loaded, Shown
from brdfkit.rendering.tracing import PASS, Traced, accumulate_passes, plan_passes

# Number of pieces for each thread of the cluster, if there are enough passes. A piece has at least
# `PASS` samples per pixel if there are enough, so that a thread sends 1 to 2 MB a second
PARTS = 4
# With a noise floor, a piece has at most this share of the passes before it, so that few are
# rendered in vain
SHARE = 1 / 16


@dataclass(frozen=True)
class Piece:
    """Passes of the picture `name`: pairs of a number and of samples per pixel.

    `number`: the place of this piece among those of the picture.
    """

    number: int
    name: str
    passes: tuple[tuple[int, int], ...]

    def __str__(self) -> str:
        first, last = self.passes[0][0] + 1, self.passes[-1][0] + 1
        return f"{self.name}, passes {first} to {last}"


@dataclass(frozen=True)
class Order:
    """What all pieces of a rendering share.

    `shown`: what is rendered. `seed`: of the samples. `variant`: Mitsuba's. `plugins`: the user's
    plugin files.
    """

    shown: Shown
    seed: int
    variant: str
    plugins: tuple[Path, ...]


def trace_on_cluster(
    shown: Shown,
    loaded: Loaded,
    spp: int,
    seed: int,
    progress: Any,
    noise_floor: float | None,
    client: Any,
) -> Traced:
    """Path-trace what is `shown` on the cluster of a `client`; the arguments are as in `render`.

    `loaded` is what `shown` has loaded here, without its scenes, which other threads may not see.
    """
    names = list(loaded.scenes)
    passes = list(enumerate(plan_passes(spp, loaded.pixels)))
    slots = count_cluster_slots(client) / len(names)
    pieces = group_passes(passes, PARTS * slots, noise_floor is not None)
    tasks = [Piece(n, name, tuple(piece)) for n, piece in enumerate(pieces) for name in names]
    plugins = plugin_files.list_users_files()
    order = Order(shown.with_absolute_paths(), seed, use_variant(), plugins)
    counts = [sum(count for _, count in piece) for piece in pieces]
    growing = Progressive(dict.fromkeys(names), seed)
    with closing(_render_pieces(tasks, order, client)) as pictures:
        return accumulate_passes(growing, counts, pictures, progress, noise_floor, loaded.mask)


def group_passes(
    passes: Sequence[tuple[int, int]], least: float, growing: bool
) -> list[list[tuple[int, int]]]:
    """Divide passes (number, samples per pixel) into pieces of consecutive ones.

    There are about `least` pieces, at least two, and as few samples as `PASS` in the smallest. If
    `growing`, the pieces begin small, and a later one has the share `SHARE` of those before it.

    >>> group_passes([(0, 16), (1, 16), (2, 16), (3, 16)], 1, growing=False)
    [[(0, 16), (1, 16)], [(2, 16), (3, 16)]]
    """
    smallest = ceil(PASS / passes[0][1])
    size = 0 if growing else len(passes) // max(2, int(least))
    pieces, start = [], 0
    while start < len(passes):
        own = max(size, smallest, int(SHARE * start) if growing else 0)
        count = min(own, ceil(len(passes) / 2))
        pieces.append(list(passes[start : start + count]))
        start += count
    return pieces


def _render_pieces(
    tasks: Sequence[Piece], order: Order, client: Any
) -> Generator[tuple[int, str, NDArray[np.float32]], None, None]:
    """Yield (number of the piece, name, picture), as the cluster finishes them."""
    files = [*order.shown.files, *order.plugins]
    with closing(run_tasks(render_piece, tasks, client, shared=order, files=files)) as results:
        for piece, result in results:
            yield piece.number, piece.name, require_result(result)


@in_turn
def render_piece(order: Order, piece: Piece) -> NDArray[np.float32]:
    """Return the mean of the passes of a piece, (height, width, 3); a worker calls this.

    The scene is freed when this function returns, before another thread renders.
    """
    _use_same_variant(order.variant)
    for path in order.plugins:
        load_plugins(path)
    (scene,) = order.shown.pick(piece.name).load().scenes.values()
    mean = Accumulated()
    for number, spp in piece.passes:
        mean = mean.add_pass(render_pass(scene, order.seed, number, spp), spp)
    return mean.picture


def _use_same_variant(variant: str) -> None:
    """Set Mitsuba's `variant`, that of the client; raise `BrdfkitError` if it does not work."""
    import mitsuba as mi

    if mi.variant() != variant:
        try:
            with delay_signals():
                mi.set_variant(variant)
        except (ImportError, RuntimeError) as error:
            raise BrdfkitError(
                f"{variant}: a worker of the cluster cannot use this variant of Mitsuba ({error}); "
                "set another one by mitsuba.set_variant before you render."
            ) from error
    use_variant()
