"""`Recent`: the things of a view that were used last, such as its scenes."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from typing import Generic, TypeVar

K = TypeVar("K", bound=Hashable)
T = TypeVar("T")


class Recent(Generic[K, T]):
    """At most `count` things by key; the one that was not used for longest is dropped first.

    `on_drop` is called after each.
    """

    def __init__(self, count: int, on_drop: Callable[[], None] = lambda: None) -> None:
        self.count, self.on_drop = count, on_drop
        self.kept: dict[K, T] = {}

    def get(self, key: K, make: Callable[[], T]) -> T:
        """Return the thing of a key, which is made unless it is kept."""
        thing = self.kept.pop(key) if key in self.kept else make()
        self.kept[key] = thing  # the last one is the newest
        if len(self.kept) > self.count:
            self.kept.pop(next(iter(self.kept)))
            self.on_drop()
        return thing

    def clear(self) -> None:
        """Drop all things."""
        self.kept.clear()
