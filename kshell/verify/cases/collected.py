"""All references that were collected, and which cases run them: none is left out without a reason.

collected.json has an entry for each: what it is, and either the cases that run it or why none does.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache

from kshell.verify.cases.case import HERE


@dataclass(frozen=True)
class Collected:
    """One reference, or one table of them.

    Attributes
    ----------
    id : str
    what : str
    cases : tuple of str
        Ids of the cases that run it.
    reason : str
        Why there are none; empty where there are.
    """

    id: str
    what: str
    cases: tuple[str, ...]
    reason: str


@cache
def collected() -> tuple[Collected, ...]:
    """All of them."""
    entries = json.loads((HERE / "collected.json").read_text(encoding="utf-8"))
    return tuple(
        Collected(id, entry["what"], tuple(entry.get("cases", ())), entry.get("not run", ""))
        for id, entry in entries.items()
    )


def left_out() -> Mapping[str, list[Collected]]:
    """Those that are not run, by reason."""
    out: dict[str, list[Collected]] = {}
    for one in collected():
        if not one.cases:
            out.setdefault(one.reason, []).append(one)
    return out
