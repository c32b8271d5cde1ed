"""Write the summary of a full run into verification/README.md, and its charts beside it.

kshell verify --out report
python -m verification.summary report
"""

from __future__ import annotations

import csv
import shutil
import statistics
import sys
from collections.abc import Iterable
from pathlib import Path

from kshell.verify.cases import all_cases
from kshell.verify.cases.case import method_of
from kshell.verify.cases.collected import collected, left_out
from kshell.verify.charts import MARKS

HERE = Path(__file__).parent
BEGIN, END = "<!-- summary: python -m verification.summary -->\n", "<!-- end of the summary -->\n"
CHARTS = ("margins.png", "rates.png", "errors.png")
KINDS = {  # families of cases in words
    "shells on structured meshes": ("shell",),
    "shell scenes on gmsh meshes": ("gmsh",),
    "large deflections": ("large",),
}


def read(folder: Path) -> tuple[dict[str, str], list[dict[str, str]]]:
    """The facts and the rows of verification.csv."""
    lines = (folder / "verification.csv").read_text(encoding="utf-8").splitlines()
    facts = dict(line[2:].split(": ", 1) for line in lines if line.startswith("# "))
    return facts, list(csv.DictReader(line for line in lines if not line.startswith("#")))


def table(facts: dict[str, str], rows: list[dict[str, str]]) -> str:
    """The summary as Markdown."""
    rates = [row for row in rows if row["quantity"].startswith("rate ")]
    values = [row for row in rows if row not in rates]
    failed = [row for row in rows if row["verdict"] != "passed"]
    worst = max(rows, key=lambda row: float(row["error"]) / max(float(row["allowed"]), 1e-300))
    ratio = float(worst["error"]) / float(worst["allowed"])
    kinds = {**{words: _cases(values, names) for words, names in KINDS.items()}}
    others = {row["case"] for row in values} - set().union(*kinds.values())
    not_run = sum(len(some) for some in left_out().values())
    quick = [one for one in all_cases() if one.quick_runs]
    lines = [
        f"| what | {facts['processor']}, commit {facts['commit']} |",
        "|---|---|",
        f"| cases with a known answer | {len({row['case'] for row in values})}: {len(others)} plates, "
        + ", ".join(f"{len(some)} {words}" for words, some in kinds.items())
        + " |",
        f"| values compared by `kshell verify` | {len(values)} on all meshes with all elements, and {len(rates)} rates "
        f"of convergence; seconds: {facts['seconds']} |",
        f"| quick, `kshell verify --quick` | {len(quick)} cases, coarse meshes |",
        f"| failed | {len(failed) or 'none'}; worst ratio of error to allowed error {ratio:.2g} ({worst['case']} "
        f"{worst['mesh']}, {worst['quantity']}) |",
        "| median relative error | " + "; ".join(_medians(values)) + " |",
        f"| collected references | {len(collected()) - not_run} of {len(collected())} run; the others with their "
        "reasons at the end of `kshell verify` |",
    ]
    return "\n".join(lines) + "\n"


def _cases(rows: Iterable[dict[str, str]], families: tuple[str, ...]) -> set[str]:
    return {row["case"] for row in rows if row["case"].partition(".")[0] in families}


def _medians(rows: list[dict[str, str]]) -> Iterable[str]:
    for method, (_, _, words) in MARKS.items():
        own = [row for row in rows if method_of(row["mesh"]) == method]
        if own:
            unknowns = statistics.median(int(row["unknowns"]) for row in own)
            error = statistics.median(float(row["error"]) for row in own)
            yield f"{words} {error:.0e} ({unknowns:.0f} unknowns)"


def main(folder: Path) -> None:
    """Replace what stands between the marks, and copy the charts."""
    path = HERE / "README.md"
    text = path.read_text(encoding="utf-8")
    front, rest = text.split(BEGIN)
    back = rest.split(END)[1]
    path.write_text(front + BEGIN + table(*read(folder)) + END + back, encoding="utf-8")
    for name in CHARTS:
        shutil.copy(folder / name, HERE / "pictures" / "suite" / name)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
