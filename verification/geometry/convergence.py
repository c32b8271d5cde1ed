"""Errors of discrete curvature on sequences of meshes of a torus.

python -m verification.geometry.convergence      prints the tables and draws the chart
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from kshell.geometry import discrete
from verification.geometry.meshes import TorusMesh

if TYPE_CHECKING:
    from matplotlib.figure import Figure

FAMILIES = {
    "valence 6": {"pattern": "diagonal"},
    "valence 4 and 8": {"pattern": "crossed"},
    "irregular": {"pattern": "diagonal", "shake": 0.2},
}
QUANTITIES = {
    "area": "area, relative",
    "defect": "K: angle defect / mixed area",
    "cotangent": "H: cotangent / mixed area",
    "principal": "k1, k2: fitted polynomial, degree 3",
    "direction": "principal direction, fitted (radians)",
    "cycle": "k1, k2: normal cycle, r ~ sqrt(h)",
    "cycle_defect": "K: defects in balls (rms), r ~ sqrt(h)",
    "midedge_exact": "k1, k2: midedge form, exact directors",
    "midedge_mean": "k1, k2: midedge form, mean directors",
}


def torus_errors(
    n: int, pattern: str = "diagonal", shake: float = 0.0, balls: bool = True
) -> dict[str, float]:
    """Largest errors over the mesh (root of the mean square for the defects in balls).

    ``balls`` says whether what is summed over balls is among them, which takes most of the time.
    """
    case = TorusMesh(n, pattern, shake)
    mesh, s = case.mesh, case.at_vertices
    fit = discrete.principal(mesh)
    cosine = np.abs(np.sum(fit.principal_directions[:, 0] * s.principal_directions[:, 0], axis=1))
    exact_form, mean_form = discrete.midedge(mesh, case.edge_normals), discrete.midedge(mesh)
    k_triangle = case.at_triangles.principal_curvatures
    errors = {
        "area": discrete.area(mesh) / case.torus.area() - 1,
        "defect": discrete.gaussian_curvature(mesh) - s.gaussian_curvature,
        "cotangent": discrete.mean_curvature(mesh) - s.mean_curvature,
        "principal": fit.principal_curvatures - s.principal_curvatures,
        "direction": np.arccos(np.minimum(cosine, 1.0)),
        "midedge_exact": exact_form.principal_curvatures - k_triangle,
        "midedge_mean": mean_form.principal_curvatures - k_triangle,
    }
    if balls:
        found = discrete.normal_cycle(mesh, radius=1.3 * np.sqrt(2 * np.pi / n))
        errors["cycle"] = found.principal_curvatures - s.principal_curvatures
        errors["cycle_defect"] = np.sqrt(np.mean((found.defect - s.gaussian_curvature) ** 2))
    return {name: float(np.abs(error).max()) for name, error in errors.items()}


def table(sizes: tuple[int, ...] = (16, 32, 64)) -> dict[str, list[dict[str, float]]]:
    """Errors for each family of meshes and each size."""
    return {name: [torus_errors(n, **options) for n in sizes] for name, options in FAMILIES.items()}


def draw(errors: dict[str, list[dict[str, float]]], sizes: tuple[int, ...]) -> Figure:
    """One panel per family: error against edge length, with slopes 1 and 2."""
    import matplotlib.pyplot as plt

    figure, panels = plt.subplots(1, len(errors), figsize=(13, 5), sharey=True, layout="constrained")
    h = 2 * np.pi / np.array(sizes)
    for axes, (family, rows) in zip(panels, errors.items(), strict=True):
        for k, (name, label) in enumerate(QUANTITIES.items()):
            style = {"color": f"C{k}", "marker": "os^vDP*Xd"[k], "markersize": 5, "linewidth": 1.2}
            axes.loglog(h, [row[name] for row in rows], label=label, **style)
        for slope in (1, 2):
            axes.loglog(h, 2e-4 * (h / h[-1]) ** slope, color="0.6", linestyle="--", linewidth=1)
            place = (h[0], 2e-4 * (h[0] / h[-1]) ** slope)
            axes.annotate(f"order {slope}", place, color="0.4", fontsize=8, ha="right", va="bottom")
        axes.set(title=family, xlabel="cell of the tube, 2 pi / n")
        axes.grid(True, which="major", alpha=0.3)
    panels[0].set_ylabel("largest error")
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside lower center", ncols=3, fontsize=8)
    figure.suptitle("Curvature of triangle meshes of the torus R = 2, r = 1")
    return figure


def main() -> None:
    """Print the tables and write the chart beside the other pictures."""
    sizes = (16, 32, 64)
    errors = table(sizes)
    for family, rows in errors.items():
        print(f"{family}: n = {', '.join(map(str, sizes))}; last rate")
        for name, label in QUANTITIES.items():
            values = [row[name] for row in rows]
            print(
                f"  {label:42s}" + "".join(f"{v:11.2e}" for v in values),
                f"{np.log2(values[-2] / values[-1]):6.2f}",
            )
    path = Path(__file__).parent.parent / "pictures" / "discrete_curvature.png"
    draw(errors, sizes).savefig(path, dpi=110)
    print(f"chart: {path.name}")


if __name__ == "__main__":
    main()
