"""Kirchhoff plates: stiffness, supports, loads, recovered moments and reactions."""

from kshell.plate.model import solve_plate
from kshell.plate.problem import PlateProblem

__all__ = ["PlateProblem", "solve_plate"]
