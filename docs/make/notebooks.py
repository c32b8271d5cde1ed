"""Pages of the notebooks: their words, programs, what was printed, and pictures."""

from __future__ import annotations

import json
import re
from base64 import b64decode
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

NOTEBOOKS = Path(__file__).parents[2] / "verification" / "notebooks"
MOST_LINES = 60  # of what a cell printed

INTRODUCTION = """# Notebooks

Each is a file in `verification/notebooks`, made by `python -m verification.notebooks.make NAME` from the program beside
it; the tests run the programs.

"""


@cache
def notebook_pages() -> tuple[dict[str, str], dict[str, bytes]]:
    """Path to Markdown, and path to pictures."""
    texts: dict[str, str] = {}
    drawn: dict[str, bytes] = {}
    index = [INTRODUCTION]
    for path in sorted(NOTEBOOKS.glob("*.ipynb")):
        cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
        parts: list[str] = []
        for number, cell in enumerate(cells):
            parts += _cell(cell, f"{path.stem}-{number}", drawn)
        text = "\n\n".join(parts)
        title = re.search(r"^# (.+)$", text, re.MULTILINE)
        texts[f"verification/notebooks/{path.stem}.md"] = text
        index.append(f"- [{title[1] if title else path.stem}](notebooks/{path.stem}.md)")
    texts["verification/notebooks.md"] = "\n".join(index) + "\n"
    return texts, drawn


def _cell(cell: dict[str, Any], name: str, drawn: dict[str, bytes]) -> Iterator[str]:
    source = "".join(cell["source"]).strip()
    if cell["cell_type"] == "markdown":
        yield source
        return
    if source:
        yield f"```python\n{source}\n```"
    for number, output in enumerate(cell.get("outputs", [])):
        data = output.get("data", {})
        if "image/png" in data:
            path = f"{name}-{number}.png"
            drawn[f"verification/notebooks/{path}"] = b64decode("".join(data["image/png"]))
            yield f"![Drawn by the program above]({path})"
        else:
            text = "".join(output.get("text", data.get("text/plain", ""))).rstrip()
            if text:
                yield f"```text\n{_shortened(text)}\n```"


def _shortened(text: str) -> str:
    """The first lines of a long print."""
    lines = text.splitlines()
    if len(lines) <= MOST_LINES:
        return text
    return "\n".join([*lines[:MOST_LINES], f"({len(lines) - MOST_LINES} more lines)"])
