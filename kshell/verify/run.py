"""Solve the cases one after the other and compare: quick or full, nothing left out silently."""

from __future__ import annotations

import time
import warnings
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from kshell.errors import KshellError, KshellWarning
from kshell.verify.cases import Case, Outcome, Run, all_cases
from kshell.verify.cases.rates import RATES, Measured


@dataclass(frozen=True)
class Block:
    """What one solve gave, or one rate from two.

    Attributes
    ----------
    outcomes : tuple of Outcome
        One per quantity.
    seconds : float
        Of wall time.
    problem : str
        Why there is no answer; empty where there is one.
    measured : Measured, optional
        The errors behind a rate.
    """

    outcomes: tuple[Outcome, ...]
    seconds: float
    problem: str = ""
    measured: Measured | None = None


@dataclass(frozen=True)
class Report:
    """All of them.

    Attributes
    ----------
    blocks : tuple of Block
    seconds, cpu_seconds : float
        Of wall time and of processor time, altogether.
    quick : bool
    """

    blocks: tuple[Block, ...]
    seconds: float
    quick: bool
    cpu_seconds: float = 0.0

    @property
    def outcomes(self) -> list[Outcome]:
        """Of all blocks."""
        return [one for block in self.blocks for one in block.outcomes]

    @property
    def cases(self) -> int:
        """How many were run."""
        return len({one.case for one in self.outcomes})

    @property
    def failed(self) -> list[Outcome]:
        """What lies outside the allowance."""
        return [one for one in self.outcomes if not one.passed]

    @property
    def worst(self) -> Outcome:
        """The outcome with the largest ratio of error to allowed error."""
        return max(self.outcomes, key=lambda one: one.used)

    def summary(self) -> str:
        """One line: how many cases, how many failed, the worst ratio."""
        worst = self.worst
        verdict = "all within what is allowed" if not self.failed else f"{len(self.failed)} values FAILED"
        place = f"{worst.case} {worst.run} {worst.quantity}"
        return (
            f"{self.cases} cases, {len(self.outcomes)} values in {self.seconds:.0f} s ({self.cpu_seconds:.0f} s of "
            f"the processor): {verdict}; worst ratio of error to allowed error {worst.used:.2g} ({place})"
        )


def run_blocks(quick: bool, cases: Iterable[Case] | None = None) -> Iterator[Block]:
    """Solve, one block at a time. Quick: once with each element and degree. Full: on all meshes, and the rates."""
    for case in all_cases() if cases is None else cases:
        for run in case.quick_runs if quick else case.runs:
            yield _solved(case, run)
    if not quick and cases is None:
        for row in RATES:
            begin = time.perf_counter()
            with _quiet():
                measured = row.measure()
            yield Block((measured.compare(),), time.perf_counter() - begin, measured=measured)


def _solved(case: Case, run: Run) -> Block:
    begin = time.perf_counter()
    try:
        with _quiet():
            found = case.compare(run, case.solve(run))
    except KshellError as error:
        return Block(tuple(_unanswered(case, run)), time.perf_counter() - begin, str(error))
    return Block(tuple(found), time.perf_counter() - begin)


def _unanswered(case: Case, run: Run) -> Iterator[Outcome]:
    """Without an answer every quantity fails."""
    for name, quantity in case.quantities.items():
        if run.element in quantity.elements:
            reference = case.references[name].value
            allowed = case.allowed.get(run.name, {}).get(name, 0.0)
            most = case.most_unknowns.get(run.name, 0)
            yield Outcome(case.id, run.name, name, 0, np.nan, reference, np.inf, allowed, most)


def _quiet() -> warnings.catch_warnings[None]:
    """Warnings of singular corners belong to the cases."""
    return warnings.catch_warnings(action="ignore", category=KshellWarning)
