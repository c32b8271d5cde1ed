"""`kshell verify`: run the cases, print the table, write charts and page."""

from __future__ import annotations

import io
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING

from kshell.errors import InputError
from kshell.verify.machine import machine, one_line
from kshell.verify.run import Block, Report, run_blocks

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from rich.console import Console

    from kshell.verify.cases import Case

WIDTHS = (38, 19, 9, 16, 17, 17, 9, 9, 7, 7)


def verify(quick: bool = False, out: Path | None = None, cases: Iterable[Case] | None = None) -> Report:
    """Run the verification cases on this machine and print a table.

    Parameters
    ----------
    quick : bool
        Each case once with each element and degree, but those that take long; else on all meshes, and the rates of
        convergence.
    out : Path, optional
        Folder for verification.html, verification.csv and the charts: all of them or none.
    cases : Cases, optional
        By default all.

    Raises
    ------
    InputError
        If the folder cannot be written; this is found before anything is solved.
    """
    if out is not None:
        _must_be_writable(out)
    console = _console()
    _print_row(console, _heads(), "bold")
    begin, cpu, blocks = time.perf_counter(), time.process_time(), []
    for block in run_blocks(quick, cases):
        blocks.append(block)
        _print_block(console, block)
    report = Report(tuple(blocks), time.perf_counter() - begin, quick, time.process_time() - cpu)
    for words in not_run(quick, cases):
        console.print(words, markup=False)
    facts = machine()
    console.print(one_line(facts), markup=False)
    facts["seconds"] = f"{report.seconds:.0f}, of the processor {report.cpu_seconds:.0f}"
    console.print(report.summary(), style="bold red" if report.failed else "bold green", markup=False)
    if out is not None:
        for path in write(report, facts, out):
            console.print(f"written: {path}", markup=False)
    return report


def not_run(quick: bool, cases: Iterable[Case] | None = None) -> list[str]:
    """Cases left to the full suite, collected references that no case runs, and why: lines of text."""
    from kshell.verify.cases import all_cases
    from kshell.verify.cases.collected import collected, left_out

    longer = [one.id for one in (all_cases() if cases is None else cases) if not one.quick_runs]
    reasons = left_out()
    count = sum(len(some) for some in reasons.values())
    return [
        *([f"left to the full suite, for time: {', '.join(longer)}"] if quick and longer else []),
        f"not run: {count} of {len(collected())} collected references",
        *(
            f"  {len(some)}, {reason}: {', '.join(one.id for one in some)}"
            for reason, some in reasons.items()
        ),
    ]


def write(report: Report, facts: dict[str, str], folder: Path) -> list[str]:
    """verification.html, verification.csv and the charts as PNG; the paths."""
    from kshell.result.saving import write_together
    from kshell.verify.charts import charts
    from kshell.verify.page import page, table_csv

    pictures = {}
    for name, figure in charts(report, one_line({k: v for k, v in facts.items() if k != "seconds"})).items():
        stream = io.BytesIO()
        figure.savefig(stream, format="png")
        pictures[name] = stream.getvalue()
    texts = {
        "verification.html": page(report, facts, pictures),
        "verification.csv": table_csv(report, facts),
    }
    contents = {**{name: text.encode() for name, text in texts.items()}, **pictures}
    writers: dict[str, Callable[[Path], object]] = {
        name: lambda path, data=data: path.write_bytes(data)  # type: ignore[misc]
        for name, data in contents.items()
    }
    return write_together(folder, writers)


def _must_be_writable(folder: Path) -> None:
    nearest = next(place for place in (folder, *folder.absolute().parents) if place.exists())
    if not nearest.is_dir():
        raise InputError(f"{folder}: {nearest} is a file: give another folder to --out")


def _heads() -> tuple[str, ...]:
    from kshell.verify.page import HEADS

    return HEADS


def _console() -> Console:
    """Rows are as wide as they are: terminals may wrap them, files keep them."""
    from rich.console import Console

    return Console(highlight=False, soft_wrap=True, file=sys.stdout)


def _print_block(console: Console, block: Block) -> None:
    from kshell.verify.page import rows

    for row in rows(Report((block,), block.seconds, quick=True)):
        _print_row(console, row, "red" if row[-1] == "FAILED" else None)
    if block.problem:
        console.print(f"    no answer: {block.problem}", style="red", markup=False)


def _print_row(console: Console, cells: tuple[str, ...], style: str | None) -> None:
    """Names to the left, numbers to the right."""
    text = " ".join(
        f"{cell:<{width}}" if column in (0, 1, 3) else f"{cell:>{width}}"
        for column, (cell, width) in enumerate(zip(cells, WIDTHS, strict=True))
    )
    console.print(text, style=style, markup=False)
