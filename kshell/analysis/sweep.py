"""One scene under many values of its parameters, as many at a time as there are cores."""

from __future__ import annotations

import copy
import csv
import os
import time
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from itertools import product
from pathlib import Path
from typing import Any

from kshell.analysis.solve import answer
from kshell.errors import InputError, KshellWarning, SolveError
from kshell.result.result import Result
from kshell.scene.scene import Scene
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
        Called with words after each point.
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
    for number, (found, refused) in enumerate(_solved(data, points, options, allow_system, workers), 1):
        rows.append(found)
        refusals.append(refused)
        if progress is not None:
            progress(
                f"sweep: point {number} of {len(points)}{': ' + found[0]['error'] if found[0]['error'] else ''}"
            )
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
    data: Row, points: Sequence[Row], options: Row, allow_system: bool, workers: int | None
) -> Iterator[tuple[list[Row], str]]:
    from joblib import Parallel, cpu_count, delayed, parallel_config

    if workers is not None and (isinstance(workers, bool) or not isinstance(workers, int) or workers < 1):
        raise InputError(f"sweep: workers = {workers!r} must be a whole number > 0")
    count = min(workers or cpu_count(only_physical_cores=True), len(points))
    folder = Path.cwd()  # processes of an earlier sweep serve again, and stand where that was begun
    if count == 1:
        for point in points:
            yield _point(data, point, options, allow_system, folder)
        return
    with parallel_config("loky", n_jobs=count, inner_max_num_threads=1):
        jobs = (delayed(_point)(data, point, options, allow_system, folder) for point in points)
        yield from Parallel(return_as="generator")(jobs)


def _point(data: Row, point: Row, options: Row, allow_system: bool, folder: Path) -> tuple[list[Row], str]:
    """Rows of one point, and why its input was refused, if it was."""
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
            rows = [_row(point, name, case) for name, case in cases.items()]
    except InputError as error:
        return [{**point, "error": str(error)}], str(error)
    except (SolveError, MemoryError) as error:
        return [{**point, "error": str(error) or "out of memory"}], ""
    for row in rows:
        row["seconds"] = time.perf_counter() - begin
        row["error"] = ""
    return rows, ""


def _row(point: Row, name: str, result: Result) -> Row:
    document = result.to_dict()
    row = dict(point)
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
