"""Named values that are computed when one of them is first looked at."""

from __future__ import annotations

from collections.abc import Callable, Iterator, MutableMapping
from functools import cached_property
from typing import Any, TypeVar

T = TypeVar("T")


class Deferred(MutableMapping[str, T]):
    """A dict that is made on first use; copied and pickled as the plain dict it stands for.

    Parameters
    ----------
    make : function
        Returns the dict; called once.
    """

    def __init__(self, make: Callable[[], dict[str, T]]) -> None:
        self._make = make

    @cached_property
    def _made(self) -> dict[str, T]:
        return self._make()

    def __getitem__(self, key: str) -> T:
        return self._made[key]

    def __setitem__(self, key: str, value: T) -> None:
        self._made[key] = value

    def __delitem__(self, key: str) -> None:
        del self._made[key]

    def __iter__(self) -> Iterator[str]:
        return iter(self._made)

    def __len__(self) -> int:
        return len(self._made)

    def __repr__(self) -> str:
        return repr(self._made)

    def __reduce__(self) -> tuple[Any, ...]:
        return dict, (self._made,)
