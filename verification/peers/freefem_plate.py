"""Plates by FreeFEM: its Morley element. A script that needs numpy alone, and FreeFem++ on the path.

    python verification/peers/freefem_plate.py JOB.json        see job.py

Arrays of a mesh: points (vertex, 2), triangles (triangle, 3), edges (boundary edge, 2). Of the job: element, morley;
kind, clamped or supported; place (x, y), where w is read. Bending stiffness 1, nu = 0.3, pressure 1. Timed is the whole
run of FreeFem++, start and reading of the mesh included.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import tempfile
from pathlib import Path
from typing import Any

from job import run

PROGRAM = "FreeFem++"
# where distributions put the library of the element
LIBRARIES = ("/usr/lib/freefem++", "/usr/lib/ff++", "/usr/local/lib/ff++")
PROGRAM_TEXT = """load "Morley"
mesh Th = readmesh("mesh.msh");
fespace Vh(Th, P2Morley);
Vh [u, ux, uy], [v, vx, vy];
real nu = 0.3;
varf a([u, ux, uy], [v, vx, vy]) = int2d(Th)((1 - nu) * (dxx(u) * dxx(v) + 2. * dxy(u) * dxy(v) + dyy(u) * dyy(v))
    + nu * (dxx(u) + dyy(u)) * (dxx(v) + dyy(v))) + EDGE;
varf l([u, ux, uy], [v, vx, vy]) = int2d(Th)(v);
matrix A = a(Vh, Vh, solver = sparsesolver);
real[int] b = l(0, Vh);
u[] = A^-1 * b;
cout.precision(15);
cout << "ANSWER " << Vh.ndof << " " << u(X, Y) << " " << int2d(Th)(u) << endl;
"""
# the element holds all of its three components or none, so plain deflection takes a penalty
EDGES = {"clamped": "on(1, u = 0, ux = 0, uy = 0)", "supported": "int1d(Th, 1)(1e9 * u * v)"}


def solve(arrays: dict[str, Any], job: dict[str, Any]) -> Any:
    """Write mesh and program, run."""
    points, triangles, edges = arrays["points"], arrays["triangles"] + 1, arrays["edges"] + 1
    lines = [f"{len(points)} {len(triangles)} {len(edges)}"]
    lines += [f"{x:.16g} {y:.16g} 0" for x, y in points.tolist()]
    lines += [f"{a} {b} {c} 0" for a, b, c in triangles.tolist()]
    lines += [f"{a} {b} 1" for a, b in edges.tolist()]
    x, y = job["place"]
    text = PROGRAM_TEXT.replace("EDGE", EDGES[job["kind"]]).replace("(X, Y)", f"({x!r}, {y!r})")
    folder = Path(tempfile.mkdtemp())
    try:
        (folder / "mesh.msh").write_text("\n".join(lines) + "\n", encoding="utf-8")
        (folder / "plate.edp").write_text(text, encoding="utf-8")
        places = [place for place in LIBRARIES if Path(place).exists()]
        environment = {"FF_LOADPATH": ";".join(f"{place}/" for place in places), **os.environ}
        command = [PROGRAM, "-nw", "-v", "0", "plate.edp"]
        done = subprocess.run(
            command, cwd=folder, capture_output=True, text=True, check=False, env=environment
        )
    finally:
        shutil.rmtree(folder)
    found = re.search(r"ANSWER (\S+) (\S+) (\S+)", done.stdout)
    if not found:
        raise SystemExit(f"FreeFem++ ended with {done.returncode}: {done.stdout.strip()[-200:]}")
    return lambda: {"unknowns": int(found[1]), "w": float(found[2]), "compliance": float(found[3])}


if __name__ == "__main__":
    run(solve, "FreeFEM")
