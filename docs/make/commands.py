"""The page of all commands, from their declarations."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from docs.make.markdown import in_table
from kshell.cli import commands  # noqa: F401, registers them
from kshell.cli.app import every_command

INTRODUCTION = """# Commands

`kshell COMMAND --help` prints the same in the terminal; `kshell --install-completion` completes commands, options,
files and the keys of `kshell explain` in bash, zsh, fish and PowerShell.

Exit codes: 0 answered, 1 no answer (not converged, out of memory), 2 bad input, 130 interrupted. Errors go to stderr,
one line that says what is wrong, where, and how to mend it; `--debug` adds the traceback.
"""


def commands_page() -> str:
    """Markdown."""
    group: Any = every_command()
    parts = [INTRODUCTION]
    for name, command in group.commands.items():
        parts += _command(name, command)
    return "\n".join(parts)


def _command(name: str, command: Any) -> Iterator[str]:
    arguments = [p for p in command.params if not p.opts[0].startswith("-")]
    options = [p for p in command.params if p.opts[0].startswith("-")]
    usage = " ".join(["kshell", name, *(p.metavar if p.required else f"[{p.metavar}]" for p in arguments)])
    yield f"## {name}\n\n{in_table(' '.join((command.help or '').split()))}\n"
    yield f"```text\n{usage} [OPTIONS]\n```\n"
    yield "| | |\n|---|---|"
    for parameter in [*arguments, *options]:
        flags = parameter.is_flag if parameter in options else False
        value = "" if flags else f" {parameter.metavar or 'VALUE'}"
        names = parameter.metavar if parameter in arguments else ", ".join(parameter.opts) + value
        again = " (required)" if parameter.required and parameter in options else ""
        yield f"| <code>{in_table(names or '')}</code> | {in_table(parameter.help or '')}{again} |"
    yield ""
