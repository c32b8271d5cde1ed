"""Named values each of which is computed when it is first looked at."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, MutableMapping
from typing import Any, Generic, TypeVar

T = TypeVar("T")


class Deferred(MutableMapping[Any, T]):
    """A dict whose values are made on first use; copied and pickled as the plain dict it stands for.

    Parameters
    ----------
    makers : dict of key to function
        Each returns the value of its key; called once at most.
    """

    def __init__(self, makers: Mapping[Any, Callable[[], T]] | None = None) -> None:
        self._values: dict[Any, Callable[[], T] | _Made[T]] = dict(makers or {})

    def make(self, key: Any, maker: Callable[[], T]) -> None:
        """Add a value that a function will return."""
        self._values[key] = maker

    def __getitem__(self, key: Any) -> T:
        found = self._values[key]
        if not isinstance(found, _Made):
            found = self._values[key] = _Made(found())
        return found.value

    def __setitem__(self, key: Any, value: T) -> None:
        self._values[key] = _Made(value)

    def __delitem__(self, key: Any) -> None:
        del self._values[key]

    def __iter__(self) -> Iterator[Any]:
        return iter(self._values)

    def __len__(self) -> int:
        return len(self._values)

    def __contains__(self, key: object) -> bool:
        return key in self._values

    def __repr__(self) -> str:
        return repr(dict(self))

    def __reduce__(self) -> tuple[Any, ...]:
        return dict, (dict(self),)


class _Made(Generic[T]):
    def __init__(self, value: T) -> None:
        self.value = value
