"""Plates and shells by Kratos: thin triangles (discrete Kirchhoff bending). Needs numpy and Kratos, two applications.

    python verification/peers/kratos_shell.py JOB.json        see job.py

Arrays of a mesh: points (n, 3), cells (m, 3), fixed (n, 6), force (n, 3), read (node, axis, sign). Of the job: element,
a name of Kratos; material (E, nu, thickness); steps, 0 for small deflections, else Newton's method in so many load
steps.
"""

from __future__ import annotations

from typing import Any

import KratosMultiphysics as Kratos
import KratosMultiphysics.LinearSolversApplication as LinearSolvers
import KratosMultiphysics.StructuralMechanicsApplication as Structural
import numpy as np
from job import run

FREEDOMS = (
    (Kratos.DISPLACEMENT_X, Kratos.REACTION_X),
    (Kratos.DISPLACEMENT_Y, Kratos.REACTION_Y),
    (Kratos.DISPLACEMENT_Z, Kratos.REACTION_Z),
    (Kratos.ROTATION_X, Kratos.REACTION_MOMENT_X),
    (Kratos.ROTATION_Y, Kratos.REACTION_MOMENT_Y),
    (Kratos.ROTATION_Z, Kratos.REACTION_MOMENT_Z),
)
VARIABLES = (
    Kratos.DISPLACEMENT,
    Kratos.ROTATION,
    Kratos.REACTION,
    Kratos.REACTION_MOMENT,
    Kratos.VOLUME_ACCELERATION,
    Structural.POINT_LOAD,
)
MOST_ITERATIONS = 60
TOLERANCES = (1e-7, 1e-9)


def solve(arrays: dict[str, Any], job: dict[str, Any]) -> Any:
    """Model, assemble, solve."""
    model = Kratos.Model()
    part = model.CreateModelPart("shell")
    part.ProcessInfo[Kratos.DOMAIN_SIZE] = 3
    for variable in VARIABLES:
        part.AddNodalSolutionStepVariable(variable)
    part.SetBufferSize(2)
    young, nu, thickness = job["material"]
    properties = part.CreateNewProperties(1)
    properties.SetValue(Kratos.YOUNG_MODULUS, young)
    properties.SetValue(Kratos.POISSON_RATIO, nu)
    properties.SetValue(Kratos.THICKNESS, thickness)
    properties.SetValue(Kratos.DENSITY, 0.0)
    law = Kratos.KratosGlobals.GetConstitutiveLaw("LinearElasticPlaneStress2DLaw")
    properties.SetValue(Kratos.CONSTITUTIVE_LAW, law.Clone())
    for number, (x, y, z) in enumerate(arrays["points"].tolist(), start=1):
        part.CreateNewNode(number, x, y, z)
    for freedom, reaction in FREEDOMS:
        Kratos.VariableUtils().AddDof(freedom, reaction, part)
    for number, nodes in enumerate((arrays["cells"] + 1).tolist(), start=1):
        part.CreateNewElement(job["element"], number, nodes, properties)
    for node, axis in np.argwhere(arrays["fixed"]).tolist():
        part.Nodes[node + 1].Fix(FREEDOMS[axis][0])
    forces = arrays["force"]
    loaded = np.flatnonzero(forces.any(axis=1)).tolist()
    for number, node in enumerate(loaded, start=1):
        part.CreateNewCondition("PointLoadCondition3D1N", number, [node + 1], properties)
    scheme = Kratos.ResidualBasedIncrementalUpdateStaticScheme()
    builder = Kratos.ResidualBasedBlockBuilderAndSolver(LinearSolvers.SparseLUSolver())
    if job["steps"]:
        criterion = Structural.ResidualDisplacementAndOtherDoFCriteria(*TOLERANCES)
        strategy = Kratos.ResidualBasedNewtonRaphsonStrategy(
            part, scheme, criterion, builder, MOST_ITERATIONS, False, False, True
        )
    else:
        strategy = Kratos.ResidualBasedLinearStrategy(part, scheme, builder, False, False, False, True)
    strategy.SetEchoLevel(0)
    steps = job["steps"] or 1
    for step in range(1, steps + 1):
        part.CloneTimeStep(float(step))
        for node in loaded:
            now = (forces[node] * step / steps).tolist()
            part.Nodes[node + 1].SetSolutionStepValue(Structural.POINT_LOAD, now)
        strategy.Initialize()
        strategy.InitializeSolutionStep()
        strategy.Predict()
        converged = strategy.SolveSolutionStep()
        strategy.FinalizeSolutionStep()
        if job["steps"] and not converged:
            raise SystemExit(f"no convergence in load step {step} of {steps}")

    def read() -> dict[str, Any]:
        nodes = range(1, len(forces) + 1)
        u = np.array([list(part.Nodes[k].GetSolutionStepValue(Kratos.DISPLACEMENT)) for k in nodes])
        node, axis, sign = arrays["read"].tolist()
        unknowns = int((~arrays["fixed"]).sum())
        return {
            "unknowns": unknowns,
            "w": sign * float(u[node, axis]),
            "compliance": float(np.sum(forces * u)),
        }

    read.model = model  # type: ignore[attr-defined]  # the part lives as long as its model
    return read


if __name__ == "__main__":
    Kratos.Logger.GetDefaultOutput().SetSeverity(Kratos.Logger.Severity.WARNING)
    run(solve, f"Kratos {Kratos.KratosGlobals.Kernel.Version().split('-')[0]}".replace('"', ""))
