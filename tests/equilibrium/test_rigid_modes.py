"""Rigid motions that supports leave: counted, named, M-orthonormal, and their share in the mass."""

import numpy as np
import pytest
import scipy.sparse as sp

from kshell.equilibrium.rigid_modes import RigidPart, participation, rigid_modes
from kshell.mesh.select import select
from kshell.mesh.triangulation import Group
from kshell.shell.koiter.discretisation import KoiterDiscretisation
from kshell.shell.koiter.matrices import mass
from kshell.shell.section import Section
from kshell.solvers.eigen import smallest
from kshell.solvers.pencil import Pencil
from tests.shell.shapes import rectangle

A, B = 1.0, 2.0


class Strip:
    """A rectangle 1 x 2 of unit mass per area, the edge x = 0 held in some letters."""

    def __init__(self, letters, turned=0.0):
        mesh = rectangle(4, 5, 0, A, 0, B)
        c, s = np.cos(turned), np.sin(turned)
        points = mesh.points @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]])
        held = np.flatnonzero(np.abs(mesh.points[mesh.edges][:, :, 0]).max(axis=1) < 1e-12).astype(np.int32)
        self.mesh = type(mesh)(points, mesh.triangles, groups={"side": Group(1, held)})
        d = KoiterDiscretisation(self.mesh, 2, None, np.zeros(0, dtype=int))
        conditions = d.conditions()
        if letters:
            chosen = select(self.mesh, "side", dimensions=(1,))
            conditions.translations(chosen, letters, lambda x: np.zeros((*x.shape[:-1], 3)))
        self.reduction, self.energy = conditions.reduction(), d.energy(Section.isotropic(1.0, 0.3, 0.05))
        full = mass(d.surface, 1.0)
        self.mass = self.reduction.reduce(full)
        centre = np.array([A / 2 * c - B / 2 * s, A / 2 * s + B / 2 * c, 0.0])
        self.motions = d.rigid_motions(centre, 1.0)
        self.moving = full @ self.motions
        self.modes = rigid_modes(
            [RigidPart(self.motions, np.eye(6), centre, np.hypot(A, B))], self.reduction.basis, self.mass
        )


@pytest.mark.parametrize(
    ("letters", "names"),
    [
        ("", [f"translation along {a}" for a in "xyz"] + [f"rotation about {a}" for a in "xyz"]),
        (
            "z",
            [
                "translation along x",
                "translation along y",
                "rotation about y through (0, 1)",
                "rotation about z",
            ],
        ),
        ("xz", ["translation along y", "rotation about y through (0, 1)"]),
        ("xyz", ["rotation about y through (0, 1)"]),
    ],
)
def test_names(letters, names):
    strip = Strip(letters)
    assert strip.modes.names == names
    vectors = strip.modes.vectors
    assert vectors.T @ (strip.mass @ vectors) == pytest.approx(np.eye(len(names)), abs=1e-12)
    stiffness = strip.reduction.reduce(strip.energy.linear_stiffness())
    assert np.abs(stiffness @ vectors).max() < 1e-13


def test_principal_axes_of_a_turned_plate_are_named_by_their_directions():
    names = Strip("", np.radians(30)).modes.names
    assert names[:3] == [f"translation along {a}" for a in "xyz"]
    assert {n.removeprefix("rotation about ") for n in names[3:]} == {
        "z",
        "(0.866, 0.5, 0)",
        "(-0.5, 0.866, 0)",
    }


def test_springs_hold():
    strip = Strip("xyz")
    free = strip.reduction.basis.shape[1]
    everywhere = 1e3 * sp.identity(free)
    part = RigidPart(strip.motions, np.eye(6), np.array([A / 2, B / 2, 0.0]), np.hypot(A, B))
    found = rigid_modes([part], strip.reduction.basis, strip.mass, everywhere)
    assert found.names == []
    assert found.vectors.shape == (free, 0)


def test_effective_masses_add_up_to_the_whole():
    """All of a free plate is in its rigid motions; elastic modes take part in none."""
    strip = Strip("")
    stiffness = strip.reduction.reduce(strip.energy.linear_stiffness())
    found = smallest(Pencil(stiffness, strip.mass, strip.modes.vectors), 4)
    vectors = np.concatenate([strip.modes.vectors, found.vectors], axis=1)
    share = participation(strip.motions, strip.moving, strip.reduction.basis, vectors)
    inertia = np.array([B**2, A**2, A**2 + B**2]) / 12
    assert share.total == pytest.approx(A * B * np.concatenate([np.ones(3), inertia]), rel=1e-12)
    assert share.effective_mass.sum(axis=0) == pytest.approx(share.total, rel=1e-10)
    assert np.abs(share.factors[6:]).max() < 1e-8


def test_effective_masses_of_a_cantilever_grow_towards_its_mass():
    strip = Strip("xyz")
    stiffness = strip.reduction.reduce(strip.energy.linear_stiffness())
    sums = []
    for count in (3, 12):
        found = smallest(Pencil(stiffness, strip.mass, strip.modes.vectors), count)
        share = participation(
            strip.motions, strip.moving, strip.reduction.basis,
            np.concatenate([strip.modes.vectors, found.vectors], axis=1),
        )  # fmt: skip
        sums.append(share.effective_mass.sum(axis=0)[2] / share.total[2])
    assert 0.7 < sums[0] < sums[1] < 1.0
