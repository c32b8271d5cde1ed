"""The command line: `kshell solve`, `check`, `trace`, `verify`."""

from kshell.cli.commands import main

__all__ = ["main"]
