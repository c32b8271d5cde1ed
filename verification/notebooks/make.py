"""Make a notebook from the script beside it, run it, and keep its outputs.

    python -m verification.notebooks.make geometry

Scripts have cells that start with "# %%", or "# %% [markdown]" for text. Needs nbformat, nbclient and ipykernel.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

FOLDER = Path(__file__).parent
# pictures small enough for the repository
SETUP = "%matplotlib inline\n%config InlineBackend.figure_formats = ['png']\n"
SETUP += "import matplotlib\nmatplotlib.rcParams['figure.dpi'] = 66"


def cells_of(script: str) -> list[tuple[str, str]]:
    """(kind, source) of the cells of a script; kind is "markdown" or "code"."""
    cells = []
    for part in script.split("# %%")[1:]:
        head, _, body = part.partition("\n")
        if "[markdown]" in head:
            lines = [line.removeprefix("#").removeprefix(" ") for line in body.strip().split("\n")]
            cells.append(("markdown", "\n".join(lines)))
        else:
            cells.append(("code", body.strip()))
    return cells


def joined(outputs: list[Any]) -> list[Any]:
    """The outputs of a cell with the pieces of a text in one, whose number depends on how fast they were printed."""
    result: list[Any] = []
    for output in outputs:
        before = result[-1] if result else {}
        if (
            output["output_type"] == before.get("output_type") == "stream"
            and output["name"] == before["name"]
        ):
            before["text"] += output["text"]
        else:
            result.append(output)
    return result


def make(name: str) -> Path:
    """Write and run the notebook of a script.

    Raises
    ------
    nbclient.exceptions.CellExecutionError
        If a cell fails; nothing is written then.
    """
    import nbformat
    from nbclient import NotebookClient

    made = nbformat.v4.new_notebook()
    for number, (kind, source) in enumerate(cells_of((FOLDER / f"{name}.py").read_text(encoding="utf-8"))):
        new = nbformat.v4.new_markdown_cell if kind == "markdown" else nbformat.v4.new_code_cell
        made.cells.append(new(source, id=f"cell-{number}"))
    first = next(cell for cell in made.cells if cell.cell_type == "code")
    source, first.source = first.source, f"{SETUP}\n{first.source}"
    root = {"metadata": {"path": str(FOLDER.parent.parent)}}
    NotebookClient(made, timeout=600, kernel_name="python3", resources=root).execute()
    first.source = source
    for cell in made.cells:
        cell.metadata.pop("execution", None)  # times of this run
        if cell.cell_type == "code":
            cell.outputs = joined(cell.outputs)
            for output in cell.outputs:
                if output["output_type"] == "stream":  # warnings say where they come from
                    output["text"] = output["text"].replace(f"{FOLDER.parent.parent}/", "")
    kernel = {"name": "python3", "display_name": "Python 3", "language": "python"}
    made.metadata = {"language_info": {"name": "python"}, "kernelspec": kernel}
    path = FOLDER / f"{name}.ipynb"
    nbformat.write(made, path)
    return path


if __name__ == "__main__":
    for given in sys.argv[1:]:
        print(make(given))
