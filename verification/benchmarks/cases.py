"""What a second load case costs beside the first: processor seconds of scenes with one case and with two, in turn.

    python -m verification.benchmarks.cases [--pairs N] [NAME ...]

Prints for each scene the processor seconds with one case, and what a second one adds to them, the median of all pairs:
with the settings of `ks.solve`, estimates among them, with large_deflection = false, and with all files written.
"""

from __future__ import annotations

import argparse
import gc
import tempfile
import time
import warnings
from functools import partial
from typing import Any

import numpy as np

import kshell as ks

OPTIONS: dict[str, tuple[dict[str, Any], bool]] = {
    "as it is": ({}, False),
    "small deflections": ({"large_deflection": False}, False),
    "with files": ({"large_deflection": False}, True),
}


def plate(n: int, count: int) -> ks.Scene:
    """A square of 2 n^2 triangles between a clamped and a supported side, under so many of two loads."""
    mesh = ks.geometry.Plane().mesh(n, n, 1, ("left", "right", "bottom", "top"), (0, 1), (0, 1), "alternate")
    loads = [ks.Pressure("-100 - 20 * y", name="snow"), ks.Pressure("-50 - 50 * x", name="wind")]
    return ks.Scene(
        mesh=mesh,
        thickness=0.01,
        material=ks.Isotropic(E=210e9, nu=0.3, density=7850),
        supports=[ks.Clamped("left"), ks.SimplySupported("right")],
        loads=loads[:count],
        cases=[ks.Case(load.name, [load.name]) for load in loads[:count]],
        probes={"centre": (0.5, 0.5, 0.0), "free": (0.5, 0.0, 0.0)},
    )


def shell(n: int, count: int) -> ks.Scene:
    """A roof of 2 n^2 triangles of order 2, likewise."""
    mesh = ks.geometry.Cylinder(R=25.0).mesh(n, n, 2, ("a", "b", "c", "d"), (0, 0.7), (0, 25), "alternate")
    loads = [ks.Pressure("-1 - 0.01 * y", name="wind"), ks.Traction((0, 0, "-0.02 * x"), name="snow")]
    x, z = 25 * np.cos(0.35), 25 * np.sin(0.35)
    return ks.Scene(
        mesh=mesh,
        thickness=0.25,
        material=ks.Isotropic(E=4.32e8, nu=0.2),
        supports=[ks.Clamped("a"), ks.Fixed("c", "xz")],
        loads=loads[:count],
        cases=[ks.Case(load.name, [load.name]) for load in loads[:count]],
        probes={"middle": (x, z, 12.5), "free": (x, z, 0.0)},
    )


SCENES = {
    "plate of 128": partial(plate, 8),
    "plate of 1152": partial(plate, 24),
    "shell of 128": partial(shell, 8),
    "shell of 1152": partial(shell, 24),
}


def seconds(scene: ks.Scene, options: dict[str, Any], files: bool) -> float:
    """Processor seconds of a solution."""
    gc.collect()
    begin = time.process_time()
    result = ks.solve(scene, **options)
    if files:
        with tempfile.TemporaryDirectory() as folder:
            result.save(folder)
    return time.process_time() - begin


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("names", nargs="*", metavar="NAME", help=", ".join(SCENES))
    parser.add_argument("--pairs", type=int, default=15)
    given = parser.parse_args()
    warnings.simplefilter("ignore", ks.KshellWarning)
    print(f"{'scene':<16} {'options':<18} {'first, ms':>10} {'second':>7}")
    for name in given.names or SCENES:
        for words, (options, files) in OPTIONS.items():
            one, two = (SCENES[name](count) for count in (1, 2))
            seconds(one, options, files), seconds(two, options, files)
            pairs = np.array(
                [(seconds(one, options, files), seconds(two, options, files)) for _ in range(given.pairs)]
            )
            first = float(np.median(pairs[:, 0]))
            more = float(np.median(pairs[:, 1] - pairs[:, 0]))
            print(f"{name:<16} {words:<18} {1e3 * first:>10.1f} {more / first:>7.1%}", flush=True)


if __name__ == "__main__":
    main()
