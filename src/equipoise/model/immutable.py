"""Nested mappings and lists, such as a file holds, that cannot change any more."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any


class ImmutableMapping(Mapping[str, Any]):
    """A mapping without a way to change it; equal to every mapping that holds the same, and printed like one."""

    def __init__(self, items: Mapping[str, Any]) -> None:
        self._items = {key: immutable(value) for key, value in items.items()}

    def __getitem__(self, key: str) -> Any:
        return self._items[key]

    def __iter__(self) -> Iterator[str]:
        return iter(self._items)

    def __len__(self) -> int:
        return len(self._items)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Mapping) and self._items == ImmutableMapping(other)._items

    def __hash__(self) -> int:
        return hash(frozenset(self._items.items()))

    def __repr__(self) -> str:
        return repr(self._items)


def immutable(value: Any) -> Any:
    """The value with all mappings in it as `ImmutableMapping` and all lists as tuples."""
    if isinstance(value, Mapping):
        return value if isinstance(value, ImmutableMapping) else ImmutableMapping(value)
    return tuple(map(immutable, value)) if isinstance(value, (list, tuple)) else value
