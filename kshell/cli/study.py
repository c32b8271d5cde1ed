"""`kshell converge`: the study, its tables in 80 columns, and its files."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from kshell.result.saving import write_together

if TYPE_CHECKING:
    from kshell.analysis.converge import Convergence


def study_lines(study: Convergence) -> Iterator[str]:
    """A table for each element and quantity: unknowns, value, difference to the mesh before, rate."""
    if study.title:
        yield study.title
    for series in study.series:
        for name, values in series.values.items():
            yield ""
            yield f"{series.element}, order {series.order}: {name}"
            yield f"{'unknowns':>10} {'size h':>11} {'value':>20} {'change':>10} {'rate':>6} {'seconds':>8}"
            for k, (value, rate) in enumerate(zip(values, series.rates(name), strict=True)):
                change = "" if k == 0 else f"{value - values[k - 1]:.2e}"
                shown = "" if rate is None else f"{rate:.2f}"
                yield (
                    f"{series.unknowns[k]:>10} {series.size[k]:>11.4g} {value:>20.12g} {change:>10} {shown:>6} "
                    f"{series.seconds[k]:>8.2f}"
                )
            limit = series.limit(name)
            yield (
                "no rate: the changes are rounding, or do not fall"
                if limit is None
                else f"tends to {limit:.12g}"
            )
    for note in study.notes:
        yield f"warning: {note}"


def save_study(study: Convergence, folder: Path) -> list[str]:
    """Write convergence.json and convergence.png."""
    from kshell.draw.levels_plot import study_figure

    text = json.dumps(study.to_dict(), indent=1, allow_nan=False, ensure_ascii=False) + "\n"
    figure = study_figure(study)
    return write_together(
        folder,
        {
            "convergence.json": lambda path: path.write_text(text, encoding="utf-8"),
            "convergence.png": lambda path: figure.savefig(path, dpi=150, format="png"),
        },
    )
