"""All collected frequencies and buckling factors of plates to a tolerance: intervals against what is known.

    python -m verification.benchmarks.modes [WORDS ...] [--out FOLDER] [--redraw]

Each set is solved from a coarse mesh to intervals of 1e-6 (of omega^2, or of the factor), and ten frequencies of an
L-shape to 1e-4. Prints, and writes to modes.csv and modes.md, for each set: how many values are
known and how well, the largest distance of an answer from one, known values that are outside of their interval by more
than they claim, the widest interval, its kind, unknowns, and processor seconds. Words choose sets by their names;
`--redraw` writes modes.md anew from modes.csv.
"""

from __future__ import annotations

import argparse
import csv
import time
import warnings
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

import kshell as ks
from kshell.verify.cases import meshes, modal
from kshell.verify.cases.case import Case, Reference
from kshell.verify.machine import machine, one_line

HERE = Path(__file__).parent
TOLERANCE = 1e-6
COLUMNS = (
    "set", "values", "claimed", "distance", "outside", "width", "kind", "unknowns", "seconds", "note",
)  # fmt: skip
LIMIT = "20 min"
HEAD = """# Frequencies and buckling factors to a tolerance

`python -m verification.benchmarks.modes`: each set of known values from a coarse mesh to intervals of 1e-6 in omega^2
or in the factor (L-shape 1e-4). "claimed" is the largest relative uncertainty that the known values state, "distance"
the largest one of an answer from a known value, "width" that of the widest interval, relative; of frequencies (omega)
both are half of that of omega^2.

"""
WRONG = """
## Known values outside of their interval

A guaranteed interval rests on Ritz values above and on moments in equilibrium below: a known value outside by more
than its uncertainty is itself wrong, or knows itself less well than it says. Those below were collected from
conforming spline elements on two meshes, whose difference was taken for the uncertainty. At corners with moments of
small powers of the distance that difference is a part of the error only, and the values, Ritz values themselves, lie
above.

"""


@dataclass(frozen=True)
class Set:
    """Values that belong together.

    Attributes
    ----------
    name : str
    scene : Scene
    kind : "omega" or "factor"
    known : dict of str to Reference
        Empty where there are none.
    ordered : bool
        Whether known values are the first ones in order; else each is compared with the nearest.
    options : dict
    """

    name: str
    scene: ks.Scene
    kind: str
    known: Mapping[str, Reference]
    ordered: bool
    options: Mapping[str, Any]


def sets(words: Sequence[str] = ()) -> Iterator[Set]:
    """Those whose names contain one of the words; all without any."""

    def chosen(name: str) -> bool:
        return not words or any(word in name for word in words)

    for case in filter(lambda case: chosen(case.id), modal.cases()):
        kind = "omega" if case.id.startswith("vibration") else "factor"
        yield _of_case(case, kind)
    for held in (ks.Clamped, ks.SimplySupported):
        name = f"vibration.L.{'clamped' if held is ks.Clamped else 'supported'}"
        if not chosen(name):
            continue
        l_shape = modal.scene(meshes.l_shape(8, 0), [held("edge")])
        options = {"analysis": "modes", "count": 10, "tolerance": 1e-4}
        yield Set(name, l_shape, "omega", {}, True, options)


def _of_case(case: Case, kind: str) -> Set:
    disk = "disk" in case.id
    scene = case.build(4, 2 if disk else 1)
    ordered = all(isinstance(quantity, modal.Eigen) for quantity in case.quantities.values())
    count = len(case.references)
    if not ordered:  # as many as it takes to have the largest one that is known
        coarse = _values(ks.solve(case.build(8, 2 if disk else 1), element="argyris", error="off"), kind)
        largest = max(reference.value for reference in case.references.values())
        count = int(np.argmin(np.abs(coarse - largest))) + 1
    if kind == "factor":
        count = 2 * count if "shear" in case.id else count
    options = {"count": count, "tolerance": TOLERANCE}
    return Set(case.id, scene, kind, case.references, ordered, options)


def _values(result: ks.Result, kind: str, key: str = "value") -> Any:
    values = np.array([entry[key] for entry in result.eigen if "name" not in entry], dtype=float)
    if kind == "omega":
        return np.sqrt(np.maximum(values, 0.0))
    signs = np.array([entry["value"] for entry in result.eigen if "name" not in entry])
    return values[signs > 0]


def measured(one: Set) -> dict[str, Any]:
    """The row of a set."""
    begin = time.process_time()
    options = {"element": "argyris", "error": "auto", "limit": LIMIT, **one.options}
    result = ks.solve(one.scene, **options)
    seconds = time.process_time() - begin
    value, lower, upper = (_values(result, one.kind, key) for key in ("value", "lower", "upper"))
    distance, outside, claimed = 0.0, [], 0.0
    for number, (name, known) in enumerate(one.known.items()):
        k = number if one.ordered else int(np.argmin(np.abs(value - known.value)))
        room = known.uncertainty * known.value
        claimed = max(claimed, known.uncertainty)
        distance = max(distance, float(abs(value[k] / known.value - 1.0)))
        if not lower[k] - room <= known.value <= upper[k] + room:
            beyond = known.value / (upper[k] if known.value > upper[k] else lower[k]) - 1.0
            outside.append(
                f"{name} = {known.value:.10g} +- {known.uncertainty:.1e}: {lower[k]:.10g} to {upper[k]:.10g} "
                f"({result.error['kind']}), {beyond:+.1e}"
            )
    width = float(np.max((upper - lower) / value))
    return {
        "set": one.name, "values": len(one.known), "claimed": claimed if one.known else "", "distance": distance
        if one.known else "", "outside": "; ".join(outside), "width": width, "kind": result.error["kind"],
        "unknowns": result.unknowns, "seconds": seconds, "note": result.error.get("why_not", ""),
    }  # fmt: skip


def table(rows: Sequence[Mapping[str, Any]]) -> str:
    """modes.md."""
    shown = ("set", "values", "claimed", "distance", "width", "kind", "unknowns", "seconds")
    lines = [HEAD, f"| {' | '.join(shown)} |", "|" + "---|" * len(shown)]
    for row in rows:
        cells = []
        for key in shown:
            cell = row[key]
            if key in ("claimed", "distance", "width") and cell != "":
                cell = f"{float(cell):.1e}"
            elif key == "seconds":
                cell = f"{float(cell):.2g}"
            cells.append(str(cell))
        lines.append(f"| {' | '.join(cells)} |")
    text = "\n".join(lines) + "\n"
    wrong = [f"- {row['set']}: {row['outside']}" for row in rows if row["outside"]]
    if wrong:
        text += WRONG + "\n".join(wrong) + "\n"
    notes = [f"- {row['set']}: {row['note']}" for row in rows if row["note"]]
    if notes:
        text += "\n## Not reached\n\n" + "\n".join(notes) + "\n"
    return (
        text
        + f"\n{one_line(machine())}, {sum(float(row['seconds']) for row in rows):.0f} processor seconds.\n"
    )


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure, print and write."""
    parser = argparse.ArgumentParser(prog="python -m verification.benchmarks.modes", description=main.__doc__)
    parser.add_argument("words", nargs="*")
    parser.add_argument("--out", type=Path, default=HERE)
    parser.add_argument("--redraw", action="store_true")
    options = parser.parse_args(arguments)
    path = options.out / "modes.csv"
    old: dict[str, Mapping[str, Any]] = {}
    if path.exists():
        with path.open(encoding="utf-8", newline="") as file:
            old = {row["set"]: row for row in csv.DictReader(file)}
    rows = dict(old)
    warnings.simplefilter("ignore", ks.KshellWarning)
    for one in () if options.redraw else sets(options.words):
        rows[one.name] = measured(one)
        print({key: value for key, value in rows[one.name].items() if value != ""}, flush=True)
        with path.open("w", encoding="utf-8", newline="") as file:
            writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
            writer.writeheader()
            writer.writerows(rows.values())
    (options.out / "modes.md").write_text(table(list(rows.values())), encoding="utf-8")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
