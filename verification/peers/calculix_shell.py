"""Shells by CalculiX: quadrilaterals of eight nodes with reduced integration, which it expands into solids. Needs ccx.

    python verification/peers/calculix_shell.py JOB.json        see job.py

Arrays of a mesh: points (n, 3), cells (m, 8), normals (n, 3), fixed (n, 6), force (n, 3), read (node, axis, sign).
Of the job: element, a name of CalculiX; material (E, nu, thickness). Timed are the writing of the input and the run of
ccx.
"""

from __future__ import annotations

import re
import shutil
import subprocess
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from job import run

PROGRAM = "ccx"


def _input(arrays: dict[str, Any], job: dict[str, Any]) -> str:
    points, cells, normals = arrays["points"], arrays["cells"], arrays["normals"]
    young, nu, thickness = job["material"]
    lines = ["*NODE, NSET=ALL"]
    lines += [f"{k},{x:.15g},{y:.15g},{z:.15g}" for k, (x, y, z) in enumerate(points.tolist(), start=1)]
    lines.append(f"*ELEMENT, TYPE={job['element']}, ELSET=SHELL")
    lines += [",".join(map(str, [k, *nodes])) for k, nodes in enumerate((cells + 1).tolist(), start=1)]
    lines.append("*NORMAL")  # without them ccx joins neighbours by stiff knots
    for k, nodes in enumerate(cells.tolist(), start=1):
        lines += [f"{k},{node + 1},{','.join(f'{x:.12g}' for x in normals[node])}" for node in nodes]
    lines += ["*MATERIAL, NAME=M", "*ELASTIC", f"{young:.15g},{nu:g}"]
    lines += ["*SHELL SECTION, ELSET=SHELL, MATERIAL=M", f"{thickness:g}", "*BOUNDARY"]
    lines += [f"{node + 1},{axis + 1},{axis + 1}" for node, axis in np.argwhere(arrays["fixed"]).tolist()]
    lines += ["*STEP", "*STATIC", "*CLOAD"]
    loads = np.argwhere(arrays["force"]).tolist()
    lines += [f"{node + 1},{axis + 1},{arrays['force'][node, axis]:.15g}" for node, axis in loads]
    lines += ["*NODE FILE, OUTPUT=2D", "U", "*END STEP", ""]
    return "\n".join(lines)


def _displacements(file: Path, count: int) -> Any:
    """(node, 3) from the last block of displacements of a .frd file."""
    u = np.zeros((count, 3))
    inside = False
    for line in file.read_text(encoding="utf-8").splitlines():
        if line.startswith(" -4"):
            inside = "DISP" in line
        elif line.startswith(" -3"):
            inside = False
        elif inside and line.startswith(" -1") and int(line[3:13]) <= count:
            u[int(line[3:13]) - 1] = [float(line[13 + 12 * k : 25 + 12 * k]) for k in range(3)]
    return u


def solve(arrays: dict[str, Any], job: dict[str, Any]) -> Any:
    """Write, run, keep the text of the answer."""
    folder = Path(tempfile.mkdtemp())
    try:
        (folder / "job.inp").write_text(_input(arrays, job), encoding="utf-8")
        done = subprocess.run([PROGRAM, "-i", "job"], cwd=folder, capture_output=True, text=True, check=False)
        found = re.findall(r"number of equations\s*\n\s*(\d+)", done.stdout)
        if done.returncode or not found:
            raise SystemExit(f"ccx ended with {done.returncode}: {done.stdout[-300:]}")
        u = _displacements(folder / "job.frd", len(arrays["points"]))
    finally:
        shutil.rmtree(folder)

    def read() -> dict[str, Any]:
        node, axis, sign = arrays["read"].tolist()
        compliance = float(np.sum(arrays["force"] * u))
        return {"unknowns": int(found[-1]), "w": sign * float(u[node, axis]), "compliance": compliance}

    return read


if __name__ == "__main__":
    said = subprocess.run([PROGRAM, "-v"], capture_output=True, text=True, check=False).stdout
    number = re.search(r"ersion\s+([\d.]+)", said)
    run(solve, f"CalculiX {number.group(1).rstrip('.') if number else ''}".strip())
