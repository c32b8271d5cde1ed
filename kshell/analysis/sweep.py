"""One scene under many values of its parameters, as many at a time as there are cores."""

from __future__ import annotations

import copy
import csv
import os
import time
import warnings
from collections.abc import Callable, Generator, Iterable, Iterator, Mapping, Sequence
from contextlib import closing
from importlib import import_module
from itertools import product
from pathlib import Path
from typing import Any

from kshell.analysis.forked import Forked, can_fork
from kshell.analysis.solve import answer
from kshell.errors import InputError, KshellWarning, SolveError
from kshell.geometry.charts import Cylinder, Plane
from kshell.material.materials import Isotropic
from kshell.result.result import Result
from kshell.scene.loads import Pressure
from kshell.scene.scene import Scene
from kshell.scene.supports import Clamped
from kshell.scene.toml import set_value
from kshell.scene.writing import scene_data

Row = dict[str, Any]
COMPONENTS = {"u": ("ux", "uy", "uz"), "M": ("Mxx", "Myy", "Mxy"), "N": ("Nxx", "Nyy", "Nxy")}


class Sweep(list[Row]):
    """One row for every point of a sweep, and of scenes with load cases for every case of it.

    A row holds the parameters, `case`, the components of u, M and N at each probe ("centre.uz"), `deflection` and
    `von_mises` (the largest), `strain_energy`, `frequency_1` or `factor_1` and so on of modes and buckling, `seconds`,
    `warnings` (text), and `error`: empty, or why there is no answer.

    Attributes
    ----------
    parameters : list of str
    """

    def __init__(self, rows: Iterable[Row], parameters: Iterable[str]) -> None:
        super().__init__(rows)
        self.parameters = list(parameters)

    @property
    def columns(self) -> list[str]:
        """Names of all columns, in the order in which they first appear; `error` last."""
        names = dict.fromkeys(name for row in self for name in row)
        last = [name for name in ("seconds", "warnings", "error") if name in names]
        return [name for name in names if name not in last] + last

    def save(self, path: str | os.PathLike[str]) -> str:
        """Write a CSV file; returns its path.

        Raises
        ------
        InputError
            If it cannot be written.
        """
        from kshell.result.saving import write_together

        target = Path(path)

        def write(file: Path) -> None:
            with file.open("w", newline="", encoding="utf-8") as stream:
                out = csv.DictWriter(stream, self.columns, restval="")
                out.writeheader()
                out.writerows(self)

        return write_together(target.parent, {target.name: write})[0]


def sweep(
    scene: Scene,
    parameters: Mapping[str, Sequence[Any]],
    *,
    workers: int | None = None,
    progress: Callable[[str], None] | None = None,
    allow_system: bool = False,
    **options: Any,
) -> Sweep:
    """Solve a scene for all combinations of values of its parameters.

    Parameters
    ----------
    scene : Scene
    parameters : dict of str to sequence
        Keys as in a scene file, dotted, lists by number: "thickness", "material.E", "load.0.value", "solve.order".
    workers : int, optional
        Processes; one per core if absent. 1 solves one after the other in this process.
    progress : function, optional
        Called with words at the beginning, and after each point.
    allow_system, **options :
        As for `solve`.

    Returns
    -------
    Sweep
        Rows in the order of the combinations, the last parameter changing fastest. A point without an answer is a row
        with its reason under "error".

    Raises
    ------
    InputError
        If a parameter has no values, or every point is refused for the same reason.
    """
    if not isinstance(scene, Scene):
        raise InputError(f"{scene!r} is not a scene: make one with ks.Scene(...) or ks.Scene.load(path)")
    points = list(_points(parameters))
    data = scene_data(scene)
    rows: list[list[Row]] = []
    refusals: list[str] = []
    tell = progress or (lambda words: None)

    def begun() -> None:
        tell(f"sweep: {len(points)} points")

    with closing(_solved(data, points, options, allow_system, workers, begun)) as solved:
        for number, (point, (found, refused)) in enumerate(zip(points, solved, strict=True), 1):
            rows.append([{**point, **row} for row in found])
            refusals.append(refused)
            failed = found[0]["error"]
            tell(f"sweep: point {number} of {len(points)}{': ' + failed if failed else ''}")
    if refusals[0] and len(set(refusals)) == 1:
        raise InputError(refusals[0])
    return Sweep((row for point in rows for row in point), parameters)


def _points(parameters: Mapping[str, Sequence[Any]]) -> Iterator[Row]:
    if not isinstance(parameters, Mapping) or not parameters:
        raise InputError('a sweep needs parameters, such as {"thickness": [0.008, 0.01]}')
    for key, values in parameters.items():
        if isinstance(values, str) or not hasattr(values, "__len__") or not len(values):
            raise InputError(f"sweep: {key} = {values!r}: must be a list of values, at least one")
    for values in product(*parameters.values()):
        yield dict(zip(parameters, map(_number, values), strict=True))


def _number(value: Any) -> Any:
    """numpy's numbers and arrays as Python's."""
    return value.tolist() if hasattr(value, "tolist") else value


def _solved(
    data: Row,
    points: Sequence[Row],
    options: Row,
    allow_system: bool,
    workers: int | None,
    begun: Callable[[], None],
) -> Generator[tuple[list[Row], str]]:
    if workers is not None and (isinstance(workers, bool) or not isinstance(workers, int) or workers < 1):
        raise InputError(f"sweep: workers = {workers!r} must be a whole number > 0")
    from joblib import Parallel, cpu_count, delayed, parallel_config

    count = min(workers or cpu_count(only_physical_cores=True), len(points))
    folder = Path.cwd()  # processes of loky serve again, and stand where an earlier sweep was begun

    def solved(number: int) -> tuple[list[Row], str]:
        return _point(data, points[number], options, allow_system, folder)

    if count == 1:
        begun()
        yield from map(solved, range(len(points)))
        return
    if can_fork():
        _warm_up()
        if can_fork():
            with Forked(solved, count) as processes:
                begun()
                yield from processes.answers(len(points), lambda why: ([{"error": why}], ""))
            return
    begun()
    with parallel_config("loky", n_jobs=count, inner_max_num_threads=1):
        jobs = (delayed(_point)(data, point, options, allow_system, folder) for point in points)
        yield from Parallel(return_as="generator")(jobs)


def _warm_up() -> None:
    """Import and make, before processes are forked, what each would import and make again."""
    steel, names = Isotropic(E=1.0, nu=0.3), ("a", "b", "c", "d")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        for surface in (Plane(), Cylinder(R=1.0)):
            mesh = surface.mesh(2, 2, 2, names, (0, 1), (0, 1))
            loads = [Pressure(1e-6)]
            scene = Scene(mesh, 0.1, material=steel, supports=[Clamped("a")], loads=loads)
            # not by tangents: factorised by rslab they leave threads behind
            answer(scene, {"large_deflection": False})
    import_module("kshell.analysis.large")


def _point(data: Row, point: Row, options: Row, allow_system: bool, folder: Path) -> tuple[list[Row], str]:
    """Rows of one point without its parameters, and why its input was refused, if it was."""
    begin = time.perf_counter()
    try:
        own = copy.copy(data)
        for key, value in point.items():
            own = set_value(own, key.split("."), value, f"sweep: {key}")
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", KshellWarning)  # they stand in the row
            warnings.simplefilter("ignore", RuntimeWarning)  # what is not finite ends as a SolveError
            result = answer(Scene.from_dict(own, folder, source="sweep"), options, allow_system=allow_system)
            cases = result.cases or {"": result}
            rows = [_row(name, case) for name, case in cases.items()]
    except InputError as error:
        return [{"error": str(error)}], str(error)
    except (SolveError, MemoryError) as error:
        return [{"error": str(error) or "out of memory"}], ""
    for row in rows:
        row["seconds"] = time.perf_counter() - begin
        row["error"] = ""
    return rows, ""


def _row(name: str, result: Result) -> Row:
    document = result.to_dict()
    row: Row = {}
    if name:
        row["case"] = name
    for probe, values in document["probes"].items():
        for key, components in COMPONENTS.items():
            for component, value in zip(components, values.get(key, ()), strict=False):
                row[f"{probe}.{component}"] = value
    for key, extreme in document["extremes"].items():
        row[key] = extreme["value"]
    row["strain_energy"] = document["strain_energy"]
    kind = "frequency" if result.analysis == "modes" else "factor"
    for number, entry in enumerate(document["eigen"], 1):
        row[f"{kind}_{number}"] = entry.get("frequency" if kind == "frequency" else "value")
    row["warnings"] = "; ".join(result.warnings)
    return row
