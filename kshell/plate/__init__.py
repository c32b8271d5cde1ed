"""Kirchhoff plates: stiffness, supports, loads, recovered moments and reactions."""

from kshell.plate.model import PlateModel

__all__ = ["PlateModel"]
