"""The doors from a result up to what draws it and reports it: `Result.plot`, `show`, `report` and `save`.

What draws knows results, not the reverse. Users ask a result for its picture, though, so these imports climb, the only
ones in kshell that do; each is made when its door is opened.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from kshell.result.result import Result


def plot(result: Result, what: str) -> Figure:
    """See `Result.plot`."""
    from kshell.draw.plot import plot

    return plot(result, what)


def show(result: Result, what: str, scale: float | None, file: str | None) -> Any:
    """See `Result.show`."""
    from kshell.draw.view import show

    return show(result, what, scale, file)


def picture_files(result: Result, plots: bool) -> dict[str, Callable[[Path], object]]:
    """The pictures that `Result.save` writes: file name to function of the path."""
    if not plots and result.analysis != "path" and not result.history:
        return {}  # none is written without being asked for
    from kshell.draw.plot import picture_files

    return picture_files(result, plots)


def report_writer(result: Result) -> Callable[[Path], object]:
    """What writes the report of a result to a path."""
    from functools import partial

    from kshell.report.page import write_report

    return partial(write_report, result)
