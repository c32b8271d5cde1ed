"""Values read from files: a field known on another mesh, or at scattered points, as a function of the place.

On a surface of triangles the field is interpolated linearly at the closest point; of scattered points the nearest one
counts. A place that is farther than `within` from all that is known is an error, never an extrapolation.
"""

from __future__ import annotations

import csv
import os
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import Annotated, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import BeforeValidator, WithJsonSchema

from kshell.errors import InputError, clipped
from kshell.mesh import quadratic
from kshell.mesh.closest import Locator
from kshell.mesh.mesh import Mesh
from kshell.mesh.words import is_file, place
from kshell.values import kinds
from kshell.values.naming import listing, suggestion
from kshell.values.validation import Number, described

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]

TABLES = (".csv", ".txt", ".dat")
COORDINATES = ("x", "y", "z")
MANY = 20_000  # parts of triangles that a field is integrated on at the most, unless the mesh has more
SAME_AREA = 0.05  # areas of the two surfaces differ by less: they are the same surface, meshed differently
ONE_SIGN = 0.1  # |integral| over integral of the size, above which a factor on the field makes sense


def _path(value: Any) -> Any:
    if not isinstance(value, str | os.PathLike) or not str(value):
        raise ValueError("must be the path of a .csv or .vtu file")
    return Path(value)


@described("field of a file")
class Mapped:
    """A field that a file holds on a mesh of its own or at scattered points.

    Attributes
    ----------
    file : path
        .csv with a head "x, y, z, ..." or four columns x y z value; .vtu, or what else meshio reads, with point data.
    field : str
        The column or the name of the data.
    within : float, optional [length]
        How far a place may be from what the file knows. Absent: twice the largest distance of neighbouring points, or
        the mean length of the edges of its triangles.

    Raises
    ------
    InputError
        When it is first evaluated: if there is no such file or field, or a place is too far away.
    """

    file: Annotated[Any, BeforeValidator(_path), WithJsonSchema(kinds.PATH)]
    field: str = "value"
    within: Number | None = None

    def __post_init__(self) -> None:
        if self.within is not None and self.within <= 0.0:
            raise InputError(f"field of a file: within = {self.within:g}: must be a length > 0")

    def __call__(self, x: ArrayLike, y: ArrayLike, z: ArrayLike) -> Floats:
        """Values at places, arrays of one shape."""
        x, y, z = np.broadcast_arrays(x, y, z)
        points = np.stack([x.ravel(), y.ravel(), z.ravel()], axis=1).astype(float)
        known = self.known()
        values, distance = known.at(points)
        limit = known.reach if self.within is None else self.within
        worst = int(np.argmax(distance)) if len(distance) else 0
        if len(distance) and distance[worst] > limit:
            raise InputError(
                f"{self}: {place(points[worst])} is {distance[worst]:.3g} away from all that the file knows, more "
                f"than {limit:.3g}: give the field there, leave that part out by `on`, or allow it by within"
            )
        return values.reshape(x.shape)

    @property
    def __name__(self) -> str:
        return f"{self.field} of {self.file.name}"

    def __str__(self) -> str:
        return f'the field "{clipped(self.field)}" of {clipped(self.file)}'

    def known(self) -> Known:
        """What the file holds; read once."""
        try:
            stamp = self.file.stat().st_mtime_ns
        except OSError:
            stamp = 0
        return _read(self.file, self.field, stamp)


@dataclass(frozen=True)
class Scaled:
    """A field times a factor.

    Attributes
    ----------
    mapped : Mapped
    factor : float
    """

    mapped: Mapped
    factor: float

    def __call__(self, x: ArrayLike, y: ArrayLike, z: ArrayLike) -> Floats:
        return self.factor * self.mapped(x, y, z)

    @property
    def __name__(self) -> str:
        return f"{self.factor:.6g} times {self.mapped.__name__}"


class Known:
    """What a file knows.

    Parameters
    ----------
    points : (n, 3)
    values : (n,)
    triangles : (m, 3), perhaps none
    """

    def __init__(self, points: Floats, values: Floats, triangles: Ints) -> None:
        self.points, self.values, self.triangles = points, values, triangles
        if len(triangles):
            corners = points[triangles]
            self.reach = float(np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).mean())
            self._locator = Locator(corners)
        else:
            from scipy.spatial import cKDTree

            self._tree = cKDTree(points)
            apart = self._tree.query(points, k=2)[0][:, 1] if len(points) > 1 else np.zeros(1)
            self.reach = 2.0 * float(apart.max())

    def at(self, points: Floats) -> tuple[Floats, Floats]:
        """Values at points (n, 3), and how far these are away."""
        if not len(self.triangles):
            distance, nearest = self._tree.query(points)
            return self.values[nearest], distance
        found = self._locator.find(points)
        xi, eta = found.xi.T
        weights = np.stack([1.0 - xi - eta, xi, eta], axis=1)
        return np.sum(weights * self.values[self.triangles[found.triangles]], axis=1), found.distance

    def integrals(self) -> Integrals | None:
        """Over its triangles; None where it has none."""
        if not len(self.triangles):
            return None
        x = self.points[self.triangles]
        area = 0.5 * np.linalg.norm(np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0]), axis=1)
        value = self.values[self.triangles].mean(axis=1)
        return Integrals(float(area.sum()), float(area @ value), float(area @ np.abs(value)))


class Integrals(NamedTuple):
    """Of a field over a surface: the area, the integral, and that of the size of the field."""

    area: float
    value: float
    size: float


def integrals_on(mesh: Mesh, triangles: Ints, mapped: Mapped) -> Integrals:
    """Of a field over some triangles of a mesh, curved ones as they are.

    Fields of files have kinks inside of triangles: few triangles are divided for the rule.
    """
    places, weights = _rule(next((n for n in (4, 2) if len(triangles) * n**2 <= MANY), 1))
    if mesh.midpoints is None:
        corners = mesh.points[mesh.triangles[triangles]]
        points = np.einsum("pc,tcx->ptx", places, corners)
        normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        area = 0.5 * np.linalg.norm(normal, axis=1)[None] * weights[:, None]
    else:
        nodes = quadratic.node_points(mesh, mesh.midpoints)[triangles]
        shape = _shapes(places)
        points = np.einsum("pn,tnx->ptx", shape, nodes)
        normal = quadratic.normals(nodes, places)
        area = 0.5 * np.linalg.norm(normal, axis=2) * weights[:, None]
    value = mapped(*np.moveaxis(points, -1, 0))
    return Integrals(float(area.sum()), float((area * value).sum()), float((area * np.abs(value)).sum()))


def _rule(n: int) -> tuple[Floats, Floats]:
    """The rule of a triangle that is divided into n^2: barycentric coordinates (point, 3), and weights of sum 1."""
    x, y = quadratic.RULE_POINTS[:, 1], quadratic.RULE_POINTS[:, 2]
    parts = []
    for i in range(n):
        for j in range(n - i):
            parts.append(np.stack([i + x, j + y], axis=1))
            if i + j < n - 1:
                parts.append(np.stack([i + 1 - x, j + 1 - y], axis=1))
    found = np.concatenate(parts) / n
    return np.hstack([1.0 - found.sum(axis=1, keepdims=True), found]), np.tile(
        quadratic.RULE_WEIGHTS, n**2
    ) / n**2


def _shapes(barycentric: Floats) -> Floats:
    """(point, node) the functions of triangles of order 2."""
    a, b, c = barycentric.T
    return np.stack(
        [a * (2 * a - 1), b * (2 * b - 1), c * (2 * c - 1), 4 * a * b, 4 * b * c, 4 * a * c], axis=1
    )


def keep_resultant(item: Any, mesh: Mesh, triangles: Ints) -> tuple[Any, str]:
    """A load whose value is a field of a file, with the integral that the file has, and what was done, in words."""
    mapped: Mapped = item.value
    known, here = mapped.known().integrals(), integrals_on(mesh, triangles, mapped)
    if known is None:
        return item, (
            f"{item}: {mapped} is known at points; its integral over the {here.area:.6g} of area here is "
            f"{here.value:.6g}"
        )
    if abs(known.area - here.area) > SAME_AREA * here.area:
        return item, (
            f"{item}: the integral of {mapped} is {here.value:.6g} here, over an area of {here.area:.6g}, and "
            f"{known.value:.6g} in the file, over {known.area:.6g}: it is taken as it is"
        )
    if abs(here.value) <= ONE_SIGN * here.size or here.value * known.value <= 0.0:
        return item, (
            f"{item}: the integral of {mapped}, which changes its sign, is {here.value:.6g} here and "
            f"{known.value:.6g} in the file: it is taken as it is"
        )
    factor = known.value / here.value
    return replace(item, value=Scaled(mapped, factor)), (
        f"{item}: {mapped} is multiplied by {factor:.6g}, so that its integral is {known.value:.6g} as in the file"
    )


@lru_cache(maxsize=8)
def _read(path: Path, field: str, stamp: int) -> Known:
    if not is_file(path):
        raise InputError(f"field of a file: {clipped(path)}: no such file")
    points, values, triangles = _table(path, field) if path.suffix.lower() in TABLES else _mesh(path, field)
    if not len(points):
        raise InputError(f"field of a file: {clipped(path)}: there are no values")
    bad = np.flatnonzero(~(np.isfinite(values) & np.isfinite(points).all(axis=1)))
    if len(bad):
        raise InputError(
            f"field of a file: {clipped(path)}: value {bad[0] + 1} is not a finite number at a finite place"
        )
    return Known(points, values, triangles)


def _table(path: Path, field: str) -> tuple[Floats, Floats, Ints]:
    try:
        text = path.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"field of a file: {clipped(path)}: cannot be read ({error})") from None
    lines = [line for line in text.splitlines() if line.strip() and not line.lstrip().startswith("#")]
    commas = bool(lines) and "," in lines[0]
    rows = list(csv.reader(lines, skipinitialspace=True)) if commas else [line.split() for line in lines]
    head = [name.strip() for name in rows[0]] if rows else []
    columns = [0, 1, 2, 3]
    if head and not _is_number(head[0]):
        rows = rows[1:]
        wanted = (*COORDINATES, field)
        names = {name.lower() if name.lower() in COORDINATES else name: n for n, name in enumerate(head)}
        for name in wanted:
            if name not in names:
                raise InputError(
                    f'field of a file: {clipped(path)}: no column "{clipped(name)}": '
                    f"{suggestion(name, names)}the columns are {listing(names)}"
                )
        columns = [names[name] for name in wanted]
    try:
        table = np.array([[float(row[k]) for k in columns] for row in rows]).reshape(-1, 4)
    except (ValueError, IndexError):
        raise InputError(
            f"field of a file: {clipped(path)}: a line has no numbers x y z and a value"
        ) from None
    return table[:, :3], table[:, 3], np.zeros((0, 3), dtype=np.int64)


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def _mesh(path: Path, field: str) -> tuple[Floats, Floats, Ints]:
    import meshio

    try:
        found = meshio.read(path)
    except (Exception, SystemExit) as error:  # meshio raises anything, and exits
        raise InputError(f"field of a file: {clipped(path)}: meshio cannot read it ({error})") from None
    if field not in found.point_data:
        raise InputError(
            f'field of a file: {clipped(path)}: no point data "{clipped(field)}": '
            f"{suggestion(field, found.point_data)}there are {listing(found.point_data)}"
        )
    values = np.asarray(found.point_data[field], dtype=float)
    if values.ndim != 1:
        raise InputError(
            f"field of a file: {clipped(path)}: {clipped(field)} has {values.shape[1]} components: a number is needed"
        )
    points = np.zeros((len(found.points), 3))
    points[:, : found.points.shape[1]] = found.points
    parts = [np.zeros((0, 3), dtype=np.int64)]
    for cells in found.cells:
        if cells.type.startswith("triangle"):
            parts.append(cells.data[:, :3])
        elif cells.type.startswith("quad"):
            parts += [cells.data[:, [0, 1, 2]], cells.data[:, [0, 2, 3]]]
    triangles = np.concatenate(parts)
    if len(triangles):
        x = points[triangles]
        area = np.linalg.norm(np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0]), axis=1)
        triangles = triangles[area > 0.0]
    return points, values, triangles
