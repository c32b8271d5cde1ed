"""What commands load: imports take most of the time of a small solve, so those that are not needed stay out."""

import subprocess
import sys
from pathlib import Path

import pytest

MESHES = Path(__file__).parents[2] / "meshes"

# read and drawn with, or asked for by other analyses
NEVER = {
    "gmsh",
    "h5py",
    "ipctk",
    "jinja2",
    "joblib",
    "matplotlib",
    "meshio",
    "pint",
    "psutil",
    "pyamg",
    "pyvista",
    "skfem",
    "sympy",
}
if sys.platform != "linux":  # elsewhere it is what tells the memory there is
    NEVER -= {"psutil"}
# parts of scipy that take long to load
SCIPY = {
    f"scipy.{name}"
    for name in ("integrate", "interpolate", "optimize", "spatial", "sparse.csgraph", "special")
}
OWN = {"kshell.draw", "kshell.report", "kshell.verify"}
LARGE = {"kshell.equilibrium.problem", "kshell.analysis.path"}
PLATE, SHELL = {"kshell.plate.model"}, {"kshell.shell.model"}

CASES = {
    # with round edges, whose doubt is told by splines
    "solve a plate": (["solve", "plate.toml", "-o", "OUT"], NEVER | SCIPY | OWN | SHELL | LARGE),
    "check a plate": (["check", "plate.toml"], NEVER | SCIPY | OWN | SHELL | {"scipy.linalg"}),
    "solve a shell": (["solve", "scordelis_lo.toml", "-o", "OUT"], NEVER | SCIPY | OWN),
    "check a shell": (["check", "scordelis_lo.toml"], NEVER | SCIPY | OWN | PLATE | {"scipy.linalg"}),
}


@pytest.mark.parametrize("name", CASES)
def test_what_commands_do_not_load(name, tmp_path):
    arguments, unwanted = CASES[name]
    arguments = [
        str(MESHES / part) if part.endswith(".toml") else str(tmp_path) if part == "OUT" else part
        for part in arguments
    ]
    program = (
        "import sys\nfrom kshell.cli.commands import run\n"
        f"code = run({arguments!r})\nprint('LOADED', *sys.modules)\nsys.exit(code)"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    loaded = set(done.stdout.rpartition("LOADED")[2].split())
    assert "kshell.scene.scene" in loaded
    assert not loaded & unwanted
