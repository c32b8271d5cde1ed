"""How fast the differential geometry of charts and meshes is, in one run on one thread.

    python -m verification.benchmarks.geometry

CPU seconds of the best of three. The yardstick beside each chart is the bare numpy evaluation of the sines and
cosines that it needs at the same points: a ratio that does not depend on the machine.
"""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np

import kshell.geometry as g
from kshell.geometry import discrete

POINTS = 1_000_000
PROMISED = 1.0  # seconds for the second forms of a million points


def best(work: Callable[[], object], times: int = 3) -> float:
    """Least CPU seconds of some runs."""
    seconds = []
    for _ in range(times):
        start = time.process_time()
        work()
        seconds.append(time.process_time() - start)
    return min(seconds)


def charts() -> bool:
    """Second forms and curvatures at a million points; True if all keep the promise."""
    random = np.random.default_rng(0)
    u, v = random.uniform(0.2, 2.9, POINTS), random.uniform(0.2, 2.9, POINTS)
    yardstick = best(lambda: (np.sin(u), np.cos(u), np.sin(v), np.cos(v)))
    print(f"{POINTS:,} points; sin and cos of u and v alone: {yardstick:.3f} s")
    print(
        f"{'chart':24s}{'second form':>12s}{'ratio':>7s}{'+ k1, k2':>10s}{'+ directions':>13s}{'order 3':>9s}"
    )
    kept = True
    written = g.Chart.from_expressions("u*cos(v)", "u*sin(v)", "2*v + sin(u*v)", name="expressions")
    traced = g.Chart(
        lambda u, v: (u * np.cos(v), u * np.sin(v), 2 * v + np.sin(u * v)), name="plain function"
    )
    for chart in (
        g.Cylinder(25),
        g.Sphere(1),
        g.Torus(2, 1),
        g.Ellipsoid(3, 2, 1),
        g.Catenoid(1),
        written,
        traced,
    ):
        form = best(lambda chart=chart: chart.at(u, v).second_form)
        values = best(lambda chart=chart: _values(chart, u, v))
        directions = best(lambda chart=chart: chart.at(u, v).principal_directions, 1)
        third = best(lambda chart=chart: chart.map.partials((u, v), 3), 1)
        kept = kept and form < PROMISED
        print(
            f"{chart.name:24s}{form:12.3f}{form / yardstick:7.1f}{values:10.3f}{directions:13.3f}{third:9.3f}"
        )
    return kept


def _values(chart: g.Chart, u: np.ndarray, v: np.ndarray) -> None:
    s = chart.at(u, v)
    _ = s.second_form, s.principal_curvatures


def meshes() -> None:
    """Meshing and discrete curvature of a torus of 131,072 triangles."""
    mesh = g.Torus(2, 1).mesh(512, 128, order=1)
    print(f"torus of {len(mesh.triangles):,} triangles, {len(mesh.points):,} vertices, CPU seconds")
    for name, work in (
        ("mesh of order 1", lambda: g.Torus(2, 1).mesh(512, 128, order=1)),
        ("mesh of order 2", lambda: g.Torus(2, 1).mesh(512, 128, order=2)),
        ("angle defect / area", lambda: discrete.gaussian_curvature(mesh)),
        ("cotangent mean curvature", lambda: discrete.mean_curvature(mesh)),
        ("midedge form", lambda: discrete.midedge(mesh)),
        ("principal, degree 3", lambda: discrete.principal(mesh)),
        ("normal cycle, r = 0.1", lambda: discrete.normal_cycle(mesh, 0.1)),
    ):
        print(f"  {name:28s}{best(work, 1):8.2f}")


def main() -> int:
    """Print the tables; 1 if a chart misses the promise."""
    kept = charts()
    meshes()
    print(f"second forms of {POINTS:,} points in less than {PROMISED:g} s: {'yes' if kept else 'NO'}")
    return 0 if kept else 1


if __name__ == "__main__":
    raise SystemExit(main())
