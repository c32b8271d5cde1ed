"""The gallery notebook: it runs, and what is committed is what the script makes."""

import json
from pathlib import Path

import matplotlib as mpl

from verification.geometry import convergence
from verification.notebooks.make import cells_of

FOLDER = Path(convergence.__file__).parent.parent / "notebooks"


def test_the_notebook_belongs_to_its_script_and_kept_its_outputs() -> None:
    notebook = json.loads((FOLDER / "geometry.ipynb").read_text(encoding="utf-8"))
    cells = [(cell["cell_type"], "".join(cell["source"])) for cell in notebook["cells"]]
    assert cells == cells_of((FOLDER / "geometry.py").read_text(encoding="utf-8"))
    outputs = [output for cell in notebook["cells"] for output in cell.get("outputs", [])]
    assert not [output for output in outputs if output["output_type"] == "error"]
    assert sum("image/png" in output.get("data", {}) for output in outputs) >= 15


def test_every_cell_of_the_gallery_runs(monkeypatch, capsys) -> None:
    """With the last study on two coarse meshes; its full sizes are in the notebook."""
    import matplotlib.pyplot as plt

    mpl.use("Agg")
    monkeypatch.setattr(mpl.pyplot, "show", lambda: None)
    names: dict[str, object] = {}
    for kind, source in cells_of((FOLDER / "geometry.py").read_text(encoding="utf-8")):
        if kind == "code":
            exec(
                compile(source.replace("sizes = (12, 24, 48)", "sizes = (8, 16)"), "geometry.py", "exec"),
                names,
            )
            plt.close("all")
    printed = capsys.readouterr().out
    assert "torsion [0.4 0.4 0.4]" in printed
    assert "inflection" in printed
    assert "singular parametrisation" in printed
