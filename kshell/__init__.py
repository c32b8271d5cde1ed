"""Finite elements for Kirchhoff plates and Koiter shells that say how accurate they are.

The public names are loaded when they are first used, so that `import kshell` is quick.
"""

from __future__ import annotations

import sys
from importlib import import_module
from types import ModuleType
from typing import TYPE_CHECKING, Any

from kshell.errors import InputError, KshellError, KshellWarning, SolveError

if TYPE_CHECKING:
    from kshell.imperfection import Imperfection
    from kshell.laminate import Layer
    from kshell.loads import (
        EdgeMoment,
        Gravity,
        InitialCurvature,
        InitialStrain,
        LineForce,
        PointForce,
        PointMoment,
        Pressure,
        Temperature,
        Traction,
    )
    from kshell.material import Anisotropic, Isotropic, Orthotropic
    from kshell.mesh import Mesh
    from kshell.result import Result
    from kshell.scene import Scene
    from kshell.solving import solve, trace
    from kshell.supports import Clamped, Elastic, Fixed, Free, Hinge, SimplySupported, Symmetry

__version__ = "0.1.0"

__all__ = [
    "Anisotropic",
    "Clamped",
    "EdgeMoment",
    "Elastic",
    "Fixed",
    "Free",
    "Gravity",
    "Hinge",
    "Imperfection",
    "InitialCurvature",
    "InitialStrain",
    "InputError",
    "Isotropic",
    "KshellError",
    "KshellWarning",
    "Layer",
    "LineForce",
    "Mesh",
    "Orthotropic",
    "PointForce",
    "PointMoment",
    "Pressure",
    "Result",
    "Scene",
    "SimplySupported",
    "SolveError",
    "Symmetry",
    "Temperature",
    "Traction",
    "__version__",
    "geometry",
    "solve",
    "trace",
]

# name: where it lives
_LAZY = {
    **dict.fromkeys(("Isotropic", "Orthotropic", "Anisotropic"), "kshell.material"),
    "Imperfection": "kshell.imperfection",
    "Layer": "kshell.laminate",
    **dict.fromkeys(
        ("Clamped", "SimplySupported", "Symmetry", "Free", "Hinge", "Fixed", "Elastic"), "kshell.supports"
    ),
    **dict.fromkeys(
        (
            "Pressure",
            "Traction",
            "Gravity",
            "LineForce",
            "EdgeMoment",
            "PointForce",
            "PointMoment",
            "Temperature",
            "InitialCurvature",
            "InitialStrain",
        ),
        "kshell.loads",
    ),
    "Mesh": "kshell.mesh",
    "Scene": "kshell.scene",
    "Result": "kshell.result",
    "solve": "kshell.solving",
    "trace": "kshell.solving",
}


def __getattr__(name: str) -> Any:
    if name == "geometry":
        return import_module("kshell.geometry")
    if name not in _LAZY:
        raise AttributeError(f"module 'kshell' has no attribute {name!r}")
    value = getattr(import_module(_LAZY[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted(__all__)


class _Package(ModuleType):
    """The package as a module whose function `solve` is not hidden by its sub-package of the same name."""

    def __setattr__(self, name: str, value: Any) -> None:
        if name == "solve" and isinstance(value, ModuleType):
            return  # importing kshell.solve (the solvers) would replace kshell.solve (the function)
        super().__setattr__(name, value)


sys.modules[__name__].__class__ = _Package
