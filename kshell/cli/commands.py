"""The command line: all commands, what they end with, and how errors are said.

Exit codes: 0 answered, 1 no answer, 2 bad input, 130 interrupted. Errors are one message on stderr; a
traceback only with --debug. Heavy imports happen inside the commands: help is immediate.
"""

from __future__ import annotations

import sys
import traceback
from collections.abc import Sequence
from types import TracebackType
from typing import Any

import typer

from kshell.cli.app import called
from kshell.distributed.launch import launched
from kshell.errors import Interrupted, KshellError, SolveError

# isort: off
# in the order of the commands in the help
from kshell.cli import answers  # noqa: F401
from kshell.cli import starting  # noqa: F401
from kshell.cli import explain  # noqa: F401
from kshell.cli import looking  # noqa: F401
# isort: on

ClickException: Any = next(c for c in typer.BadParameter.__mro__ if c.__name__ == "ClickException")
INTERRUPTED = 130


def _say(message: str, debug: bool = False) -> None:
    if debug and sys.exc_info()[0] is not None:
        traceback.print_exc()
    print(f"error: {message}", file=sys.stderr)


def _short_report(kind: type[BaseException], error: BaseException, _: TracebackType | None) -> None:
    """For an error nobody foresaw: still one message, and how to see more. Python exits with code 1."""
    _say(
        f"{kind.__name__}: {error}. This is a fault of kshell: --debug shows the traceback, please report it"
    )


def run(arguments: Sequence[str]) -> int:
    """Run the command line and return its exit code."""
    debug = "--debug" in arguments
    if not debug:
        sys.excepthook = _short_report
    command: Any = called(arguments)
    try:
        code = command.main(list(arguments) or ["--help"], prog_name="kshell", standalone_mode=False) or 0
    except ClickException as error:
        words = error.format_message().rstrip().rstrip(".")
        if words.startswith("No such command"):
            words += f"; the commands are {', '.join(command.commands)}"
        _say(f"{words}. See kshell --help", debug)
        return 2
    except KshellError as error:
        _say(str(error), debug)
        return 1 if isinstance(error, SolveError) else 2
    except MemoryError:
        _say("out of memory: take a coarser mesh, element morley, or solver multigrid", debug)
        return 1
    except Interrupted as error:
        _say(f"{error}: files are written whole or not at all, --resume goes on with a path", debug)
        return INTERRUPTED
    except (KeyboardInterrupt, typer.Abort):
        code = INTERRUPTED  # depending on its version typer raises or returns
    if code == INTERRUPTED:
        _say("interrupted: files are written whole or not at all", debug)
    return int(code)


def main() -> None:
    """Entry point of the `kshell` command."""
    if launched() is None:
        sys.exit(run(sys.argv[1:]))
    from kshell.distributed.command import run_together

    sys.exit(run_together(run, sys.argv[1:]))
