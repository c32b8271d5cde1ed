"""Averages of moments as an estimate of the error: sharp for Morley, blind for Argyris."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

import kshell as ks
from kshell.analysis.models import model_of
from kshell.elements.quadrature import triangle_rule
from kshell.error.bounds import PlatePair
from kshell.shell.reference import lagrange, lattice
from kshell.verify.cases import find, meshes
from kshell.verify.cases.plate import plate
from verification.failures.failure import Failure, Numbers, columns, lines, panels, solved

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SIZES = (4, 8, 16, 32)


def measure(quick: bool) -> Numbers:
    """Relative errors of the energy of the clamped L-shape, and what they are taken for."""
    true = find("lshape.clamped").references["compliance"].value / 2
    rows = []
    for n in SIZES[:3] if quick else SIZES:
        mesh = meshes.l_shape(n, 0)
        argyris, morley = (solved(mesh, {"edge": "C"}, element) for element in ("argyris", "morley"))
        pair = _pair(mesh).energy()
        rows.append(
            {
                "cells": float(n),
                "Argyris: error": abs(argyris.strain_energy / true - 1),
                "Argyris: averages": averaged(mesh),
                "Argyris: residuals": _half(argyris),
                "Argyris: guaranteed": pair.half_width / pair.value,
                "Morley: error": abs(morley.strain_energy / true - 1),
                "Morley: averages": _half(morley),
            }
        )
    return columns(rows)


def _half(result: ks.Result) -> float:
    energy = result.error["energy"]
    return float((energy["upper"] - energy["lower"]) / (energy["upper"] + energy["lower"]))


def _scene(mesh: ks.Mesh) -> ks.Scene:
    return plate(mesh, {"edge": "C"}, [ks.Pressure(1.0)])


def _pair(mesh: ks.Mesh) -> PlatePair:
    return PlatePair(model_of(_scene(mesh), element="argyris").problem)  # type: ignore[attr-defined]


def averaged(mesh: ks.Mesh) -> float:
    """Half the energy of moments less their averages at vertices and in the middles of edges, over the energy."""
    problem = model_of(_scene(mesh), element="argyris").problem  # type: ignore[attr-defined]
    pair = PlatePair(problem)
    fields = problem.fields(pair.conforming.full(pair.conforming.unknowns))
    nodes = lattice(2)
    weights = np.concatenate([1 - nodes.sum(axis=1, keepdims=True), nodes], axis=1)
    every = np.arange(len(mesh.triangles))
    m = fields.moment(every, nodes, weights @ mesh.points[mesh.triangles, :2])
    number = np.concatenate([mesh.triangles, len(mesh.points) + mesh.triangle_edges], axis=1)
    weight = np.repeat(mesh.areas, 6)
    total = np.bincount(number.ravel(), weight)
    mean = np.stack([np.bincount(number.ravel(), weight * c) / total for c in m.reshape(-1, 3).T], axis=1)
    xi, w = triangle_rule(4)
    off = lagrange(2, xi) @ (m - mean[number])
    compliance = np.linalg.inv(problem.section.bending_per_triangle()[0])
    energy = 0.5 * float((2 * mesh.areas * ((off @ compliance * off).sum(axis=2) @ w)).sum())
    return energy / pair.energy().value


def draw(numbers: Numbers) -> Figure:
    """Argyris and Morley side by side."""
    figure, both = panels(2)
    for axes, element in zip(both, ("Argyris", "Morley"), strict=True):
        lines(axes, numbers, "cells", [name for name in numbers if name.startswith(element)])
        axes.set(xlabel="cells per side", ylabel="relative, energy", title=f"{element}, clamped L-shape")
    return figure


FAILURE = Failure(
    "averages",
    "Averages on smooth elements",
    "Where the moments of a solution jump, what they differ by from continuous averages is about their error "
    "(Zienkiewicz & Zhu). Argyris functions have continuous second derivatives at vertices, just where corners are "
    "singular: there is no jump to see, and the estimate is 20 times and more below the error.",
    "Morley and HHJ plates, and Koiter shells, are estimated by averages; Argyris plates by residuals of pressure, "
    "moments and edge forces, and with a tolerance by equilibrated moments, which bound the error with a proof.",
    measure,
    draw,
)
