"""Plates with known answers, used alike by tests, charts and the command `python -m verification.cases`."""

from verification.cases.case import Case, Outcome, Reference, Run
from verification.cases.catalogue import all_cases, find

__all__ = ["Case", "Outcome", "Reference", "Run", "all_cases", "find"]
