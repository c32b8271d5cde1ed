"""Whether the names of units fit each other, by pint where it is installed: the extra "units".

Names that pint does not know are labels like any others, and nothing is said of them.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Any

KINDS = ("force", "length", "mass", "time", "temperature")
DIMENSIONS = {
    "force": "[mass] * [length] / [time] ** 2",
    "length": "[length]",
    "mass": "[mass]",
    "time": "[time]",
    "temperature": "[temperature]",
}
FITS = 1e-3  # relative, to which force and mass times length over time squared must agree


@lru_cache(maxsize=32)
def doubts(units: str) -> tuple[str, ...]:
    """What is wrong with the names of units, in the form of `as_units`, in words; nothing where pint is absent."""
    if not units:
        return ()
    try:
        import pint
    except ImportError:
        return ()
    registry: Any = pint.UnitRegistry()
    known: dict[str, Any] = {}
    out = []
    for kind, name in zip(KINDS, units.split(", "), strict=False):
        try:
            known[kind] = registry.Quantity(1.0, name)
        except Exception:  # pint has many errors for what it cannot read
            continue
        if not known[kind].check(DIMENSIONS[kind]):
            out.append(
                f'units = "{units}": "{name}" stands for the unit of {kind}, but is {known[kind].dimensionality}'
            )
    if out or not {"force", "length", "mass", "time"} <= set(known):
        return tuple(out)
    made = known["mass"] * known["length"] / known["time"] ** 2
    ratio = float((made / known["force"]).to_base_units().magnitude)
    if abs(ratio - 1.0) > FITS:
        force, length, mass, time = units.split(", ")[:4]
        out.append(
            f'units = "{units}": {mass} {length}/{time}^2 is {ratio:.6g} {force}, so that weights, motions and '
            f"frequencies are wrong by as much: take units in which it is 1 {force} (N, mm, t, s or N, m, kg, s)"
        )
    return tuple(out)
