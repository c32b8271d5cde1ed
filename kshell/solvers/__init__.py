"""Linear solvers: one call takes matrix, loads and the space behind them, and says what it did and why."""

from kshell.solvers.call import prepare, solve_system
from kshell.solvers.checks import FreeMotion
from kshell.solvers.system import PlateSpace, Prepared, Solution

__all__ = ["FreeMotion", "PlateSpace", "Prepared", "Solution", "prepare", "solve_system"]
