"""Plates with known answers, used alike by tests, charts and the command `python -m kshell.verify.cases`."""

from kshell.verify.cases.case import Case, Outcome, Reference, Run
from kshell.verify.cases.catalogue import all_cases, find

__all__ = ["Case", "Outcome", "Reference", "Run", "all_cases", "find"]
