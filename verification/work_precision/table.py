"""The table of all measurements as a file of comma separated values, with what it was measured on above it."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from pathlib import Path
from typing import Any

FOLDER = Path(__file__).parents[1] / "pictures" / "work_precision"
NAME = "work_precision.csv"
TEXT = ("problem", "method", "version")


def read(path: Path = FOLDER / NAME) -> tuple[dict[str, str], list[dict[str, Any]]]:
    """Facts and rows of a table."""
    lines = path.read_text(encoding="utf-8").splitlines()
    facts = dict(line[2:].split(": ", 1) for line in lines if line.startswith("# "))
    rows = csv.DictReader(line for line in lines if not line.startswith("#"))
    return facts, [{k: v if k in TEXT else float(v) for k, v in row.items()} for row in rows]


def write(path: Path, facts: dict[str, str], rows: Sequence[dict[str, Any]]) -> None:
    """Of at least one row."""
    with path.open("w", encoding="utf-8", newline="") as stream:
        stream.writelines(f"# {key}: {value}\n" for key, value in facts.items())
        writer = csv.DictWriter(stream, list(rows[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(
            {k: f"{v:.6g}" if isinstance(v, float) else v for k, v in row.items()} for row in rows
        )


def rounded(row: dict[str, Any]) -> dict[str, Any]:
    """With as many digits as the file has, so that tables made from either are the same."""
    return {k: float(f"{v:.6g}") if isinstance(v, float) else v for k, v in row.items()}
