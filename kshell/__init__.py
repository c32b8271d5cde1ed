"""Finite elements for Kirchhoff plates and Koiter shells that say how accurate they are.

The public names are loaded when they are first used, so that `import kshell` is quick.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from kshell.errors import InputError, KshellError, KshellWarning, SolveError
from kshell.version import __version__

if TYPE_CHECKING:
    from kshell.analysis.converge import converge
    from kshell.analysis.solve import buckling, modes, simulate, solve, trace
    from kshell.analysis.sweep import sweep
    from kshell.export.inp import write_inp
    from kshell.material.given import Section
    from kshell.material.laminate import Layer
    from kshell.material.materials import Anisotropic, Isotropic, Orthotropic
    from kshell.mesh import Mesh
    from kshell.mesh.slit import slit
    from kshell.result.mac import mac
    from kshell.result.result import Result
    from kshell.scene.cases import Case, Combination
    from kshell.scene.contact import Contact, Obstacle
    from kshell.scene.imperfection import Imperfection
    from kshell.scene.line import Line
    from kshell.scene.loads import (
        Disc,
        EdgeMoment,
        Gravity,
        Hydrostatic,
        InitialCurvature,
        InitialStrain,
        LineForce,
        PointForce,
        PointMoment,
        Pressure,
        Rectangle,
        Snow,
        Temperature,
        Traction,
    )
    from kshell.scene.mapped import Mapped
    from kshell.scene.masses import Mass
    from kshell.scene.motion import Damping, InitialVelocity
    from kshell.scene.scene import Scene
    from kshell.scene.supports import (
        Clamped,
        Elastic,
        Fixed,
        Free,
        Hinge,
        RigidLink,
        SimplySupported,
        SoftSupported,
        Symmetry,
    )
    from kshell.values.tables import table

__all__ = [
    "Anisotropic",
    "Case",
    "Clamped",
    "Combination",
    "Contact",
    "Damping",
    "Disc",
    "EdgeMoment",
    "Elastic",
    "Fixed",
    "Free",
    "Gravity",
    "Hinge",
    "Hydrostatic",
    "Imperfection",
    "InitialCurvature",
    "InitialStrain",
    "InitialVelocity",
    "InputError",
    "Isotropic",
    "KshellError",
    "KshellWarning",
    "Layer",
    "Line",
    "LineForce",
    "Mapped",
    "Mass",
    "Mesh",
    "Obstacle",
    "Orthotropic",
    "PointForce",
    "PointMoment",
    "Pressure",
    "Rectangle",
    "Result",
    "RigidLink",
    "Scene",
    "Section",
    "SimplySupported",
    "Snow",
    "SoftSupported",
    "SolveError",
    "Symmetry",
    "Temperature",
    "Traction",
    "__version__",
    "buckling",
    "converge",
    "geometry",
    "mac",
    "modes",
    "simulate",
    "slit",
    "solve",
    "sweep",
    "table",
    "trace",
    "write_inp",
]

# name: where it lives
_LAZY = {
    **dict.fromkeys(("Isotropic", "Orthotropic", "Anisotropic"), "kshell.material.materials"),
    **dict.fromkeys(("Case", "Combination"), "kshell.scene.cases"),
    "Line": "kshell.scene.line",
    "Imperfection": "kshell.scene.imperfection",
    "Layer": "kshell.material.laminate",
    "Section": "kshell.material.given",
    **dict.fromkeys(
        (
            "Clamped",
            "SimplySupported",
            "SoftSupported",
            "Symmetry",
            "Free",
            "Hinge",
            "RigidLink",
            "Fixed",
            "Elastic",
        ),
        "kshell.scene.supports",
    ),
    **dict.fromkeys(
        (
            "Pressure",
            "Traction",
            "Snow",
            "Disc",
            "Hydrostatic",
            "Rectangle",
            "Gravity",
            "LineForce",
            "EdgeMoment",
            "PointForce",
            "PointMoment",
            "Temperature",
            "InitialCurvature",
            "InitialStrain",
        ),
        "kshell.scene.loads",
    ),
    "Mesh": "kshell.mesh",
    "slit": "kshell.mesh.slit",
    "Scene": "kshell.scene.scene",
    "Result": "kshell.result.result",
    "solve": "kshell.analysis.solve",
    "trace": "kshell.analysis.solve",
    "simulate": "kshell.analysis.solve",
    **dict.fromkeys(("Contact", "Obstacle"), "kshell.scene.contact"),
    **dict.fromkeys(("Damping", "InitialVelocity"), "kshell.scene.motion"),
    "modes": "kshell.analysis.solve",
    "buckling": "kshell.analysis.solve",
    "converge": "kshell.analysis.converge",
    "sweep": "kshell.analysis.sweep",
    "Mapped": "kshell.scene.mapped",
    "Mass": "kshell.scene.masses",
    "mac": "kshell.result.mac",
    "table": "kshell.values.tables",
    "write_inp": "kshell.export.inp",
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
