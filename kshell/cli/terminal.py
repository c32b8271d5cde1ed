"""What the command line prints: tables of results and checks."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rich.console import Console
from rich.markup import escape as _escaped

from kshell.cli.intervals import interval_lines
from kshell.cli.tables import components, console, number, table
from kshell.mesh.words import place
from kshell.result.rounding import without_rounding

if TYPE_CHECKING:
    from kshell.result.result import Result

# quantities at a probe: what they are called in the table
AT_PROBES = {
    "x": "at",
    "u": "displacement",
    "rotation": "rotation",
    "N": "N",
    "M": "M",
    "stress_top": "stress top",
    "stress_middle": "stress middle",
    "stress_bottom": "stress bottom",
}
DIRECTIONS = ["x, xx", "y, yy", "z, xy"]
# load factors, or frequencies, of each case that are shown
FIRST_OF_CASES = 3


def print_result(result: Result, written: Iterable[str], seconds: float, writing: float = 0.0) -> None:
    """The answer for people: probes, extremes, reactions, energies, warnings, and where files are.

    Parameters
    ----------
    written : iterable of str
        Paths of files.
    seconds, writing : float
        Of everything, and of writing the files.
    """
    out = console()
    out.print(f"[bold]{_escaped(result.title or 'kshell')}[/bold]")
    mesh = result.mesh
    shell = result.model["kind"] == "shell"
    order = f" of order {result.model['order']}" if result.model["element"] in ("koiter", "hhj") else ""
    out.print(
        f"{result.model['kind']}, element {result.model['element']}{order}: {len(mesh.points)} vertices, "
        f"{len(mesh.triangles)} triangles, {result.unknowns} unknowns"
    )
    if result.units:
        out.print(f"units: {_escaped(result.units)}")
    for reason in result.model["reasons"]:
        out.print(f"  {_escaped(reason)}")
    if result.eigen:
        _print_modes(out, result)
    if result.cases:
        _print_cases(out, result)
    heading = f', case "{result.case}"' if result.case else ""
    if result.probes:
        rows = [row for name, values in result.probes.items() for row in _probe_rows(name, values, shell)]
        out.print(table(["probe", "", *DIRECTIONS], rows, f"Probes{heading} (frame: {result.frame})", 3))
    if result.path:
        states = "state" if len(result.path) == 1 else "states"
        out.print(
            f"path: {len(result.path)} {states}, up to the load factor {number(result.path[-1]['factor'])}"
        )
    if result.history:
        _print_history(out, result)
    for point in result.critical:
        out.print(f"  {point['kind']} point at the load factor {number(point['factor'])}")
    if result.extremes:
        _print_extremes(out, result.extremes, f"Extremes{heading}")
    if result.reactions:
        rows = []
        for name, reaction in without_rounding(result.reactions, result.balance).items():
            rows.append([name, "force", *components(reaction["force"])])
            rows.append(["", "moment about the origin", *components(reaction["moment"])])
        heads = ["support", "", "x", "y", "z"]
        out.print(table(heads, rows, f"Reactions on the {result.model['kind']}{heading}", 3))
    if result.response:
        _print_response(out, result)
    if not (result.eigen or result.response or result.history):
        _print_balance(out, result)
    for line in interval_lines(result):
        out.print(f"  {_escaped(line)}")
    print_warnings(out, result.warnings)
    out.print(
        f"solver {result.solver.get('name', '?')}; {seconds:.2f} s ({', '.join(_stages(result, seconds, writing))})"
    )
    files = list(written)
    for path in _listed(files):
        out.print(f"written: {_escaped(path)}")
    if not files:
        out.print("nothing written: -o DIR writes result.json and result.vtu")


def _stages(result: Result, seconds: float, writing: float) -> Iterable[str]:
    """Seconds of stages, of writing, and of all else: they add up to the whole."""
    stages = dict(result.solver.get("seconds", {}))
    if writing:
        stages["write"] = writing
    stages["other"] = max(seconds - sum(stages.values()), 0.0)
    return (f"{name} {t:.2f}" for name, t in stages.items())


def _probe_rows(name: str, values: Mapping[str, Any], shell: bool) -> Iterable[list[str]]:
    """One row for each quantity: the first with the name of the probe."""
    first = name
    for key, words in AT_PROBES.items():
        if key in values and (shell or key not in ("N", "stress_middle")):
            what = "deflection" if key == "u" and not shell else words
            yield [first, what, *components(values[key])]
            first = ""


def _print_extremes(out: Console, extremes: Mapping[str, Mapping[str, Any]], title: str) -> None:
    """The largest values with place, and with face, group and case where they are known."""
    rows = []
    for name, extreme in extremes.items():
        where = [place(extreme["at"])]
        where += [f'{key} "{extreme[key]}"' for key in ("face", "group", "case") if extreme.get(key)]
        rows.append([name.replace("_", " "), ", ".join(where), number(extreme["value"])])
    out.print(table(["largest", "at", "value"], rows, title, 1))


def _print_cases(out: Console, result: Result) -> None:
    """What each case leads to, and the largest of all."""
    names = [name for name in ("deflection", "von_mises", "utilisation") if name in result.extremes]
    modes, rows, buckling = 0, [], result.analysis == "buckling"
    if result.eigen:
        names, modes = [], min(FIRST_OF_CASES, max(len(case.eigen) for case in result.cases.values()))
    for name, case in result.cases.items():
        added = result.combinations.get(name, {})
        made = " + ".join(f"{factor:g} {part}" for part, factor in added.items()).replace("+ -", "- ")
        known = [number(case.extremes[key]["value"]) if key in case.extremes else "" for key in names]
        known += [_eigenvalue(entry, buckling) for entry in case.eigen[:modes]] + [""] * (
            modes - len(case.eigen)
        )
        rows.append([name, *([made] if result.combinations else []), *known])
    combined = ["combination of"] if result.combinations else []
    heads = ["case", *combined, *(key.replace("_", " ") for key in names)]
    heads += [f"{'factor' if buckling else 'Hz'} {k}" for k in range(1, modes + 1)]
    title = "Load cases, " + (("load factors" if buckling else "frequencies") if modes else "largest values")
    out.print(table(heads, rows, title, len(names) + modes))
    if result.envelope.extremes:
        _print_extremes(out, result.envelope.extremes, "Envelope")


def _print_history(out: Console, result: Result) -> None:
    history = result.history
    steps = len(history["time"]) - 1
    moves = "momentum" in history
    how = "momentum and impulse differ by" if moves else "loads, reactions and contact differ by"
    out.print(
        f"{'motion' if moves else 'at rest'}: {steps} steps up to t = {number(history['time'][-1])}, "
        f"{history['iterations'].sum()} iterations; {how} {result.balance:.1e} of their size"
    )
    rows = []
    for name, values in history["probes"].items():
        size = (values["u"] ** 2).sum(axis=1)
        row = int(size.argmax())
        rows.append([name, *components(values["u"][row]), number(history["time"][row])])
    if rows:
        out.print(table(["probe", "x", "y", "z", "at t"], rows, "Largest displacements", 4))
    forces = [
        [name, *components(force[-1]), number(max((row @ row) ** 0.5 for row in force))]
        for name, force in history.get("contact_force", {}).items()
    ]
    if forces:
        gap = f"Forces on obstacles; smallest gap {number(min(history['smallest_gap']))}"
        out.print(table(["obstacle", "x", "y", "z", "largest"], forces, gap, 4))
    names = ("kinetic_energy", "strain_energy", "external_work", "dissipated_energy")
    energies = [
        [name.replace("_", " "), number(history[name][-1]), number(abs(history[name]).max())]
        for name in names
        if name in history
    ]
    out.print(table(["energy", "at the end", "largest"], energies, "Energies", 2))


def _listed(files: Sequence[str]) -> list[str]:
    """The files written; of many alike the first alone, with their number."""
    rest = list(files)
    for begin, player in (("mode-", "modes.pvd"), ("step-", "series.pvd")):
        frames = [path for path in rest if Path(path).name.startswith(begin)]
        if frames and any(Path(path).name == player for path in rest):
            rest = [path for path in rest if path not in frames]
            rest.append(f"{frames[0]} and {len(frames) - 1} more, which {player} plays")
    return rest


def _print_modes(out: Console, result: Result) -> None:
    """Frequencies or factors with their intervals, and effective masses in per cent of the whole."""
    buckling = result.analysis == "buckling"
    total = result.modal.get("total_mass", [0.0] * 6)
    rows = []
    for place_of, entry in enumerate(result.eigen, 1):
        row = [str(place_of), _eigenvalue(entry, buckling), _interval(entry, buckling)]
        if not buckling:
            row += [_share(m, t) for m, t in zip(entry["effective_mass"], total, strict=True)]
        rows.append(row)
    heads = (
        ["", "factor", "interval"] if buckling else ["", "Hz", "interval", "x", "y", "z", "rx", "ry", "rz"]
    )
    if not buckling and "effective_mass" in result.modal:
        together = result.modal["effective_mass"]
        rows.append(["", "all", "", *(_share(m, t) for m, t in zip(together, total, strict=True))])
    title = "Load factors" if buckling else "Frequencies, effective masses in %"
    title += f', case "{result.case}"' if result.case else ""
    out.print(table(heads, rows, title, len(heads)))


def _eigenvalue(entry: dict[str, Any], buckling: bool) -> str:
    """Load factor or frequency, or the name of a rigid motion."""
    what = entry["value"] if buckling else entry["frequency"]
    return str(entry.get("name") or ("unstable" if what is None else f"{what:.7g}"))


def _print_response(out: Console, result: Result) -> None:
    """The largest amplitude of each probe, with its frequency."""
    frequency, rows = result.response["frequency"], []
    for name, probe in result.response["probes"].items():
        size = [
            sum(re**2 + im**2 for re, im in zip(real, imag, strict=True)) ** 0.5
            for real, imag in zip(probe["u"]["real"], probe["u"]["imag"], strict=True)
        ]
        peak = max(range(len(size)), key=size.__getitem__)
        rows.append([name, number(size[0]), number(size[peak]), f"{frequency[peak]:.6g}"])
    heads = ["probe", f"amplitude at {frequency[0]:.4g} Hz", "largest", "Hz"]
    title = f"Response from {frequency[0]:.4g} to {frequency[-1]:.4g} Hz"
    out.print(table(heads, rows, title, 3))


def _share(part: float, total: float) -> str:
    return f"{100 * part / total:.0f}" if total > 0 else "-"


def _interval(entry: dict[str, Any], buckling: bool) -> str:
    """Width below and above the value, relative, and whether it is proven."""
    if entry["lower"] is None or "name" in entry:
        return ""
    value, lower, upper = entry["value"], entry["lower"], entry["upper"]
    if not buckling and value > 0:
        value, lower, upper = (max(x, 0.0) ** 0.5 for x in (value, lower, upper))
    size = abs(value) or 1.0
    mark = "proven" if entry["kind"] == "guaranteed" else "est."
    return f"-{abs(value - lower) / size:.0e} +{abs(upper - value) / size:.0e} {mark}"


def _print_balance(out: Console, result: Result) -> None:
    out.print(
        f"equilibrium: loads and reactions differ by {result.balance:.1e} of their size; "
        f"strain energy {number(result.strain_energy)}"
        + "".join(f", {name} {number(part)}" for name, part in result.energies.items())
    )


def print_warnings(out: Console, warnings: Iterable[str]) -> None:
    for words in warnings:
        out.print(f"[yellow]warning:[/yellow] {_escaped(words)}")
