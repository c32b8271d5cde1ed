"""What benchmarks of random scenes have in common: a run that is cut off, files that are read back, the table."""

from __future__ import annotations

import collections
import json
import signal
import tempfile
import time
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import meshio
import numpy as np

import kshell as ks


def finished(scene: ks.Scene, folder: Path, seconds: float) -> tuple[str, ks.Result | None, float]:
    """Solve and save: outcome, the result or that of the last good state, and the CPU seconds it took.

    Parameters
    ----------
    seconds : float
        CPU time after which it is interrupted, as by Ctrl-C: it must still leave its last good state.
    """
    begin = time.process_time()
    signal.signal(signal.SIGVTALRM, signal.default_int_handler)
    signal.setitimer(signal.ITIMER_VIRTUAL, seconds)
    result: ks.Result | None
    try:
        result, outcome = ks.solve(scene), "ended"
    except ks.InputError as error:
        result, outcome = None, f"refused: {error}"
    except ks.SolveError as error:
        result, outcome = error.state, f"stopped: {error}"
    except KeyboardInterrupt as error:
        result, outcome = getattr(error, "state", None), "out of time"
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0.0)
    took = time.process_time() - begin
    if result is not None:
        result.save(folder)
    return outcome, result, took


def read_back(folder: Path) -> tuple[dict[str, Any], bool]:
    """What is in result.json, which holds numbers only, and whether all fields are finite."""

    def refused(text: str) -> float:
        raise ValueError(f"{text} in result.json")

    found = json.loads((folder / "result.json").read_text(encoding="utf-8"), parse_constant=refused)
    fields = meshio.read(folder / "result.vtu").point_data
    return found, all(np.isfinite(values).all() for values in fields.values())


def table(first: int, last: int, one: Callable[[int, Path], tuple[str, str, float]]) -> None:
    """Print the rows of the seeds from the first to before the last, and what came out.

    Parameters
    ----------
    one : function
        Of a seed and a folder: the row without its end, the outcome and the CPU seconds.
    """
    warnings.simplefilter("ignore")
    outcomes: collections.Counter[str] = collections.Counter()
    times = []
    for seed in range(first, last):
        with tempfile.TemporaryDirectory() as name:
            row, outcome, took = one(seed, Path(name))
        outcomes[outcome.split(":")[0]] += 1
        times.append(took)
        print(f"{row} {took:.1f} | {outcome} |", flush=True)
    counts = ", ".join(f"{count} {word}" for word, count in sorted(outcomes.items()))
    print(f"\n{counts}; CPU seconds: median {np.median(times):.2f}, largest {max(times):.1f}")
