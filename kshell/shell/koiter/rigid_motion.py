"""Prescribed motions that are rigid: followed along a screw, not along the chord, which squeezes what turns.

A group of nodes held in all directions whose prescribed displacements are those of a rigid body moves, at the part f of
its motion, by the exponential of f times its twist (Murray, Li and Sastry, A Mathematical Introduction to Robotic
Manipulation, 1994, section 2.3),

    x(f) = c + R (X - c) + f V p,    R = exp(f w),    V = sum_k (f w)^k / (k + 1)!,

so that c moves by the prescribed amount at f = 1. Edges whose rotation is held there turn with the body. What the
displacements differ from those of the body grows in proportion.

Symbols
-------
X, c       nodes at rest, their centre
w          rotation vector of the whole motion, also as its matrix
p          translation of the twist
t, d       tangent and director of an edge at rest
alpha      rotation unknown of an edge in one step: about the new tangent, from the old director across it
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from kshell.mesh.connected import connected_parts
from kshell.shell.koiter.edges import rest_directors
from kshell.shell.koiter.reactions import rotation_axes
from kshell.shell.koiter.surface import Surface

if TYPE_CHECKING:
    from scipy.spatial.transform import Rotation

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]

# largest difference from a rigid motion, against the motion less its mean
RIGID = 1e-3
# turns by less grow along the chord; the same in radians of half a turn whose axis a line of nodes does not tell
LEAST_TURN = 1e-7
# extent across a line of nodes, against that along it, that is none
LINE = 1e-9
# radians that a step may turn: its directors are measured against those of the last one
LARGEST_STEP = 0.5


class Screw(NamedTuple):
    """A rigid motion: centre, rotation vector w and translation p of its twist, each (3,)."""

    centre: Floats
    turn: Floats
    slide: Floats

    def at(self, points: Floats, part: float) -> Floats:
        """(n, 3) displacement of points at rest (n, 3) at a part of the motion."""
        from scipy.spatial.transform import Rotation

        rotation = Rotation.from_rotvec(part * self.turn).as_matrix()
        return (points - self.centre) @ (rotation - np.eye(3)).T + part * (
            _series(part * self.turn) @ self.slide
        )

    def rate(self, points: Floats, part: float) -> Floats:
        """(n, 3) derivative of the displacement by the part."""
        arm = points + self.at(points, part) - self.centre
        return np.cross(self.turn, arm) + self.slide


def _series(turn: Floats) -> Floats:
    """V of a rotation vector."""
    angle = float(np.linalg.norm(turn))
    cross = np.cross(turn, np.eye(3)).T
    if angle < 1e-4:
        return np.eye(3) + cross / 2 + cross @ cross / 6
    return (
        np.eye(3)
        + cross * ((1 - np.cos(angle)) / angle**2)
        + cross @ cross * ((angle - np.sin(angle)) / angle**3)
    )


def screw_of(points: Floats, moved: Floats, towards: Floats) -> Screw | None:
    """The rigid motion closest to displacements; None where they are none that turns.

    Nodes on a line do not tell the turn about it: it is taken to be none.

    Parameters
    ----------
    points, moved : (n, 3)
        At rest, and their displacements.
    towards : (3,)
        Axis of half turns of a line of nodes, as far as it is across the line.
    """
    from scipy.spatial.transform import Rotation

    centre, mean = points.mean(axis=0), moved.mean(axis=0)
    rest, relative = points - centre, moved - mean
    now = rest + relative
    _, size, rows = np.linalg.svd(rest, full_matrices=False)
    if len(size) < 2 or size[0] == 0.0:
        return None
    if size[1] <= LINE * size[0]:
        rotation = _between(rows[0], now.T @ (rest @ rows[0]), towards)
    else:
        u, _, v = np.linalg.svd(now.T @ rest)
        rotation = Rotation.from_matrix(u @ np.diag([1.0, 1.0, np.linalg.det(u @ v)]) @ v)
    turn = rotation.as_rotvec()
    if np.linalg.norm(turn) < LEAST_TURN:
        return None
    miss = now - rotation.apply(rest)
    if np.abs(miss).max() > RIGID * np.abs(relative).max():
        return None
    return Screw(centre, turn, np.linalg.solve(_series(turn), mean))


def _between(a: Floats, b: Floats, towards: Floats) -> Rotation:
    """The smallest rotation that turns one direction into another."""
    from scipy.spatial.transform import Rotation

    length = np.linalg.norm(b)
    if length == 0.0:
        return Rotation.identity()
    b = b / length
    axis, cosine = np.cross(a, b), float(a @ b)
    sine = float(np.linalg.norm(axis))
    if sine > LEAST_TURN:
        return Rotation.from_rotvec(axis / sine * np.arctan2(sine, cosine))
    if cosine > 0:
        return Rotation.identity()
    axis = towards - a * (a @ towards)
    if np.linalg.norm(axis) <= LEAST_TURN * np.linalg.norm(towards):
        axis = np.cross(a, np.eye(3)[np.argmin(np.abs(a))])
    return Rotation.from_rotvec(np.pi * axis / np.linalg.norm(axis))


@dataclass(frozen=True, eq=False)
class Body:
    """Nodes and edges that move with a screw.

    Attributes
    ----------
    screw : Screw
    unknowns : (3 n,) int array
        Translations, node by node.
    points : (n, 3)
    rotations : (m,) int array
        Unknowns of the rotations that are held.
    tangents, directors : (m, 3)
        Of their edges at rest.
    spin : (m,)
        Rotation that is prescribed besides.
    """

    screw: Screw
    unknowns: Ints
    points: Floats
    rotations: Ints
    tangents: Floats
    directors: Floats
    spin: Floats

    def alpha(self, before: float, after: float) -> Floats:
        """(m,) rotations of a step, without the spin."""
        from scipy.spatial.transform import Rotation

        angle = (self.spin * before)[:, None]
        d = self.directors * np.cos(angle) + np.cross(self.tangents, self.directors) * np.sin(angle)
        turned = Rotation.from_rotvec((after - before) * self.screw.turn)
        t, wanted = turned.apply(self.tangents), turned.apply(d)
        across = d - t * (d * t).sum(axis=1, keepdims=True)
        return np.asarray(
            np.arctan2((t * np.cross(across, wanted)).sum(axis=1), (across * wanted).sum(axis=1))
        )


@dataclass(frozen=True, eq=False)
class RigidMotions:
    """How bodies move besides in proportion: a `Following` of `kshell.equilibrium.reduction`.

    Attributes
    ----------
    count : int
        Unknowns in all.
    bodies : tuple of Body
    motion : float
        Times the prescribed motion.
    """

    count: int
    bodies: tuple[Body, ...]
    motion: float = 1.0

    @property
    def longest(self) -> float:
        """Growth of the factor that one step may make."""
        turn = max(float(np.linalg.norm(body.screw.turn)) for body in self.bodies)
        return LARGEST_STEP / (abs(self.motion) * turn) if self.motion else np.inf

    @property
    def rotations(self) -> Ints:
        """Unknowns of the rotations of all bodies."""
        return np.concatenate([body.rotations for body in self.bodies])

    def aside(self, before: float, after: float) -> Floats:
        """(unknowns,) motion from a factor to another, less the proportional one."""
        before, after = self.motion * before, self.motion * after
        out = np.zeros(self.count)
        for body in self.bodies:
            screw, x = body.screw, body.points
            moved = screw.at(x, after) - screw.at(x, before) - (after - before) * screw.at(x, 1.0)
            out[body.unknowns] = moved.ravel()
            out[body.rotations] = body.alpha(before, after) - (after - before) * (body.tangents @ screw.turn)
        return out

    def rate(self, factor: float) -> Floats:
        """(unknowns,) derivative of the motion by the factor, less the proportional one."""
        out = np.zeros(self.count)
        for body in self.bodies:
            screw, x = body.screw, body.points
            out[body.unknowns] = (screw.rate(x, self.motion * factor) - screw.at(x, 1.0)).ravel()
        return self.motion * out

    def times(self, motion: float) -> RigidMotions:
        """That of the prescribed motion times a number."""
        return replace(self, motion=self.motion * motion)


def follow_rigid(
    surface: Surface, groups: Sequence[Ints], held: Ints, rotations: Ints, given: Floats
) -> tuple[Floats, RigidMotions | None]:
    """The prescribed motion (unknowns,) with the rotations of the bodies that turn, and how these are followed.

    All groups together are one body if they move as one, else groups that share nodes are.

    Parameters
    ----------
    groups : sequence of (n,) int arrays
        Nodes held in all directions, support by support.
    held : (n,) int array
        All nodes that are held in all directions.
    rotations : (m,) int array
        Unknowns of the rotations that are held.
    given : (unknowns,)
        Prescribed motion, rotations besides those of the bodies.
    """
    moved = given[: surface.rotation_start].reshape(-1, 3)
    if not groups or not np.any(moved):
        return given, None
    middle, x = surface.nodes.mean(axis=0), surface.nodes
    whole = screw_of(x[held], moved[held], middle - x[held].mean(axis=0))
    screws: list[tuple[Ints, Screw | None]] = [(held, whole)]
    if whole is None:
        parts = _joined(groups, surface.node_count)
        screws = [(n, screw_of(x[n], moved[n], middle - x[n].mean(axis=0))) for n in parts]
    bodies = [_body(surface, screw, nodes, rotations, given) for nodes, screw in screws if screw is not None]
    if not bodies:
        return given, None
    given = given.copy()
    for body in bodies:
        given[body.rotations] += body.tangents @ body.screw.turn
    return given, RigidMotions(surface.unknowns, tuple(bodies))


def _joined(groups: Sequence[Ints], count: int) -> list[Ints]:
    """Groups that share nodes, as one."""
    owner = np.repeat(np.arange(len(groups)), [len(group) for group in groups])
    label = connected_parts(len(groups) + count, owner, len(groups) + np.concatenate(groups))[1][
        : len(groups)
    ]
    return [
        np.unique(np.concatenate([groups[int(i)] for i in np.flatnonzero(label == k)]))
        for k in range(int(label.max()) + 1)
    ]


def _body(surface: Surface, screw: Screw, nodes: Ints, rotations: Ints, given: Floats) -> Body:
    number = np.asarray(rotations, dtype=np.int64) - surface.rotation_start
    inside: Ints = np.flatnonzero(np.all(np.isin(surface.mesh.edges, nodes), axis=1))
    mine = number[np.isin(surface.rotation_owner[number // surface.order], inside)]
    return Body(
        screw,
        (3 * np.asarray(nodes, dtype=np.int64)[:, None] + np.arange(3)).ravel(),
        surface.nodes[nodes],
        mine + surface.rotation_start,
        rotation_axes(surface)[mine],
        rest_directors(surface).vectors[:, mine].T,
        given[mine + surface.rotation_start],
    )
