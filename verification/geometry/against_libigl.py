"""The same quantities by libigl, where it has them.

    python -m verification.geometry.against_libigl      (needs libigl)

Angle defects, mixed Voronoi areas and the cotangent mean curvature vector are the same formulas, so they must
agree to rounding; principal curvatures are fitted differently, so both are compared with the exact ones.
"""

from __future__ import annotations

import time

import igl
import numpy as np

import kshell.geometry as g
from kshell.geometry import discrete
from kshell.mesh.mesh import Mesh
from verification.geometry.meshes import TorusMesh, random_sphere

SAME_FORMULA = 1e-9


def same_formulas(mesh: Mesh) -> dict[str, float]:
    """Largest relative difference of each quantity that both compute by one formula."""
    v, f = mesh.points, mesh.triangles.astype(np.int64)
    voronoi = igl.massmatrix(v, f, igl.MASSMATRIX_TYPE_VORONOI).diagonal()
    barycentric = igl.massmatrix(v, f, igl.MASSMATRIX_TYPE_BARYCENTRIC).diagonal()
    vector = (igl.cotmatrix(v, f) @ v) / voronoi[:, None]
    pairs = {
        "area": (discrete.area(mesh), igl.doublearea(v, f).sum() / 2),
        "angle defect": (discrete.angle_defect(mesh), igl.gaussian_curvature(v, f)),
        "mixed Voronoi area": (discrete.vertex_areas(mesh), voronoi),
        "barycentric area": (discrete.vertex_areas(mesh, "barycentric"), barycentric),
        "mean curvature vector": (discrete.mean_curvature_vector(mesh), vector),
    }
    return {
        name: float(np.abs(np.subtract(mine, theirs)).max() / np.abs(theirs).max())
        for name, (mine, theirs) in pairs.items()
    }


def principal_errors(case: TorusMesh) -> dict[str, tuple[float, float, float]]:
    """Largest and root-mean-square error of k1, k2, and seconds, for both programs."""
    mesh, exact = case.mesh, case.at_vertices.principal_curvatures
    start = time.perf_counter()
    mine = discrete.principal(mesh).principal_curvatures
    middle = time.perf_counter()
    _, _, high, low = igl.principal_curvature(mesh.points, mesh.triangles.astype(np.int64))[:4]
    end = time.perf_counter()
    # libigl's sign is that of the opposite normal
    theirs = np.sort(np.stack([-high, -low], axis=1), axis=1)[:, ::-1]
    if np.abs(theirs - exact).max() > np.abs(-theirs[:, ::-1] - exact).max():
        theirs = -theirs[:, ::-1]
    return {
        name: (float(np.abs(k - exact).max()), float(np.sqrt(np.mean((k - exact) ** 2))), seconds)
        for name, k, seconds in (("kshell", mine, middle - start), ("libigl", theirs, end - middle))
    }


def main() -> int:
    """Print both comparisons; 1 if quantities of the same formula differ."""
    worst = 0.0
    for label, mesh in {
        "ellipsoid 3, 2, 1": g.Ellipsoid(3, 2, 1).mesh(60, 40, order=1),
        "irregular torus": TorusMesh(32, shake=0.2).mesh,
        "random sphere": random_sphere(2000, seed=1),
    }.items():
        print(
            f"{label}: relative difference to libigl {igl.__version__ if hasattr(igl, '__version__') else ''}"
        )
        for name, difference in same_formulas(mesh).items():
            worst = max(worst, difference)
            print(f"  {name:24s}{difference:10.1e}")
    print("principal curvatures of the torus: largest error, rms error, seconds")
    for shake in (0.0, 0.2):
        for n in (32, 64, 128):
            for name, (largest, rms, seconds) in principal_errors(TorusMesh(n, shake=shake)).items():
                print(f"  shake {shake} n {n:4d} {name:7s}{largest:10.1e}{rms:10.1e}{seconds:8.2f}")
    return int(worst > SAME_FORMULA)


if __name__ == "__main__":
    raise SystemExit(main())
