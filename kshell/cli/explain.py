"""`kshell explain`: what the keys of a scene file mean, from their models."""

from __future__ import annotations

from typing import Annotated

import typer

from kshell.cli.app import command
from kshell.cli.options import Debugging
from kshell.errors import InputError


def _complete(incomplete: str) -> list[str]:
    from kshell.scene.lookup import names

    return [name for name in names() if name.startswith(incomplete)]


@command()
def explain(
    key: Annotated[
        str | None,
        typer.Argument(
            metavar="KEY", help="Such as load.line_force, support.kind, solve.", autocompletion=_complete
        ),
    ] = None,
    *,
    schema: Annotated[
        bool, typer.Option("--schema", help="Print the JSON schema of scene files, for editors.")
    ] = False,
    debugging: Debugging,
) -> None:
    """Say what a key of a scene file means: its type, unit, default and an example."""
    if schema:
        if key is not None:
            raise InputError(f"--schema is of all keys: leave {key} out")
        from kshell.scene.schema import schema_text

        print(schema_text(), end="")
        return
    from kshell.cli.explained import print_explanation

    print_explanation(key)
