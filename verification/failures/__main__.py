"""`python -m verification.failures [--quick] [id ...]`: print the numbers and draw the pictures."""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path

from verification.failures import GALLERY
from verification.failures.failure import text_table

PICTURES = Path(__file__).parents[1] / "pictures" / "failures"


def main() -> int:
    """Entries named, or all."""
    import matplotlib as mpl

    mpl.use("Agg")
    parser = argparse.ArgumentParser(prog="python -m verification.failures", description=main.__doc__)
    parser.add_argument("ids", nargs="*", choices=[*GALLERY, []], metavar="id", help=", ".join(GALLERY))
    parser.add_argument("--quick", action="store_true", help="few, coarse meshes; pictures are not replaced")
    options = parser.parse_args()
    for entry in (GALLERY[id] for id in options.ids or GALLERY):
        begin = time.perf_counter()
        numbers = entry.measure(options.quick)
        print(f"{entry.title} ({time.perf_counter() - begin:.0f} s)\n{text_table(numbers)}\n", flush=True)
        if not options.quick:
            PICTURES.mkdir(parents=True, exist_ok=True)
            entry.draw(numbers).savefig(PICTURES / f"{entry.id}.png", dpi=80)
    return 0


if __name__ == "__main__":
    sys.exit(main())
