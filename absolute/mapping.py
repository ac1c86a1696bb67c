"""A mapping that cannot be changed, and that pickles."""

from collections.abc import Iterator, Mapping
from typing import TypeVar

V = TypeVar("V")


class ReadOnly(Mapping[str, V]):
    """Names to values, copied from the mapping given and then fixed."""

    __slots__ = ("_items",)

    def __init__(self, items: Mapping[str, V]) -> None:
        self._items = dict(items)

    def __getitem__(self, name: str) -> V:
        return self._items[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._items)

    def __len__(self) -> int:
        return len(self._items)

    def __repr__(self) -> str:
        return f"ReadOnly({self._items!r})"

    def __reduce__(self) -> tuple[type["ReadOnly[V]"], tuple[dict[str, V]]]:
        return ReadOnly, (self._items,)
