"""What a plate in motion needs beside its reduced system: matrices, loads and values on all degrees of freedom."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from kshell.elements import matrices
from kshell.equilibrium.oscillator import Oscillator
from kshell.errors import InputError
from kshell.plate.assembly import AT_ONCE, Part, chunks, residual
from kshell.plate.domain import Domain
from kshell.plate.forms import Form
from kshell.plate.layout import Layout
from kshell.plate.linear_form import LinearForm
from kshell.plate.problem import PlateProblem
from kshell.plate.rigid import rigid_motions
from kshell.plate.sharing import along_edges
from kshell.plate.vibration import KINDS

Floats = NDArray[np.float64]


@dataclass
class PlateMotion:
    """What does not depend on loads, found once.

    Attributes
    ----------
    problem : PlateProblem
        Under any loads.
    """

    problem: PlateProblem

    @cached_property
    def mass(self) -> sp.csr_matrix:
        """(dof, dof)."""
        return whole_matrix(self.problem.inertia, self.problem.domain, self.problem.layout)

    @cached_property
    def springs(self) -> sp.csr_matrix | None:
        """(dof, dof) of elastic supports."""
        forms = [form for _, form in self.problem.supports.springs]
        return whole_matrix(forms, self.problem.domain, self.problem.layout) if forms else None

    @cached_property
    def stiffness(self) -> sp.csr_matrix:
        """(dof, dof) of the material, with what holds slopes along curved edges."""
        springs = {id(form) for _, form in self.problem.supports.springs}
        forms = [form for form in self.problem.forms if id(form) not in springs]
        return whole_matrix(forms, self.problem.domain, self.problem.layout)

    @cached_property
    def basis(self) -> sp.csc_matrix:
        """(dof, unknown) T."""
        return self.problem.reduction.matrix().tocsc()

    @cached_property
    def rigid(self) -> Floats:
        """(dof, 6) unit translations and turns about axes through the origin; none in the plane."""
        problem = self.problem
        return np.asarray(rigid_motions(problem.domain, problem.layout, np.zeros(3), problem.every) @ KINDS.T)

    def oscillator(self, problem: PlateProblem) -> Oscillator:
        """Of the same plate under some loads and prescribed motion.

        Raises
        ------
        InputError
            If it moves along a curved edge, which is held by its values in the mean.
        """
        if problem.supports.hold_loads:
            raise InputError(
                'a motion prescribed along a curved edge of the plate, in time: take element = "morley" or '
                'model = "shell"'
            )
        curved = list(problem.loads.curvatures)
        return Oscillator(
            self.mass,
            self.stiffness,
            self.springs,
            self.basis,
            problem.reduction.particular,
            whole_load(problem.loads.forms, problem),
            whole_load(curved, problem) if curved else None,
            problem.held_back() if curved else 0.0,
        )


def whole_matrix(forms: Sequence[Form], domain: Domain, layout: Layout) -> sp.csr_matrix:
    """(dof, dof) sum of forms on physical degrees of freedom, whether held or not."""
    shape = (layout.count, layout.count)
    total, waiting = sp.csr_matrix(shape), 0
    parts: list[tuple[Floats, NDArray[np.int64], NDArray[np.int64]]] = []

    def added() -> sp.csr_matrix:
        if not parts:
            return total
        data, row, column = (np.concatenate(part) for part in zip(*parts, strict=True))
        return total + sp.csr_matrix((data, (row, column)), shape=shape)

    for form in forms:
        for positions, triangles in chunks(form):
            blocks = form.matrices(positions, layout.element.transformation(domain.affine(triangles)))
            dofs = layout.triangle_dofs(triangles)
            n = dofs.shape[1]
            parts.append((blocks.ravel(), np.repeat(dofs, n, axis=1).ravel(), np.tile(dofs, (1, n)).ravel()))
            waiting += blocks.size
            if waiting > AT_ONCE:
                total, waiting = added(), 0
                parts.clear()
    return added()


def whole_load(loads: Sequence[LinearForm], problem: PlateProblem) -> Floats:
    """(dof,) sum of loads on physical degrees of freedom, whether held or not."""
    still = np.zeros(problem.layout.count)
    return -residual([], loads, problem.reduction, still, Part(problem.domain, problem.every))


def probe_row(problem: PlateProblem, name: str, component: str) -> Floats:
    """(dof,) whose product with the degrees of freedom is a displacement of a probe, zero in the plane."""
    row = np.zeros(problem.layout.count)
    if component != "z":
        return row
    found = problem.locator.find(np.array([problem.structure.probes[name][:2]], dtype=float))
    shared = along_edges(problem.domain, found)
    triangles = shared.located.triangles
    affine = problem.domain.affine(triangles)
    transform = problem.element.transformation(affine)
    values = matrices.rows(problem.element, affine, shared.located.xi, 0, transform)[:, 0, 0]
    np.add.at(row, problem.layout.triangle_dofs(triangles), shared.parts[:, None] * values)
    return row


def fingerprint(problem: PlateProblem) -> str:
    """Tells plates apart: mesh, supports, loads and stiffness."""
    digest = hashlib.sha256(f"plate {problem.element.maxdeg}".encode())
    matrix = problem.assembled
    arrays = [problem.mesh.points, problem.mesh.triangles, matrix.load, matrix.fixed_load]
    arrays += [problem.reduction.unknown, matrix.matrix.data]
    for array in arrays:
        digest.update(np.ascontiguousarray(array).tobytes())
    return digest.hexdigest()
