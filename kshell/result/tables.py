"""All tables of a result as CSV: probes, extremes, reactions, lines, eigenvalues, paths and envelopes.

With load cases the first column says which. Vectors have a column for each component, "u.x", "M.xy".
"""

from __future__ import annotations

import csv
from collections.abc import Iterator, Mapping
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from kshell.result.saving import Writer, safe

if TYPE_CHECKING:
    from kshell.result.result import Result

Row = dict[str, Any]

TENSORS = ("M", "N", "stress_top", "stress_middle", "stress_bottom", "membrane_stress_resultant")
TENSOR_NAMES, VECTOR_NAMES = ("xx", "yy", "xy"), ("x", "y", "z")


def tables(result: Result) -> dict[str, list[Row]]:
    """Rows of each table, by the name of its file without .csv."""
    out: dict[str, list[Row]] = {}
    for case, one in (result.cases or {"": result}).items():
        first = {"case": case} if case else {}
        for name, rows in _of_one(one):
            out.setdefault(name, []).extend({**first, **row} for row in rows)
    if result.cases:
        out["envelope"] = list(_envelope(result))
    return {name: rows for name, rows in out.items() if rows}


def _of_one(result: Result) -> Iterator[tuple[str, list[Row]]]:
    yield "probes", [{"probe": name, **_flat(values)} for name, values in result.probes.items()]
    yield "extremes", [{"what": name, **_flat(values)} for name, values in result.extremes.items()]
    yield (
        "reactions",
        [
            {"support": name, **_flat({key: values[key] for key in ("force", "moment")})}
            for name, values in result.reactions.items()
        ],
    )
    yield "reactions_along", [row for name in result.along_supports for row in _along(result, name)]
    yield (
        "reactions_at_ends",
        [
            {"support": name, **_flat(end)}
            for name, values in result.along_supports.items()
            for end in values["ends"]
        ],
    )
    yield "eigen", [{"number": k, **_flat(entry)} for k, entry in enumerate(result.eigen, 1)]
    yield "path", [_flat(entry) for entry in result.path]
    for name, values in result.lines.items():
        yield (
            f"line-{safe(name)}",
            [_flat({key: part[k] for key, part in values.items()}) for k in range(len(values["s"]))],
        )


def _along(result: Result, support: str) -> Iterator[Row]:
    values = result.along_supports[support]
    for k in range(len(values["s"])):
        parts = {key: values[key][k] for key in ("line", "s", "x", "force", "moment")}
        yield {"support": support, **_flat(parts)}


def _envelope(result: Result) -> Iterator[Row]:
    for probe, quantities in result.envelope.probes.items():
        for key, found in quantities.items():
            flat = {which: _flat({key: value}) for which, value in found.items()}
            for component in flat["min"]:
                yield {
                    "probe": probe,
                    "quantity": component,
                    **{which: values.get(component) for which, values in flat.items()},
                }


def _flat(values: Mapping[str, Any], before: str = "") -> Row:
    """Numbers and text by dotted names."""
    out: Row = {}
    for key, value in values.items():
        name = f"{before}{key}"
        if isinstance(value, Mapping):
            out |= _flat(value, f"{name}.")
        elif isinstance(value, np.ndarray | list | tuple):
            parts = np.asarray(value).ravel().tolist()
            named = TENSOR_NAMES if key in TENSORS else VECTOR_NAMES
            labels = named[: len(parts)] if np.ndim(value) == 1 and len(parts) <= 3 else range(len(parts))
            out |= {f"{name}.{label}": part for label, part in zip(labels, parts, strict=True)}
        else:
            out[name] = value.item() if isinstance(value, np.generic) else value
    return out


def table_files(result: Result) -> dict[str, Writer]:
    """Functions that write each table, by file name."""
    return {f"{name}.csv": partial(write_csv, rows) for name, rows in tables(result).items()}


def write_csv(rows: list[Row], path: Path) -> None:
    """Write rows; a column that a row does not have is empty there."""
    columns = list(dict.fromkeys(name for row in rows for name in row))
    with path.open("w", newline="", encoding="utf-8") as stream:
        out = csv.DictWriter(stream, columns, restval="")
        out.writeheader()
        out.writerows(rows)
