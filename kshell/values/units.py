"""Names of units, as labels beside numbers: nothing is ever converted by them."""

from __future__ import annotations

MOST = 5  # force, length, mass, time, temperature


def as_units(value: object) -> str:
    """The names in one form: "N,mm" -> "N, mm"; empty where none are given.

    Raises
    ------
    ValueError
        If it is not text with the names of a force and a length, and at most those of a mass, a time and a temperature.
    """
    if value == "":
        return ""
    names = [name.strip() for name in value.split(",")] if isinstance(value, str) else []
    if not 2 <= len(names) <= MOST or not all(names):
        raise ValueError(
            'must be the names of the units of force and length, as "N, mm", after which those of mass, time and '
            "temperature may stand"
        )
    return ", ".join(names)


def unit(units: str, force: int, length: int) -> str:
    """The unit of a force to some power times a length to some power: "N/mm^2"; empty without units."""
    if not units:
        return ""
    names = units.split(", ")
    powers = [(names[0], force), (names[1], length)]
    above = [_power(name, n) for name, n in powers if n > 0]
    below = [_power(name, -n) for name, n in powers if n < 0]
    return " ".join(above or ["1"]) + "".join(f"/{part}" for part in below)


def labelled(words: str, units: str, force: int, length: int) -> str:
    """Words with the unit behind them in brackets; the words alone without units."""
    return f"{words} [{unit(units, force, length)}]" if units else words


def _power(name: str, n: int) -> str:
    return name if n == 1 else f"{name}^{n}"
