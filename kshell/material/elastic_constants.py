"""Conversions between the constants of an isotropic material, with their limits.

Symbols: E Young's modulus, nu Poisson's ratio, lame_lambda and lame_mu Lame's constants (lame_mu is also
the shear modulus), bulk_modulus K. Formulas: Sokolnikoff 1956, table in section 23.
"""

from __future__ import annotations

from math import sqrt

from kshell.errors import InputError
from kshell.values.naming import listing, suggestion

CONSTANTS = ("E", "nu", "lame_lambda", "lame_mu", "bulk_modulus")


def elastic_constants(**two: float) -> dict[str, float]:
    """All constants of an isotropic material from two of them.

    Parameters
    ----------
    **two
        Any two of E, nu, lame_lambda, lame_mu, bulk_modulus.

    Returns
    -------
    dict with all five; the two that were given are returned as they were.

    Raises
    ------
    InputError
        If not two constants are given, or the material is not positive definite:
        E > 0, lame_mu > 0, bulk_modulus > 0, -1 < nu < 1/2.
    """
    for name in two:
        if name not in CONSTANTS:
            raise InputError(
                f'material: unknown constant "{name}": {suggestion(name, CONSTANTS)}'
                f"the constants are {listing(CONSTANTS)}"
            )
    if len(two) != 2:
        raise InputError(f"material: two constants make an isotropic material, got {listing(two)}")
    for name in ("E", "lame_mu", "bulk_modulus"):
        if name in two:
            require_positive(name, two[name])
    if "nu" in two:
        _require_poisson(two["nu"], two)
    E, nu = _engineering(two)
    _require_poisson(nu, two)
    require_positive("E", E)
    return {
        "E": E,
        "nu": nu,
        "lame_lambda": E * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)),
        "lame_mu": E / (2.0 * (1.0 + nu)),
        "bulk_modulus": E / (3.0 * (1.0 - 2.0 * nu)),
    } | two


def _engineering(two: dict[str, float]) -> tuple[float, float]:
    """E and nu from any two constants."""
    match two:
        case {"E": E, "nu": nu}:
            return E, nu
        case {"E": E, "lame_lambda": lam}:
            root = sqrt(E * E + 9.0 * lam * lam + 2.0 * E * lam)
            return E, 2.0 * lam / (E + lam + root)
        case {"E": E, "lame_mu": mu}:
            return E, E / (2.0 * mu) - 1.0
        case {"E": E, "bulk_modulus": K}:
            return E, (3.0 * K - E) / (6.0 * K)
        case {"nu": nu, "lame_lambda": lam}:
            if nu == 0.0:
                raise InputError(
                    "material: nu = 0 makes lame_lambda 0 whatever E is: give E or lame_mu instead"
                )
            return lam * (1.0 + nu) * (1.0 - 2.0 * nu) / nu, nu
        case {"nu": nu, "lame_mu": mu}:
            return 2.0 * mu * (1.0 + nu), nu
        case {"nu": nu, "bulk_modulus": K}:
            return 3.0 * K * (1.0 - 2.0 * nu), nu
        case {"lame_lambda": lam, "lame_mu": mu}:
            if 3.0 * lam + 2.0 * mu <= 0.0:
                raise InputError(
                    f"material: 3 lame_lambda + 2 lame_mu = {3.0 * lam + 2.0 * mu:g} must be > 0 "
                    f"(three times the bulk modulus): lame_lambda must exceed {-2.0 * mu / 3.0:g}"
                )
            return mu * (3.0 * lam + 2.0 * mu) / (lam + mu), lam / (2.0 * (lam + mu))
        case {"lame_lambda": lam, "bulk_modulus": K}:
            if lam >= K:
                raise InputError(f"material: lame_lambda = {lam:g} must be below the bulk modulus {K:g}")
            return 9.0 * K * (K - lam) / (3.0 * K - lam), lam / (3.0 * K - lam)
        case {"lame_mu": mu, "bulk_modulus": K}:
            return 9.0 * K * mu / (3.0 * K + mu), (3.0 * K - 2.0 * mu) / (2.0 * (3.0 * K + mu))
    raise AssertionError(f"no formula for {two}")


def require_positive(name: str, value: float) -> None:
    """Raise InputError unless the constant is > 0."""
    if not value > 0.0:
        raise InputError(f"material: {name} = {value:g} must be > 0")


def _require_poisson(nu: float, given: dict[str, float]) -> None:
    if not -1.0 < nu < 0.5:
        origin = (
            "" if "nu" in given else " (from " + ", ".join(f"{k} = {v:g}" for k, v in given.items()) + ")"
        )
        raise InputError(
            f"material: nu = {nu:g}{origin} must lie strictly between -1 and 1/2; "
            "1/2 is incompressible: take 0.499 for rubber"
        )
