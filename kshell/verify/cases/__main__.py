"""`python -m kshell.verify.cases`: solve the cases and print value, reference and error of each quantity.

Exits with 1 if an error is larger than allowed. `--record` writes what is allowed for quantities that
have nothing recorded yet; what is recorded is never changed.
"""

from __future__ import annotations

import argparse
import json
import math
import sys
import time

from kshell.verify.cases.case import HERE, Case, Outcome
from kshell.verify.cases.catalogue import all_cases

LEAST = 1e-10  # differences of rounding between machines
SUM_LEAST = 1e-9  # of sums of reactions, which rounding makes uncertain
HEADER = (
    f"{'case':38}{'element':18}{'unknowns':>8}  {'quantity':13}{'value':>20}{'reference':>20}"
    f"{'error':>10}{'allowed':>10}"
)


def line(one: Outcome) -> str:
    """One row of the table."""
    mark = "" if one.passed else "  FAILED" if one.allowed else "  nothing recorded"
    if one.unknowns > one.most_unknowns > 0:
        mark += f", {one.most_unknowns} unknowns were enough"
    return (
        f"{one.case:38}{one.run:18}{one.unknowns:8d}  {one.quantity:13}{one.value:20.12g}{one.reference:20.12g}"
        f"{one.error:10.1e}{one.allowed:10.1e}{mark}"
    )


def to_record(one: Outcome, uncertainty: float) -> float:
    """Twice the measured error (1.3 times where it is large), rounded up to two digits.

    More where rounding decides, as in sums of reactions, or the uncertainty of the reference.
    """
    rounding = one.quantity.startswith("reaction") and one.error < 1e-6
    room = 20.0 if rounding else 2.0 if one.error < 0.05 else 1.3
    least = SUM_LEAST if one.quantity.startswith("reaction") else LEAST
    wanted = max(room * one.error, 2 * uncertainty, least)
    digit = 10.0 ** (math.floor(math.log10(wanted)) - 1)
    return float(f"{math.ceil(wanted / digit) * digit:.1e}")


def record(cases: list[Case], outcomes: list[Outcome]) -> None:
    """Add what is missing to allowed.json."""
    path = HERE / "allowed.json"
    allowed = json.loads(path.read_text(encoding="utf-8"))
    by_id = {one.id: one for one in cases}
    for one in outcomes:
        entry = allowed.setdefault(one.case, {}).setdefault(one.run, {"unknowns": one.unknowns, "errors": {}})
        uncertainty = by_id[one.case].references[one.quantity].uncertainty
        entry["errors"].setdefault(one.quantity, to_record(one, uncertainty))
    path.write_text(json.dumps(allowed, indent=1) + "\n", encoding="utf-8")


def main(arguments: list[str] | None = None) -> int:
    """Print the table of the cases whose id contains one of the given words."""
    parser = argparse.ArgumentParser(prog="python -m kshell.verify.cases", description=main.__doc__)
    parser.add_argument("words", nargs="*", help="parts of case ids; all cases without any")
    parser.add_argument("--record", action="store_true", help="record what is allowed where nothing is yet")
    options = parser.parse_args(arguments)
    chosen = [
        one for one in all_cases() if not options.words or any(word in one.id for word in options.words)
    ]
    if not chosen:
        print(f"no case has {' or '.join(options.words)} in its id", file=sys.stderr)
        return 2
    begin, outcomes = time.perf_counter(), []
    print(HEADER)
    for one in chosen:
        for run in one.runs:
            found = one.compare(run, one.solve(run))
            outcomes += found
            print("\n".join(line(outcome) for outcome in found), flush=True)
    if options.record:
        record(chosen, outcomes)
        return 0
    failed = sum(not outcome.passed for outcome in outcomes)
    print(
        f"{len(chosen)} cases, {len(outcomes)} values in {time.perf_counter() - begin:.0f} s: "
        + ("all within what is allowed" if not failed else f"{failed} FAILED")
    )
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
