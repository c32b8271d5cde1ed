"""How often a tolerance is met: all linear static cases with known deflections or energies, from coarse meshes.

    python -m verification.benchmarks.coverage [--tolerance 1e-3 ...] [--limit 10] [--only skew] [--csv FILE]

Each case is solved to each tolerance without a look at its reference. Then: "met" where the tolerance is said to be
reached and the reference agrees, "not reached" where the result says so and the reference lies in its interval,
"outside" where the reference lies outside of the interval, "missed" where in addition the tolerance is said to be
reached and is not. References count as known to their uncertainty.
"""

from __future__ import annotations

import argparse
import csv
import dataclasses
import time
import warnings
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

import kshell as ks
from kshell.verify.cases.case import TRUE_SURFACE, Case, Run
from kshell.verify.cases.catalogue import all_cases
from kshell.verify.cases.quantities import At, Compliance, Moves

TOLERANCES = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6)
COLUMNS = (
    "case", "quantity", "tolerance", "outcome", "kind", "half_width", "error", "uncertainty", "levels", "unknowns",
    "seconds", "why",
)  # fmt: skip
ROUNDING = 1e-10  # of references
AS_IT_IS = ("ssss.patch.u0.1",)  # a group of triangles is loaded, which coarser meshes do not have


def start(case: Case) -> Run | None:
    """A mesh half as fine as the coarsest that a case is checked on, on the true surface where there is one."""
    runs = [run for run in case.runs if run.element in ("argyris", "koiter") and run.degree != 1]
    if not runs:
        return None
    best = min(runs, key=lambda run: (run.order != TRUE_SURFACE, run.order != 2, run.refinement))
    return best if case.id in AS_IT_IS else dataclasses.replace(best, refinement=max(2, best.refinement // 2))


def goals(case: Case) -> dict[str, Any]:
    """The quantities of a case that intervals are made for."""
    return {
        name: quantity
        for name, quantity in case.quantities.items()
        if isinstance(quantity, Compliance)
        or (isinstance(quantity, At) and quantity.component == "w")
        or (isinstance(quantity, Moves) and quantity.kind == "u")
    }


def judged(case: Case, name: str, quantity: Any, tolerance: float, limit: float) -> dict[str, Any] | None:
    """One row of the table; None for scenes that are not linear and static."""
    run = start(case)
    if run is None:
        return None
    scene = case.build(run.refinement, run.order)
    if scene.solve.analysis != "static" or scene.solve.large_deflection is not False or scene.cases:
        return None
    options: dict[str, Any] = {
        "tolerance": tolerance,
        "limit": f"{limit:g} s",
        "element": "auto",
        "order": "auto",
    }
    if isinstance(quantity, Compliance):
        options["quantity"] = "energy"
    else:
        point = (*quantity.point, 0.0) if isinstance(quantity, At) else quantity.point
        scene = dataclasses.replace(scene, probes={"goal": point})
        options["quantity"] = "goal"
    begin = time.process_time()
    try:
        result = ks.solve(scene, **options)
    except ks.KshellError as error:
        seconds = time.process_time() - begin
        return {"outcome": "refused", "why": str(error), "seconds": seconds, "levels": 0, "unknowns": 0}
    seconds = time.process_time() - begin
    if isinstance(quantity, Compliance):
        energy = result.error["energy"]
        value = (energy["upper"] + energy["lower"]) / quantity.force
        half = (energy["upper"] - energy["lower"]) / quantity.force
        kind = energy["kind"]
    else:
        found = result.error["probes"]["goal"]["u"]
        direction = np.array((0.0, 0.0, 1.0) if isinstance(quantity, At) else quantity.direction)
        value = float(result.probes["goal"]["u"] @ direction)
        half, kind = float(found["half_width"] @ np.abs(direction)), found["kind"]
    known = case.references[name]
    off = abs(value - known.value)
    room = known.uncertainty * known.scale + ROUNDING * abs(known.value)
    size = (
        abs(value) if isinstance(quantity, Compliance) else float(np.linalg.norm(result.probes["goal"]["u"]))
    )
    reached = result.error["estimate"] is not None and result.error["estimate"] <= tolerance
    inside = off <= half + room
    if not inside:
        outcome = "missed" if reached and off > tolerance * size + room else "outside"
    else:
        outcome = "met" if reached else "not reached"
    return {
        "outcome": outcome,
        "kind": kind,
        "half_width": half / size,
        "error": off / size,
        "uncertainty": room / size,
        "levels": len(result.error["levels"]),
        "unknowns": result.unknowns,
        "seconds": seconds,
        "why": "" if reached else result.error.get("why_not", ""),
    }


def table(tolerances: list[float], limit: float, only: str) -> Iterator[dict[str, Any]]:
    """All rows."""
    for case in all_cases():
        if only not in case.id:
            continue
        for name, quantity in goals(case).items():
            for tolerance in tolerances:
                row = judged(case, name, quantity, tolerance, limit)
                if row is not None:
                    yield {"case": case.id, "quantity": name, "tolerance": tolerance, **row}


def main() -> None:
    """Print the table and what it sums up to."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0] if __doc__ else None)
    parser.add_argument("--tolerance", type=float, nargs="*", default=list(TOLERANCES))
    parser.add_argument("--limit", type=float, default=10.0, help="seconds for each run")
    parser.add_argument("--only", default="", help="part of the names of cases")
    parser.add_argument("--csv", type=Path)
    chosen = parser.parse_args()
    warnings.simplefilter("ignore", ks.KshellWarning)
    rows = []
    for row in table(chosen.tolerance, chosen.limit, chosen.only):
        rows.append(row)
        print(
            f"{row['case']:32} {row['quantity']:12} {row['tolerance']:7.0e} {row['outcome']:12} "
            f"{row.get('kind', ''):10} half {row.get('half_width', np.nan):8.1e} error {row.get('error', np.nan):8.1e} "
            f"({row.get('uncertainty', np.nan):.0e}) {row['levels']:2} levels {row['unknowns']:6} "
            f"{row['seconds']:6.2f} s {row['why'][:70]}",
            flush=True,
        )
    if chosen.csv is not None:
        with chosen.csv.open("w", newline="", encoding="utf-8") as file:
            writer = csv.DictWriter(file, COLUMNS, extrasaction="ignore", lineterminator="\n")
            writer.writeheader()
            writer.writerows(
                {key: f"{v:.3g}" if isinstance(v, float) else v for key, v in row.items()} for row in rows
            )
    for tolerance in chosen.tolerance:
        here = [row for row in rows if row["tolerance"] == tolerance]
        count, seconds = Counter(row["outcome"] for row in here), [row["seconds"] for row in here]
        print(
            f"{tolerance:.0e}: {len(here)} runs, "
            + ", ".join(f"{number} {word}" for word, number in count.most_common())
            + f"; seconds median {np.median(seconds):.2f}, largest {max(seconds):.2f}"
        )


if __name__ == "__main__":
    main()
