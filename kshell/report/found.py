"""What a report says of the answer: probes, extremes, reactions, energies, modes, path, and the error budget."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from kshell.mesh.words import place
from kshell.report.table import Table, components, number, tall
from kshell.result.result import Result
from kshell.result.rounding import without_rounding

# quantity at a probe: words, components
AT_PROBES = {
    "u": ("displacement", "x, y, z"),
    "rotation": ("rotation", "x, y, z"),
    "N": ("membrane force N", "xx, yy, xy"),
    "M": ("moment M", "xx, yy, xy"),
    "Q": ("shear force Q", "x, y"),
    "stress_top": ("stress at the top", "xx, yy, xy"),
    "stress_middle": ("stress in the middle", "xx, yy, xy"),
    "stress_bottom": ("stress at the bottom", "xx, yy, xy"),
}
MOST_STEPS = 30  # rows of a path


def result_tables(result: Result) -> Iterator[Table]:
    """Of one load case, or of modes, buckling, a path or a response."""
    if result.eigen:
        yield _modes(result)
    if result.extremes:
        rows = [_extreme(name, extreme) for name, extreme in result.extremes.items()]
        yield Table("Largest values", ("", "value", "at", "face", "group"), rows)
    for name, probe in result.probes.items():
        yield tall(
            f"Probe {name} at {place(probe['x'])}",
            ("quantity", "axes", "", "", ""),
            [(words, probe[key]) for key, words in AT_PROBES.items() if probe.get(key) is not None],
        )
    if result.reactions:
        entries = [
            ((group, words), reaction[key])
            for group, reaction in without_rounding(result.reactions, result.balance).items()
            for key, words in (("force", "force"), ("moment", "moment about the origin"))
            if reaction.get(key) is not None
        ]
        yield tall("Reactions of the supports", ("support", "", "x", "y", "z"), entries)
    if result.path:
        yield _path(result)
    if result.response:
        yield _response(result)
    if not (result.eigen or result.response):
        yield _balance(result)


def _extreme(name: str, extreme: Mapping[str, Any]) -> list[str]:
    words = [str(extreme.get(key) or "") for key in ("face", "group")]
    return [name.replace("_", " "), number(extreme["value"]), place(extreme["at"]), *words]


def _balance(result: Result) -> Table:
    rows = [
        ["loads and reactions differ by, of their size", f"{result.balance:.1e}"],
        ["strain energy", number(result.strain_energy)],
        *([f"of it {name}", number(part)] for name, part in result.energies.items()),
        ["work of the loads", number(result.external_work)],
    ]
    return Table("Equilibrium and energy", (), rows)


def _modes(result: Result) -> Table:
    buckling = result.analysis == "buckling"
    rows = []
    for n, entry in enumerate(result.eigen, 1):
        shown = entry["value"] if buckling else entry.get("frequency")
        row = [str(n), entry.get("name") or number(shown), number(entry["value"])]
        row += [number(entry.get("lower")), number(entry.get("upper")), str(entry.get("kind") or "")]
        rows.append(row)
    heads = ("", "load factor" if buckling else "frequency in Hz", "value", "lower", "upper", "bounds are")
    title = "Factors of the loads at which it buckles" if buckling else "Natural frequencies"
    return Table(title, heads, rows)


def _path(result: Result) -> Table:
    every = max(1, -(-len(result.path) // MOST_STEPS))
    steps = list(enumerate(result.path))
    chosen = [*steps[:-1:every], steps[-1]]
    heads = ["step", "load factor", *(f"{name} u x, y, z" for name in result.probes)]
    rows = [
        [str(n), number(step["factor"]), *(", ".join(components(p["u"])) for p in step["probes"].values())]
        for n, step in chosen
    ]
    return Table("Path of large deflections", heads, rows)


def _response(result: Result) -> Table:
    rows = []
    frequency = result.response["frequency"]
    for name, probe in result.response["probes"].items():
        size = [
            sum(re**2 + im**2 for re, im in zip(real, imag, strict=True)) ** 0.5
            for real, imag in zip(probe["u"]["real"], probe["u"]["imag"], strict=True)
        ]
        peak = max(range(len(size)), key=size.__getitem__)
        rows.append([name, number(size[peak]), number(frequency[peak])])
    return Table("Largest amplitudes", ("probe", "amplitude", "at Hz"), rows)


def envelope_tables(result: Result) -> Iterator[Table]:
    """Largest values of all cases, and the displacements of probes between which they lie, each with its case."""
    envelope = result.envelope
    rows = [[*_extreme(name, extreme), extreme["case"]] for name, extreme in envelope.extremes.items()]
    if rows:
        yield Table("Largest values", ("", "value", "at", "face", "group", "case"), rows)
    rows = []
    for probe, quantities in envelope.probes.items():
        for key, (words, _) in AT_PROBES.items():
            if key in quantities:
                q = quantities[key]
                for n, (low, low_case, high, high_case) in enumerate(
                    zip(q["min"], q["min_case"], q["max"], q["max_case"], strict=True)
                ):
                    name = AT_PROBES[key][1].split(", ")[n]
                    rows.append([probe, f"{words} {name}", number(low), low_case, number(high), high_case])
    if rows:
        yield Table("At the probes", ("probe", "", "smallest", "case", "largest", "case"), rows)


BUDGET = {
    "discretisation": "size and order of the elements",
    "algebra": "solution of the equations",
    "shear": "shear strain, which the model leaves out",
    "large_deflection": "large deflections, where the model is linear",
    "geometry": "shape of the mesh against that of the structure",
}


def error_tables(result: Result) -> Iterator[Table]:
    """Estimates of the error, relative."""
    error: dict[str, Any] = result.error
    whole = error.get("estimate")
    rows = [["whole", "estimate" if error.get("kind") != "guaranteed" else "guaranteed", _share(whole)]]
    for key, value in (error.get("budget") or {}).items():
        rows.append([key.replace("_", " "), BUDGET.get(key, ""), _share(value)])
    yield Table("Relative error", ("", "of", ""), rows)
    probes = error.get("probes") or {}
    entries = [
        ((name, AT_PROBES.get(key, (key, ""))[0], str(part.get("kind") or "")), part["half_width"])
        for name, quantities in probes.items()
        for key, part in quantities.items()
        if isinstance(part, dict) and part.get("half_width") is not None
    ]
    if entries:
        heads = ("probe", "quantity", "bounds are", "± x", "y", "z")
        yield tall("Half widths of intervals that hold the value", heads, entries)


def _share(value: Any) -> str:
    return "not estimated" if value is None else f"{value:.1e}" if isinstance(value, float) else str(value)
