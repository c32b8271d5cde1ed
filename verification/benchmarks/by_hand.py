"""What a tolerance takes against the best mesh by hand: plates from coarse meshes, without a look at their answers.

    python -m verification.benchmarks.by_hand [--tolerance 1e-2 ...] [--only skew] [--repeats 3]

By hand: the cheapest mesh of a sweep from which on all finer ones are within the tolerance, which takes the sweep and
the answer, of uniform meshes with Argyris elements. Processor seconds of whole solves, the least of some. Enough is at
most three times that and .15 s. Where no mesh of the sweep is within the tolerance, as of the L from 1e-4 on, nothing
is compared.
"""

from __future__ import annotations

import argparse
import dataclasses
import time
import warnings
from collections.abc import Iterator
from typing import Any

import kshell as ks
from kshell.verify.cases.case import Case
from kshell.verify.cases.catalogue import find
from kshell.verify.cases.quantities import At

TOLERANCES = (1e-2, 1e-3, 1e-4, 1e-5)
CASES = (
    "ssss.uniform.ba1", "ssss.hydrostatic.ba1", "clamped.uniform.ba1", "clamped.uniform.ba2", "levy.SFSF.ba1",
    "levy.SFSC.ba1.5", "skew.ss.75", "skew.clamped.60", "triangle.ss.equilateral", "disk.clamped.uniform",
    "annulus.CC.q.b0.5", "lshape.clamped",
)  # fmt: skip
CELLS = (2, 3, 4, 6, 8, 12, 16, 24, 32)
TIMES, MORE = 3.0, 0.15


def goal_of(case: Case) -> tuple[str, At]:
    """The first deflection of a case."""
    return next((name, q) for name, q in case.quantities.items() if isinstance(q, At) and q.component == "w")


def seconds_of(scene: Any, repeats: int, **options: Any) -> tuple[float, Any]:
    """The least processor seconds of some solves, and the result."""
    least, result = float("inf"), None
    for _ in range(repeats):
        begin = time.process_time()
        result = ks.solve(scene, **options)
        least = min(least, time.process_time() - begin)
    return least, result


def rows(only: str, tolerances: list[float], repeats: int) -> Iterator[dict[str, Any]]:
    """One for each case and tolerance."""
    for id in CASES:
        if only not in id:
            continue
        case = find(id)
        name, quantity = goal_of(case)
        known = case.references[name]
        sweep = []
        for n in CELLS:
            scene = dataclasses.replace(case.build(n, 1), probes={"goal": (*quantity.point, 0.0)})
            seconds, found = seconds_of(
                scene, repeats, element="argyris", error="off", large_deflection=False
            )
            sweep.append((known.error(found.probes["goal"]["u"][2]), seconds, n))
        start = dataclasses.replace(case.build(CELLS[0], 1), probes={"goal": (*quantity.point, 0.0)})
        for tolerance in tolerances:
            room = max(tolerance, known.uncertainty)
            good = [k for k in range(len(sweep)) if max(e for e, _, _ in sweep[k:]) <= room]
            hand = min((sweep[k][1:] for k in good), default=None)
            seconds, found = seconds_of(
                start,
                repeats,
                tolerance=tolerance,
                quantity="goal",
                element="auto",
                order="auto",
                large_deflection=False,
            )
            off = known.error(found.probes["goal"]["u"][2])
            reached = found.error["estimate"] is not None and found.error["estimate"] <= tolerance
            yield {
                "case": id,
                "tolerance": tolerance,
                "seconds": seconds,
                "levels": len(found.error["levels"]),
                "hand": None if hand is None else hand[0],
                "cells": None if hand is None else hand[1],
                "right": reached and off <= room,
            }


def main() -> None:
    """Print the table and what it sums up to."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0] if __doc__ else None)
    parser.add_argument("--tolerance", type=float, nargs="*", default=list(TOLERANCES))
    parser.add_argument("--only", default="", help="part of the names of cases")
    parser.add_argument("--repeats", type=int, default=3)
    chosen = parser.parse_args()
    warnings.simplefilter("ignore", ks.KshellWarning)
    compared = enough = 0
    for row in rows(chosen.only, chosen.tolerance, chosen.repeats):
        hand = row["hand"]
        words = "no mesh of the sweep"
        if hand is not None:
            compared += 1
            good = row["right"] and row["seconds"] <= TIMES * hand + MORE
            enough += good
            words = f"{hand:6.3f} s ({row['cells']} cells) {row['seconds'] / hand:6.1f} times"
            words += "" if good else "  TOO MUCH"
        print(
            f"{row['case']:26}{row['tolerance']:8.0e}{row['seconds']:8.3f} s {row['levels']:2} levels "
            f"{'' if row['right'] else 'NOT REACHED '} by hand {words}",
            flush=True,
        )
    print(f"{enough} of {compared} take at most {TIMES:g} times as much as by hand and {MORE} s")


if __name__ == "__main__":
    main()
