"""Conditioning like h^-4, and the last digit that can be had."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING

import numpy as np

import kshell as ks
from kshell.elements import ElementArgyris
from kshell.plate.problem import PlateProblem
from kshell.scene.structure import resolve
from kshell.verify.cases import find
from kshell.verify.cases.case import Run
from verification.failures.failure import Failure, Numbers, columns, lines, panels
from verification.peers import scikit_fem

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SIZES = (4, 8, 16, 32, 64, 128)
BARE_UP_TO = 64
CASE = "clamped.uniform.ba1"
DISCRETISATION = 0.05  # of h^6


def factorised_once(scene: ks.Scene) -> float:
    """Deflection in the middle from kshell's matrix and one factorisation, nothing refined."""
    from scipy.sparse.linalg import splu

    mesh = scene.read_mesh()
    problem = PlateProblem(resolve(scene, mesh), ElementArgyris())
    system = problem.assembled
    factor = splu(
        system.matrix.tocsc(),
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )
    full = problem.reduction.expand(factor.solve(system.load))
    middle = np.linalg.norm(mesh.points[:, :2] - 0.5, axis=1).argmin()
    return float(full[problem.layout.vertex_dofs(np.array([middle]))[0, 0]])


def measure(quick: bool) -> Numbers:
    """Relative errors of the deflection in the middle of the clamped square."""
    case = find(CASE)
    exact = case.references["w_c"].value
    rows = []
    for n in SIZES[:4] if quick else SIZES:
        scene = case.build(n, 1)
        bare = np.nan
        if n <= BARE_UP_TO:
            mesh = scene.read_mesh()
            plate = scikit_fem.solve(mesh.points[:, :2], mesh.triangles, "argyris", "clamped")
            bare = abs(plate.deflection(0.5, 0.5) / exact - 1)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", ks.KshellWarning)
            result = case.solve(Run("argyris", n))
        rows.append(
            {
                "cells": float(n),
                "unknowns": float(result.unknowns),
                "scikit-fem alone": bare,
                "factorised once": abs(factorised_once(scene) / exact - 1),
                "kshell": abs(case.quantities["w_c"].of(result) / exact - 1),
                "balance": result.balance,
            }
        )
    return columns(rows)


def draw(numbers: Numbers) -> Figure:
    """Errors against cells, with the slopes of discretisation and rounding."""
    figure, (axes,) = panels(height=4.2)
    run = np.isfinite(numbers["scikit-fem alone"])
    bare = {name: values[run] for name, values in numbers.items()}
    axes.loglog(bare["cells"], bare["scikit-fem alone"], "x-", color="0.2", label="scikit-fem alone")
    lines(axes, numbers, "cells", ["factorised once", "kshell", "balance"], floor=1e-17)
    n = numbers["cells"]
    axes.loglog(n, DISCRETISATION * n**-6, "--", color="0.6", linewidth=1, label="h^6")
    axes.loglog(n, 2.2e-16 * n**4, ":", color="0.4", linewidth=1.2, label="rounding 2.2e-16 h^-4")
    axes.set_xticks(n, [f"{int(k)}" for k in n])
    axes.minorticks_off()
    axes.set(
        xlabel="cells per side", ylabel="relative error", title="Clamped square, Argyris", ylim=(1e-15, 1e-1)
    )
    axes.legend(fontsize=8)
    return figure


FAILURE = Failure(
    "conditioning",
    "Conditioning like h^-4, and the last digit that can be had",
    "The condition number of a plate grows with the fourth power of the cells per side. Rounding of the matrix "
    "entries alone then costs about 2.2e-16 h^-4: refining beyond some mesh makes the answer worse. Bare "
    "scikit-fem loses digits sooner, in its global monomials.",
    "Unknowns are scaled, bases depend on differences of coordinates only, fine Argyris plates are refined with "
    "residuals computed through strains, which do not suffer from the rounding of the assembled matrix. The "
    "equilibrium of loads and reactions that every result states shows when digits are gone.",
    measure,
    draw,
)
