"""From the contact of a scene to surfaces and a barrier with numbers."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.equilibrium.contact.barrier import Barrier, Touch
from kshell.equilibrium.contact.surfaces import Body, Surfaces
from kshell.equilibrium.problem import Problem
from kshell.errors import InputError
from kshell.mesh import read_mesh
from kshell.mesh.mesh import Mesh
from kshell.mesh.words import place
from kshell.scene.contact import Contact, Obstacle

Floats = NDArray[np.float64]

# stiffness of the barrier against the pressure of all loads
STIFFER = 10.0
# pressure where an obstacle that moves touches, against the mean over the shell
NARROW = 30.0
# distance at which surfaces feel each other, against the smallest edge and the smallest gap at the start
OF_EDGE, OF_GAP = 0.1, 0.5
# size of a plane, and length of a cylinder, against that of the shell
PLANE, LONG = 100.0, 10.0
# triangles around a cylinder; times an icosahedron is halved to a sphere
ROUND, HALVINGS = 64, 3


def barrier_of(
    contact: Contact,
    obstacles: Sequence[Obstacle],
    shell: tuple[Floats, Any],
    thickness: float,
    loaded: Callable[[float], Problem],
    times: Sequence[float],
    impact: float,
    inertia: float,
) -> tuple[Barrier, str]:
    """The barrier of a motion or of a growing load, and in words what was taken.

    Parameters
    ----------
    shell : (node, 3) places at rest and (m, 3) triangles
    thickness : float
        Of the shell.
    loaded : function of the time
    times : sequence of float
        At which loads are looked at, for the stiffness of the barrier.
    impact : float
        Kinetic energy per area at the start.
    inertia : float
        Pressure per displacement: in a vibration of the first mode mass per area times its frequency squared, at rest
        the resistance to being pushed.

    Raises
    ------
    InputError
        If surfaces cross or are too near at the start, or there is nothing to touch.
    """
    points, faces = shell
    if not (contact.self or obstacles):
        raise InputError(
            "contact: there is nothing to touch: give obstacles (with = [..]), or leave self = false out"
        )
    kept = thickness if contact.thickness == "auto" else contact.thickness
    back = 0.5 * kept if contact.self else 0.0
    kept = kept if contact.self else 0.5 * kept
    centre, size = points.mean(axis=0), float(np.linalg.norm(np.ptp(points, axis=0)))
    bodies = []
    for number, obstacle in enumerate(obstacles):
        name = obstacle.name or f"obstacle {number}"
        where, triangles = _triangles(obstacle, centre, size, back)
        bodies.append(Body(name, where, triangles, obstacle.displacement))
    surfaces = Surfaces(points, faces, bodies, contact.self)
    start = surfaces.at(np.zeros(3 * len(points)), 0.0)
    crossing = surfaces.crossing(start)
    if crossing is not None:
        raise InputError(
            f"contact: the triangles at {place(crossing[0])} and {place(crossing[1])} intersect at the start: move "
            "them apart"
        )
    sides = points[faces]
    edge = float(np.linalg.norm(sides - np.roll(sides, 1, axis=1), axis=2).min())
    gap = surfaces.gap(start, kept + 2.0 * edge)
    if gap <= kept:
        pair = surfaces.nearest(start, kept + 2.0 * edge) or (centre, centre)
        raise InputError(
            f"contact: surfaces at {place(pair[0])} and {place(pair[1])} are {gap:.3g} apart at the start, not more "
            f"than the thickness of contact, {kept:.3g}: move them apart, or give contact a smaller thickness"
        )
    near = min(OF_EDGE * edge, OF_GAP * (gap - kept)) if contact.distance == "auto" else contact.distance
    area = 0.5 * float(
        np.linalg.norm(np.cross(sides[:, 1] - sides[:, 0], sides[:, 2] - sides[:, 0]), axis=1).sum()
    )
    pressure = max(_pressure(loaded(time), len(points), area) for time in times)
    driven = max(np.abs(loaded(time).reduction.given[: points.size]).max(initial=0.0) for time in times)
    travel = max(
        (float(np.linalg.norm(one.displacement(t))) for one in obstacles for t in times), default=0.0
    )
    stiffness = STIFFER * (pressure + NARROW * inertia * max(travel, driven)) + impact / near
    if not stiffness > 0.0:
        raise InputError("contact: there is no load and no velocity, nothing moves: give one")
    touch = Touch(kept, near, stiffness, contact.friction, contact.speed, contact.self)
    words = (
        f"contact: distance kept {kept:.4g}, felt {near:.4g} beyond it, barrier of stiffness {stiffness:.4g}, friction "
        f"{contact.friction:g}"
    )
    if contact.friction:
        words += f"; friction sticks up to a speed of {contact.speed:g}, by which it creeps at most"
    files = [
        body.name for body, one in zip(bodies, obstacles, strict=True) if not isinstance(one.shape, dict)
    ]
    if contact.self and files:
        words += f"; to {', '.join(files)} the whole thickness is kept, not half of it"
    return Barrier(surfaces, touch, loaded(0.0).energy.unknowns), words


def _pressure(problem: Problem, nodes: int, area: float) -> float:
    load = problem.load
    if problem.follower is not None:
        load = load + problem.follower(np.zeros_like(load))[0]
    forces = load[: 3 * nodes].reshape(-1, 3)
    return float(np.linalg.norm(forces, axis=1).sum()) / area


def _triangles(obstacle: Obstacle, centre: Floats, size: float, back: float) -> tuple[Floats, Any]:
    """Points and faces, those with a formula moved back from their surface."""
    shape = obstacle.shape
    if not isinstance(shape, dict):
        mesh: Mesh = shape if isinstance(shape, Mesh) else read_mesh(shape)
        return mesh.points, mesh.triangles
    if shape["kind"] == "plane":
        normal = np.array(shape["normal"]) / np.linalg.norm(shape["normal"])
        foot = np.array(shape["point"]) - back * normal
        foot = centre - ((centre - foot) @ normal) * normal  # below the middle of the shell
        across = _across(normal)
        angles = 2.0 * np.pi * np.arange(3) / 3.0
        ring = np.cos(angles)[:, None] * across[0] + np.sin(angles)[:, None] * across[1]
        return foot + PLANE * size * ring, np.array([[0, 1, 2]])
    radius = shape["radius"] - back
    if not radius > 0.0:
        raise InputError(
            f"obstacle: radius = {shape['radius']:g} must be larger than half the thickness of contact"
        )
    if shape["kind"] == "sphere":
        points, faces = _sphere()
        return np.array(shape["centre"]) + radius * points, faces
    axis = np.array(shape["axis"]) / np.linalg.norm(shape["axis"])
    foot = np.array(shape["point"])
    middle = foot + ((centre - foot) @ axis) * axis
    across = _across(axis)
    angles = 2.0 * np.pi * np.arange(ROUND) / ROUND
    ring = radius * (np.cos(angles)[:, None] * across[0] + np.sin(angles)[:, None] * across[1])
    points = np.concatenate([middle + ring - LONG * size * axis, middle + ring + LONG * size * axis])
    k, after = np.arange(ROUND), (np.arange(ROUND) + 1) % ROUND
    low = np.stack([k, after, after + ROUND], axis=1)
    high = np.stack([k, after + ROUND, k + ROUND], axis=1)
    return points, np.concatenate([low, high])


def _across(normal: Floats) -> Floats:
    """(2, 3) unit vectors across a unit vector, at right angles."""
    first = np.cross(normal, np.eye(3)[np.argmin(np.abs(normal))])
    first /= np.linalg.norm(first)
    return np.stack([first, np.cross(normal, first)])


def _sphere() -> tuple[Floats, Any]:
    """An icosahedron halved and put on the unit sphere: points (n, 3) and faces."""
    from kshell.mesh.halve import halved

    golden = 0.5 * (1.0 + np.sqrt(5.0))
    corners = [(sign, other * golden, 0.0) for sign in (1.0, -1.0) for other in (1.0, -1.0)]
    points = np.array([np.roll(corner, shift) for shift in range(3) for corner in corners])
    distance = np.linalg.norm(points[:, None] - points[None], axis=2)
    near = np.isclose(distance, 2.0)
    faces = [
        (i, j, k)
        for i in range(12)
        for j in range(i)
        for k in range(j)
        if near[i, j] and near[j, k] and near[i, k]
    ]
    mesh = Mesh(points, np.array(faces, dtype=np.int32))
    for _ in range(HALVINGS):
        mesh = halved(mesh)
    return mesh.points / np.linalg.norm(mesh.points, axis=1, keepdims=True), mesh.triangles
