"""Who is first at which error, and where kshell is not, with the reason that the measurements give."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from verification.work_precision.draw import NAMES, OURS, errors
from verification.work_precision.methods import METHODS
from verification.work_precision.problems import Comparison

Row = Mapping[str, Any]
TARGETS = (1e-3, 1e-6, 1e-9)


@dataclass(frozen=True)
class Standing:
    """The cheapest of kshell's and of the peers' measurements that reach an error; None: nobody does.

    Attributes
    ----------
    by : "seconds" or "unknowns"
    """

    comparison: Comparison
    quantity: str
    target: float
    by: str
    ours: Row | None
    peer: Row | None

    @property
    def ratio(self) -> float:
        """Cost of the peer over that of kshell; 0 or infinite where one does not get there."""
        if self.ours is None:
            return 0.0
        return float("inf") if self.peer is None else float(self.peer[self.by] / self.ours[self.by])


def reaching(rows: Sequence[Row], quantity: str, target: float) -> list[Row]:
    """Measurements below an error whose finer ones stay below it, so that a crossing of zero does not count."""
    out: list[Row] = []
    for method in dict.fromkeys(row["method"] for row in rows):
        own = sorted((row for row in errors(rows, quantity) if row["method"] == method), key=_cells)
        while own and own[-1][f"{quantity} error"] <= target:
            out.append(own.pop())
    return out


def _cells(row: Row) -> float:
    return float(row["cells"])


def standings(comparison: Comparison, rows: Sequence[Row], by: str = "seconds") -> Iterator[Standing]:
    """For each quantity and target that its reference is good for."""
    own = [row for row in rows if row["problem"] == comparison.id]
    for quantity, reference in comparison.references.items():
        for target in TARGETS:
            if target <= reference.uncertainty:
                continue
            good = reaching(own, quantity, target)
            if not good:
                continue
            parts = [[row for row in good if _is_ours(row) == ours] for ours in (True, False)]
            ours, peer = (min(part, key=lambda row: row[by], default=None) for part in parts)
            yield Standing(comparison, quantity, target, by, ours, peer)


def _is_ours(row: Row) -> bool:
    return METHODS[row["method"]].program == OURS


def _words(row: Row | None) -> str:
    if row is None:
        return "not reached"
    return f"{row['seconds']:.3g} s, {int(row['unknowns'])} ({row['method']})"


def first(comparisons: Sequence[Comparison], rows: Sequence[Row]) -> str:
    """Markdown: CPU seconds and unknowns to each error."""
    lines = [
        "| problem | quantity | error | kshell: CPU s, unknowns | best peer | first | ratio |",
        "|---|---|---|---|---|---|---|",
    ]
    for comparison in comparisons:
        for s in standings(comparison, rows):
            leads = s.ratio >= 1
            who = OURS if leads else METHODS[s.peer["method"]].program if s.peer else "nobody"
            ratio = "-" if s.ours is None or s.peer is None else f"{max(s.ratio, 1 / s.ratio):.1f}"
            name = f"**{who}**" if not leads else who
            cells = [_head(s), _words(s.ours), _words(s.peer), name, ratio]
            lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines) + "\n"


def behind(comparisons: Sequence[Comparison], rows: Sequence[Row]) -> list[tuple[Standing, str]]:
    """Where a peer is left of or below kshell, in seconds or in unknowns, and why."""
    out = []
    for comparison in comparisons:
        own = [row for row in rows if row["problem"] == comparison.id]
        for by in ("seconds", "unknowns"):
            for s in standings(comparison, rows, by):
                if s.peer is not None and s.ratio < 1:
                    out.append((s, reason(s, own)))
    return out


def reason(standing: Standing, rows: Sequence[Row]) -> str:
    """What the measurements say about it."""
    ours, peer, by = standing.ours, standing.peer, standing.by
    assert peer is not None
    if ours is None:
        wins = [row[f"{standing.quantity} error"] for row in errors(rows, standing.quantity) if _is_ours(row)]
        return f"no mesh measured gets there, the closest to {min(wins, default=float('nan')):.1e}"
    if by == "unknowns" and METHODS[ours["method"]].element == METHODS[peer["method"]].element:
        return "the same element: supports by a penalty, as GetFEM has them, leave singular corners freer"
    if by == "unknowns":
        return f"{METHODS[peer['method']].id} has the higher order, or eliminates inside the elements"
    least = min(row["seconds"] for row in rows if _is_ours(row))
    if least >= peer["seconds"]:
        return f"fixed cost: kshell's smallest mesh takes {least:.3g} s: checks, supports, equilibrium"
    if ours["unknowns"] <= peer["unknowns"]:
        each = (ours["seconds"] / ours["unknowns"]) / (peer["seconds"] / peer["unknowns"])
        return f"fewer unknowns than the peer, but {each:.1f} times the time for each"
    return "more unknowns: the element of the peer is more accurate here"


def not_first(comparisons: Sequence[Comparison], rows: Sequence[Row]) -> str:
    """Markdown of `behind`."""
    lines = ["| problem | quantity | error | in | kshell | peer | why |", "|---|---|---|---|---|---|---|"]
    for s, why in behind(comparisons, rows):
        lines.append(f"| {' | '.join([_head(s), s.by, _words(s.ours), _words(s.peer), why])} |")
    return "\n".join(lines) + "\n"


def _head(s: Standing) -> str:
    return f"{s.comparison.id} | {NAMES[s.quantity]} | {s.target:.0e}"
