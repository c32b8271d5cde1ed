"""What of the reactions is nothing but rounding, for tables and words; result.json has the numbers as they are."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

LEAST, MOST = 1e-10, 1e-6  # of the largest reaction, and of balances that are taken for rounding


def without_rounding(reactions: Mapping[str, Mapping[str, Any]], balance: float) -> dict[str, dict[str, Any]]:
    """Reactions by support, components as 0 that are below the rounding of the largest of all supports.

    Parameters
    ----------
    reactions : dict of str to {"force", "moment"}
    balance : float
        Relative error of the equilibrium, which says how far the largest ones are from right.
    """
    part = float(np.clip(balance, LEAST, MOST)) if np.isfinite(balance) else LEAST
    out: dict[str, dict[str, Any]] = {group: dict(reaction) for group, reaction in reactions.items()}
    for key in ("force", "moment"):
        known = [np.asarray(each[key], dtype=float) for each in out.values() if each.get(key) is not None]
        least = part * max((float(np.abs(each).max()) for each in known), default=0.0)
        for reaction in out.values():
            if reaction.get(key) is not None:
                values = np.asarray(reaction[key], dtype=float)
                reaction[key] = np.where(np.abs(values) > least, values, 0.0)
    return out
