"""Judges a claim of a thesis by a grid of settings that the thesis does not tell."""

from collections.abc import Iterator, Mapping, Sequence
from itertools import combinations, product

import numpy as np

from brdfkit.theses.claims import CONFIRMED, HOLDS_WHERE, REFUTED

LEAST = 1 / 8  # of the grid: a claim that holds in a smaller block of settings is not confirmed
FEW = 4  # settings: in a larger grid, a single one in which a claim holds may be chance

Cell = tuple[str, ...]  # the value of each setting


def judge_over_grid(names: Sequence[str], holds: Mapping[Cell, bool]) -> tuple[str, str]:
    """Return in how many cells of a grid a claim holds, as text, and the verdict.

    The claim is confirmed where it holds in all cells. Otherwise the verdict names the largest
    block in which it holds without exception: some values of each setting, in all combinations. Of
    equal blocks it is the one with the fewest settings to name. If that block has less than the
    share `LEAST` of all cells, or is a single one of more than `FEW`, the claim is not confirmed,
    and the text names it.

    names : the name of each setting, in the order of the cells' values.
    holds : whether the claim holds, for each cell of the grid.

    >>> cells = {("a", "0"): True, ("a", "1"): True, ("b", "0"): False, ("b", "1"): True}
    >>> judge_over_grid(["scene", "blur"], cells)
    ('in 3 of 4 settings', 'holds where the scene is a')
    """
    ours = f"in {sum(holds.values())} of {len(holds)} settings"
    if all(holds.values()):
        return ours, CONFIRMED
    block = find_largest_block(holds)
    size = np.prod([len(values) for values in block])
    if size == 0:
        return ours, REFUTED
    words = " and ".join(
        f"the {name} is {_describe_values(values, every)}"
        for name, values, every in zip(names, block, _list_values(holds), strict=True)
        if len(values) < len(every)
    )
    if size < LEAST * len(holds) or (size == 1 and len(holds) > FEW):
        return f"{ours}, at most where {words}", REFUTED
    return ours, f"{HOLDS_WHERE} {words}"


def find_largest_block(holds: Mapping[Cell, bool]) -> tuple[Cell, ...]:
    """Return the values of each setting in the largest block of the grid that holds throughout.

    All are empty if a claim holds nowhere.
    """
    every = _list_values(holds)
    grid = np.reshape([holds[cell] for cell in product(*every)], [len(values) for values in every])
    best: tuple[Sequence[int], ...] = tuple(() for _ in every)
    rank = (0, 0)
    for block in product(*(_list_subsets(len(values)) for values in every)):
        size = int(np.prod([len(places) for places in block]))
        whole = sum(len(p) == len(values) for p, values in zip(block, every, strict=True))
        if (size, whole) > rank and grid[np.ix_(*block)].all():
            best, rank = block, (size, whole)
    return tuple(
        tuple(values[place] for place in places) for places, values in zip(best, every, strict=True)
    )


def _describe_values(values: Cell, every: Cell) -> str:
    """Return the values of a setting in words, by what is missing if that is a single value."""
    missing = [value for value in every if value not in values]
    return " or ".join(values) if len(every) < 3 or len(missing) > 1 else f"not {missing[0]}"


def _list_values(cells: Mapping[Cell, bool]) -> list[Cell]:
    """Return the values of each setting, in the order in which they first occur."""
    return [tuple(dict.fromkeys(values)) for values in zip(*cells, strict=True)]


def _list_subsets(count: int) -> Iterator[tuple[int, ...]]:
    """Yield all subsets but the empty one of the numbers below `count`."""
    for size in range(1, count + 1):
        yield from combinations(range(count), size)
