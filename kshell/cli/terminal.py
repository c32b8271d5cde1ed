"""What the command line prints: tables of results and checks, and progress."""

from __future__ import annotations

import sys
import threading
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rich.console import Console
from rich.table import Table

from kshell.mesh.words import place

if TYPE_CHECKING:
    from rich.status import Status

    from kshell.analysis.check import Findings
    from kshell.mesh.quality import Quality, Summary
    from kshell.result.result import Result

PATIENCE = 1.0  # seconds before progress is shown


class Progress:
    """Names the stage on stderr, once a solve takes longer than about a second and someone watches."""

    def __init__(self) -> None:
        self.stage = "read"
        self._status: Status | None = None
        self._lock = threading.Lock()

    def __call__(self, stage: str) -> None:
        with self._lock:
            self.stage = stage
            if self._status is not None:
                self._status.update(self._words())

    def _words(self) -> str:
        return f"kshell: {self.stage}"

    def _show(self) -> None:
        with self._lock:
            self._status = Console(stderr=True).status(self._words())
            self._status.start()

    @contextmanager
    def shown(self) -> Iterator[Progress]:
        """Show while the block runs."""
        timer = threading.Timer(PATIENCE, self._show)
        timer.daemon = True
        if sys.stderr.isatty():
            timer.start()
        try:
            yield self
        finally:
            timer.cancel()
            with self._lock:
                if self._status is not None:
                    self._status.stop()


def print_result(result: Result, written: Iterable[str], seconds: float) -> None:
    """The answer for people: probes, extremes, reactions, energies, warnings, and where files are."""
    console = _console()
    console.print(f"[bold]{_escaped(result.title or 'kshell')}[/bold]")
    mesh = result.mesh
    shell = result.model["kind"] == "shell"
    order = f" of order {result.model['order']}" if result.model["element"] in ("koiter", "hhj") else ""
    console.print(
        f"{result.model['kind']}, element {result.model['element']}{order}: {len(mesh.points)} vertices, "
        f"{len(mesh.triangles)} triangles, {result.unknowns} unknowns"
    )
    for reason in result.model["reasons"]:
        console.print(f"  {_escaped(reason)}")
    if result.eigen:
        _print_modes(console, result)
    if result.probes:
        moved = (lambda u: _vector(u)) if shell else (lambda u: _number(u[2]))
        rows = [
            [name, _vector(p["x"]), moved(p["u"])]
            + ([_vector(p["N"])] if shell else [])
            + [_vector(p["M"]), _vector(p["stress_top"])]
            for name, p in result.probes.items()
        ]
        heads = [
            "probe",
            "at",
            "displacement" if shell else "deflection w",
            *(["N xx, yy, xy"] if shell else []),
        ]
        heads += ["M xx, yy, xy", "stress top xx, yy, xy"]
        console.print(_table(heads, rows, f"Probes (frame: {result.frame})"))
    if result.path:
        states = "state" if len(result.path) == 1 else "states"
        console.print(
            f"path: {len(result.path)} {states}, up to the load factor {_number(result.path[-1]['factor'])}"
        )
    if result.history:
        _print_history(console, result)
    for point in result.critical:
        console.print(f"  {point['kind']} point at the load factor {_number(point['factor'])}")
    if result.extremes:
        extremes = [
            [name.replace("_", " "), _number(e["value"]), place(e["at"])]
            for name, e in result.extremes.items()
        ]
        console.print(_table(["largest", "value", "at"], extremes, "Extremes"))
    if result.reactions:
        reactions = [
            [name, _vector(r["force"]), _vector(r["moment"])] for name, r in result.reactions.items()
        ]
        heads = ["support", "force", "moment about the origin"]
        console.print(_table(heads, reactions, f"Reactions on the {result.model['kind']}"))
    if result.response:
        _print_response(console, result)
    if not (result.eigen or result.response or result.history):
        _print_balance(console, result)
    _print_warnings(console, result.warnings)
    stages = ", ".join(f"{name} {t:.2f}" for name, t in result.solver.get("seconds", {}).items())
    console.print(f"solver {result.solver.get('name', '?')}; {seconds:.2f} s ({stages})")
    files = list(written)
    for path in _listed(files):
        console.print(f"written: {_escaped(path)}")
    if not files:
        console.print("nothing written: -o DIR writes result.json and result.vtu")


def _print_history(console: Console, result: Result) -> None:
    history = result.history
    steps = len(history["time"]) - 1
    console.print(
        f"motion: {steps} steps up to t = {_number(history['time'][-1])}, {history['iterations'].sum()} iterations; "
        f"momentum and impulse differ by {result.balance:.1e} of their size"
    )
    rows = []
    for name, values in history["probes"].items():
        size = (values["u"] ** 2).sum(axis=1)
        row = int(size.argmax())
        rows.append([name, _vector(values["u"][row]), _number(history["time"][row])])
    if rows:
        console.print(_table(["probe", "largest displacement", "at t"], rows, "On the way"))
    names = ("kinetic_energy", "strain_energy", "external_work", "dissipated_energy")
    energies = [
        [name.replace("_", " "), _number(history[name][-1]), _number(abs(history[name]).max())]
        for name in names
    ]
    console.print(_table(["energy", "at the end", "largest"], energies, "Energies"))


def _listed(files: Sequence[str]) -> list[str]:
    """The files written; of many alike the first alone, with their number."""
    rest = list(files)
    for begin, player in (("mode-", "modes.pvd"), ("step-", "series.pvd")):
        frames = [path for path in rest if Path(path).name.startswith(begin)]
        if frames and any(Path(path).name == player for path in rest):
            rest = [path for path in rest if path not in frames]
            rest.append(f"{frames[0]} and {len(frames) - 1} more, which {player} plays")
    return rest


def _print_modes(console: Console, result: Result) -> None:
    """Frequencies or factors with their intervals, and effective masses in per cent of the whole."""
    buckling = result.analysis == "buckling"
    total = result.modal.get("total_mass", [0.0] * 6)
    rows = []
    for number, entry in enumerate(result.eigen, 1):
        what = entry["value"] if buckling else entry["frequency"]
        words = entry.get("name") or ("unstable" if what is None else f"{what:.7g}")
        row = [str(number), words, _interval(entry, buckling)]
        if not buckling:
            row += [_share(m, t) for m, t in zip(entry["effective_mass"], total, strict=True)]
        rows.append(row)
    heads = (
        ["", "factor", "interval"] if buckling else ["", "Hz", "interval", "x", "y", "z", "rx", "ry", "rz"]
    )
    if not buckling and result.modal:
        together = result.modal["effective_mass"]
        rows.append(["", "all", "", *(_share(m, t) for m, t in zip(together, total, strict=True))])
    title = "Load factors" if buckling else "Frequencies, effective masses in %"
    console.print(_table(heads, rows, title))


def _print_response(console: Console, result: Result) -> None:
    """The largest amplitude of each probe, with its frequency."""
    frequency, rows = result.response["frequency"], []
    for name, probe in result.response["probes"].items():
        size = [
            sum(re**2 + im**2 for re, im in zip(real, imag, strict=True)) ** 0.5
            for real, imag in zip(probe["u"]["real"], probe["u"]["imag"], strict=True)
        ]
        peak = max(range(len(size)), key=size.__getitem__)
        rows.append([name, _number(size[0]), _number(size[peak]), f"{frequency[peak]:.6g}"])
    heads = ["probe", f"amplitude at {frequency[0]:.4g} Hz", "largest", "Hz"]
    title = f"Response from {frequency[0]:.4g} to {frequency[-1]:.4g} Hz"
    console.print(_table(heads, rows, title))


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


def _print_balance(console: Console, result: Result) -> None:
    console.print(
        f"equilibrium: loads and reactions differ by {result.balance:.1e} of their size; "
        f"strain energy {_number(result.strain_energy)}"
        + "".join(f", {name} {_number(part)}" for name, part in result.energies.items())
    )


def print_findings(found: Findings) -> None:
    """What a check found, except the problems."""
    console = _console()
    _print_summary(console, found.summary)
    _print_quality(console, found.quality)
    if found.model:
        console.print("[bold]What would be solved[/bold]")
        for words in found.model:
            console.print(f"  {_escaped(words)}")
    _print_warnings(console, found.warnings)
    if not found.problems:
        console.print("[green]nothing found that would stop a solve[/green]")


def _print_summary(console: Console, summary: Summary) -> None:
    console.print(
        f"[bold]{_escaped(summary.source)}[/bold]: order {summary.order}, {summary.vertices} vertices, "
        f"{summary.edges} edges, {summary.triangles} triangles"
    )
    console.print(
        f"from {place(summary.lower)} to {place(summary.upper)}, area {summary.area:.6g}, "
        f"boundary {summary.boundary_length:.6g} long"
    )
    unit = {"point": "", "curve": "length", "surface": "area"}
    rows = [
        [g.name, g.kind, str(g.members), f"{unit[g.kind]} {g.measure:.6g}" if unit[g.kind] else ""]
        for g in summary.groups
    ]
    console.print(_table(["group", "kind", "members", "size"], rows, "Groups") if rows else "no groups")


def _print_quality(console: Console, worst: Quality) -> None:
    rows = [
        ["smallest angle", f"{worst.min_angle:.3g} degrees", place(worst.min_angle_at)],
        ["largest aspect ratio", f"{worst.max_aspect:.3g}", place(worst.max_aspect_at)],
        ["shortest edge", f"{worst.shortest_edge:.4g}", place(worst.shortest_edge_at)],
        ["longest edge", f"{worst.longest_edge:.4g}", place(worst.longest_edge_at)],
    ]
    console.print(_table(["quality", "worst", "at"], rows, "Triangles"))


def _print_warnings(console: Console, warnings: Iterable[str]) -> None:
    for words in warnings:
        console.print(f"[yellow]warning:[/yellow] {_escaped(words)}")


def _console() -> Console:
    """Tables go to stdout; into a pipe or file they are not cut to a terminal's width."""
    return Console(highlight=False, width=None if sys.stdout.isatty() else 140)


def _table(heads: Sequence[str], rows: Iterable[Sequence[str]], title: str) -> Table:
    table = Table(*heads, title=title, title_justify="left", title_style="bold")
    for row in rows:
        table.add_row(*map(_escaped, row))
    return table


def _escaped(text: str) -> str:
    from rich.markup import escape

    return escape(str(text))


def _number(value: float) -> str:
    return f"{value:.6g}"


def _vector(values: Any) -> str:
    size = max((abs(v) for v in values), default=0.0)
    return ", ".join(f"{v if abs(v) > 1e-12 * size else 0.0:.5g}" for v in values)
