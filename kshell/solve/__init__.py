"""Linear solvers: one call takes matrix, loads and the space behind them, and says what it did and why."""

from kshell.solve.call import prepare, solve_system
from kshell.solve.checks import FreeMotion
from kshell.solve.system import PlateSpace, Prepared, Solution

__all__ = ["FreeMotion", "PlateSpace", "Prepared", "Solution", "prepare", "solve_system"]
