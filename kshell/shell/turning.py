"""Where the rotation of a shell can be held or sprung: the one about the edges of curves, and of surfaces."""

from __future__ import annotations

from kshell.errors import InputError
from kshell.mesh.select import Selection


def require_no_point(chosen: Selection, what: str) -> None:
    """Raise InputError if the rotation of a point is to be held."""
    if chosen.dimension == 0:
        raise InputError(
            f"{what}: a point of a shell has no rotation of its own to hold; hold its translations, for example "
            "with simply_supported, or clamp a short edge"
        )


def require_curve(chosen: Selection, what: str) -> None:
    """Raise InputError if a rotation spring is elsewhere than on a curve."""
    if chosen.dimension != 1:
        raise InputError(
            f"{what}: a rotation spring needs a curve, its rotation is the one about it; '{chosen.label}' is a "
            f"{'point' if chosen.dimension == 0 else 'surface'}"
        )
