"""Meshes of order 2 that are refined without their geometry: the error of the first mesh's shape stays."""

from __future__ import annotations

import dataclasses
import warnings
from typing import TYPE_CHECKING

import numpy as np

import kshell as ks
from kshell.verify.cases import find
from kshell.verify.cases.case import TRUE_SURFACE
from verification.failures.failure import Failure, Numbers, lines, panels

if TYPE_CHECKING:
    from matplotlib.figure import Figure

LEVELS = 4
CASE = "shell.scordelis_lo"


def measure(quick: bool) -> Numbers:
    """Deflection of the free edge of the Scordelis-Lo roof by Koiter elements of order 3, from 2 x 2 cells on."""
    case = find(CASE)
    quantity, reference = case.quantities["w_free_edge"], case.references["w_free_edge"].value
    out: dict[str, list[float]] = {}
    for name, order in (("without geometry", 2), ("on the chart", TRUE_SURFACE)):
        scene = dataclasses.replace(case.build(2, order), probes={"edge": quantity.point})  # type: ignore[attr-defined]
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", ks.KshellWarning)
            found = ks.converge(scene, LEVELS - quick, element="koiter", order=3)
        values = next(v for key, v in found.series[0].values.items() if key.startswith("edge"))
        out[name] = [abs(abs(value) / abs(reference) - 1) for value in values]
    return {
        "cells": 2.0 ** np.arange(1, len(out["on the chart"]) + 1),
        **{name: np.array(errors) for name, errors in out.items()},
    }


def draw(numbers: Numbers) -> Figure:
    """Errors over cells."""
    figure, (axes,) = panels(height=4.0)
    lines(axes, numbers, "cells", ["without geometry", "on the chart"])
    axes.set(
        xlabel="cells per side", ylabel="relative error", title="Scordelis-Lo roof, halved from 2 x 2 cells"
    )
    return figure


FAILURE = Failure(
    "frozen_shape",
    "Curved meshes refined without their geometry",
    "Triangles with nodes in the middles of their edges follow a curved surface by quadratics. Cut without the "
    "surface at hand, the new nodes lie on the old quadratics: discretisation errors fall, estimates with them, and "
    "the shape of the first mesh stays, unseen by any estimate that lives on the mesh.",
    "New nodes are put on the chart, or on the curves and surfaces of a geometry file. Without either the share of "
    "the shape stands in the budget, in the interval, and ends a refinement with the reason when it exceeds the "
    "tolerance.",
    measure,
    draw,
)
