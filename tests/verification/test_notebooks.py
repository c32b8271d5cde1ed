"""The notebooks: they run, and what is committed is what the scripts make."""

import json
import re
from pathlib import Path

import matplotlib as mpl
import pytest

import verification.notebooks.make as making

FOLDER = Path(making.__file__).parent
PICTURES = {
    "plates": 4,
    "supports": 4,
    "materials": 3,
    "failures": 18,
    "shells": 9,
    "large_deflections": 7,
    "motion": 4,
    "work_precision": 5,
    "how_sure": 3,
}
QUICK = {
    "quick = False": "quick = True",
    "sizes = (4, 8, 16, 32)": "sizes = (4, 8)",
    "sizes = (2, 3, 4, 6, 8)": "sizes = (2, 4)",
}
SAYS = {
    "plates": ("reference   0.004062352661", "6 layers: w = 0.0115"),
    "supports": ("CCCC: largest deflection 0.001265", "true curve"),
    "materials": ("material.crossply.sinus.ba1", "Eliminating the stress"),
    "failures": ("Babuska", "moment over it", "valence 6", "Regge", "hinge, tangent"),
    "shells": ("reference       -0.300592457", "observed order", "Koiter 2571.96514"),
    "work_precision": ("| problem | quantity | error |", "deflection 2.66e-06, in the table 2.66e-06"),
    "motion": ("em     period longer by 2.0", "static -27.65", "weight 2.4525", "keeps"),
    "how_sure": ("(guaranteed)", "rate of the last three -4", "1e-06", "by hand", "clamped     0.01"),
    "large_deflections": ("0.713791524", "for small deflections", "table 0.7421, 0.1729"),
}


def cells(name):
    return making.cells_of((FOLDER / f"{name}.py").read_text(encoding="utf-8"))


@pytest.mark.parametrize("name", PICTURES)
def test_the_notebook_belongs_to_its_script_and_kept_its_outputs(name):
    notebook = json.loads((FOLDER / f"{name}.ipynb").read_text(encoding="utf-8"))
    assert [(cell["cell_type"], "".join(cell["source"])) for cell in notebook["cells"]] == cells(name)
    outputs = [output for cell in notebook["cells"] for output in cell.get("outputs", [])]
    assert not [output for output in outputs if output["output_type"] == "error"]
    printed = "".join("".join(output.get("text", ())) for output in outputs)
    assert not re.search(r"/(tmp|home|root|work|Users)/\w", printed)  # paths of the machine that made it
    assert sum("image/png" in output.get("data", {}) for output in outputs) >= PICTURES[name]


@pytest.mark.full
@pytest.mark.parametrize("name", PICTURES)
def test_every_cell_runs_in_the_quick_setting(name, monkeypatch, capsys):
    import matplotlib.pyplot as plt

    mpl.use("Agg")
    monkeypatch.setattr(plt, "show", lambda: None)
    names = {}
    for kind, source in cells(name):
        if kind == "code":
            for full, quick in QUICK.items():
                source = source.replace(full, quick)
            exec(compile(source, f"{name}.py", "exec"), names)
            plt.close("all")
    printed = capsys.readouterr().out
    for words in SAYS[name]:
        assert words in printed
