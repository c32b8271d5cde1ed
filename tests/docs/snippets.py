"""Programs, commands and files in pages, and how they are run.

A comment above a block says when: `<!-- full -->` with the tests that take long, `<!-- not run: why -->` never.
"""

from __future__ import annotations

import contextlib
import io
import re
import shlex
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from jsonschema import Draft7Validator

from kshell.cli.commands import run
from kshell.scene.schema import scene_schema

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
BLOCK = re.compile(
    r"(?:<!-- (?P<mark>[^>]*?) -->\n)?(?P<indent> *)```(?P<kind>\w+)(?P<options>[^\n]*)\n(?P<text>.*?)^(?P=indent)```",
    re.DOTALL | re.MULTILINE,
)
INCLUDED = re.compile(r'^--8<-- "(.+)"$', re.MULTILINE)
KINDS = ("sh", "python", "toml", "text")
PARTS = Draft7Validator({key: value for key, value in scene_schema().items() if key != "required"})


@dataclass(frozen=True)
class Snippet:
    """A block of a page.

    Attributes
    ----------
    kind : "sh", "python", "toml" or "text"
    text : str
    title : str
        Name of the file that it is, or nothing.
    full, run : bool
        Whether it takes long, and whether it is run at all.
    line : int
    """

    kind: str
    text: str
    title: str
    full: bool
    run: bool
    line: int


def pages() -> list[Path]:
    """README.md and all pages of docs/ that are written by hand."""
    return [ROOT / "README.md", *sorted(DOCS.rglob("*.md"))]


def snippets(page: Path) -> list[Snippet]:
    """All blocks of a page, in their order."""
    text = page.read_text(encoding="utf-8")
    out = []
    for found in BLOCK.finditer(text):
        title = re.search(r'title="([^"]+)"', found["options"])
        mark = found["mark"] or ""
        body = INCLUDED.sub(lambda name: (DOCS / name[1]).read_text(encoding="utf-8"), found["text"])
        line = text.count("\n", 0, found.start()) + 1
        if found["kind"] not in KINDS:
            raise ValueError(f"{page.name}, line {line}: a block of {found['kind']} is not run by any test")
        out.append(
            Snippet(
                found["kind"],
                body,
                title[1] if title else "",
                mark == "full",
                not mark.startswith("not run"),
                line,
            )
        )
    return out


def follow(page: Path, full: bool) -> Iterator[str]:
    """Run the blocks of a page in the current folder; what is wrong with them."""
    names: dict[str, Any] = {"__name__": "page"}
    for one in snippets(page):
        if not one.run or (one.full and not full):
            continue
        where = f"{page.name}, line {one.line}"
        if one.title:
            Path(one.title).write_text(one.text, encoding="utf-8")
        if one.kind == "toml":
            wrong = [error.message for error in PARTS.iter_errors(tomllib.loads(one.text))]
            yield from (f"{where}: {words}" for words in wrong)
        elif one.kind == "python":
            with contextlib.redirect_stdout(io.StringIO()):
                exec(compile(one.text, where, "exec"), names)
        elif one.kind == "sh":
            for command in one.text.splitlines():
                yield from _command(command, where)


def _command(line: str, where: str) -> Iterator[str]:
    words = shlex.split(line, comments=True)
    if not words:
        return
    if words[0] != "kshell":
        yield f"{where}: {words[0]} is not run by any test"
        return
    said = io.StringIO()
    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(said):
        code = run(words[1:])
    if code != 0:
        yield f"{where}: {line} ended with {code}: {said.getvalue()}"
