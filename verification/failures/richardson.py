"""Richardson's extrapolation where solutions are singular: the rate read off three meshes is not the last word."""

from __future__ import annotations

import dataclasses
import warnings
from typing import TYPE_CHECKING

import numpy as np

import kshell as ks
from kshell.analysis.converge import Series
from kshell.verify.cases import find, meshes
from kshell.verify.cases.plate import plate
from verification.failures.failure import Failure, Numbers, lines, panels

if TYPE_CHECKING:
    from matplotlib.figure import Figure

LEVELS = 5


def measure(quick: bool) -> Numbers:
    """Centre of the supported rhombus of 30 degrees on halved meshes: errors, rates and what they tend to."""
    reference = find("skew.ss.30").references["w_c"].value
    t = np.radians(30)
    scene = plate(meshes.rhombus(30, 2, 0), {"edge": "S"}, [ks.Pressure(1.0)])
    scene = dataclasses.replace(scene, probes={"centre": ((1 + np.cos(t)) / 2, np.sin(t) / 2, 0.0)})
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ks.KshellWarning)
        found = ks.converge(scene, LEVELS - quick, element="argyris")
        bounded = ks.solve(scene, tolerance=1e-4)
    series = found.series[0]
    values = series.values["centre u_z"]
    limits = [_limit(series, k) for k in range(2, len(values))]
    inside = bounded.error["probes"]["centre"]["u"]["half_width"][2]
    return {
        "cells": 2.0 ** np.arange(3, len(values) + 1),
        "unknowns": np.array(series.unknowns[2:], dtype=float),
        "finest mesh": np.array([abs(v / reference - 1) for v in values[2:]]),
        "Richardson": np.array([np.nan if v is None else abs(v / reference - 1) for v in limits]),
        "graded, guaranteed": np.full(len(limits), inside / reference),
    }


def _limit(series: Series, last: int) -> float | None:
    """What the values up to one tend to."""
    name = "centre u_z"
    return dataclasses.replace(series, values={name: series.values[name][: last + 1]}).limit(name)


def draw(numbers: Numbers) -> Figure:
    """Errors over cells."""
    figure, (axes,) = panels(height=4.0)
    lines(axes, numbers, "cells", ["finest mesh", "Richardson", "graded, guaranteed"])
    axes.set(
        xlabel="cells per side of the finest mesh",
        ylabel="relative error",
        title="Supported rhombus of 30 degrees",
    )
    return figure


FAILURE = Failure(
    "richardson",
    "Extrapolation of singular solutions",
    "Values on three halved meshes give a rate and a limit if the error is like one power of h. At corners it is a "
    "sum of powers, here of h^0.4 and more, and the first meshes see others than the last: the extrapolated "
    "deflection stays off by 1 to 2 % however the mesh is halved, and nothing says so.",
    "`kshell converge` prints rates and limits for those who want them. Tolerances do not rest on them: meshes are "
    "graded to corners whose exponents are known, and the interval of the deflection is guaranteed.",
    measure,
    draw,
)
