"""Koiter shells."""

from kshell.shell.model import solve_shell

__all__ = ["solve_shell"]
