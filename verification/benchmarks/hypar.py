"""The partly clamped hyperbolic paraboloid refined: what its references rest on.

    python -m verification.benchmarks.hypar

Two unlike discretisations of the same energy on the true surface, both graded towards all sides: cubic Koiter
elements, and Argyris functions, whose compliance stays below that of the shell. Where the clamped side ends the moments
are singular, so sequences on uniform meshes stop too early. About a minute and 1 GB.
"""

from __future__ import annotations

from kshell.verify.cases.case import TRUE_SURFACE, Run
from kshell.verify.cases.doubly_curved import hypars

REFINED = [Run("koiter", n, TRUE_SURFACE, 3) for n in (24, 48, 96)]
REFINED += [Run("argyris", n, TRUE_SURFACE) for n in (16, 32, 64)]


def main() -> None:
    """Print the table."""
    print(f"{'case':24}{'element':18}{'unknowns':>9}{'w at the tip':>20}{'compliance':>20}{'step':>10}")
    for case in hypars():
        element, before = "", 0.0
        for run in REFINED:
            found = {one.quantity: one for one in case.compare(run, case.solve(run))}
            w, compliance = found["w_tip"].value, found["compliance"].value
            step = f"{before / w - 1:10.1e}" if element == run.element else ""
            element, before = run.element, w
            row = f"{case.id:24}{run.name:18}{found['w_tip'].unknowns:9d}{w:20.10g}{compliance:20.10g}{step}"
            print(row, flush=True)


if __name__ == "__main__":
    main()
