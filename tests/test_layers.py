"""The arrows between the files of kshell, beside the contracts between its rooms in pyproject.toml."""

import ast
import re
import subprocess
import sys
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
DOORS = "kshell.result.doors"  # the one file whose imports climb
HEAVY = {"numpy", "scipy", "skfem", "meshio", "pyamg", "gmsh", "matplotlib", "pydantic", "sympy", "pyvista"}

HELP = """
import sys
from kshell.cli.commands import run
run(["--help"])
print(*sys.modules)
"""


def module_files() -> dict[str, Path]:
    """Dotted name of every module of kshell: its file."""
    files = {}
    for path in sorted((ROOT / "kshell").rglob("*.py")):
        parts = path.relative_to(ROOT).with_suffix("").parts
        files[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = path
    return files


def imported(tree: ast.AST, names: set[str]) -> set[str]:
    """The modules among `names` that a file imports, inside functions too, but not for types alone."""
    found: set[str] = set()
    for node in ast.iter_child_nodes(tree):
        if not isinstance(node, ast.stmt | ast.ExceptHandler | ast.match_case):
            continue  # in expressions there are no imports
        if isinstance(node, ast.If) and "TYPE_CHECKING" in ast.unparse(node.test):
            continue
        if isinstance(node, ast.ImportFrom):
            assert node.level == 0, "kshell writes its imports out in full"
            submodules = {f"{node.module}.{alias.name}" for alias in node.names}
            found |= submodules & names
            if submodules - names:
                found |= {str(node.module)} & names
        elif isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names} & names
        found |= imported(node, names)
    return found


def test_no_circle_among_files() -> None:
    files = module_files()
    arrows = {
        name: imported(ast.parse(path.read_text(encoding="utf-8")), set(files)) - {name}
        for name, path in files.items()
    }
    assert arrows["kshell.result.kept"] > {DOORS}
    assert arrows[DOORS] == {"kshell.draw.plot", "kshell.draw.view", "kshell.report.page"}
    arrows[DOORS] = set()
    try:
        TopologicalSorter(arrows).prepare()
    except CycleError as error:
        pytest.fail("imported by: " + " -> ".join(error.args[1]))


@pytest.mark.parametrize("program", ["import sys, kshell\nprint(*sys.modules)", HELP], ids=["import", "help"])
def test_nothing_heavy_is_imported_before_it_is_needed(program: str) -> None:
    done = subprocess.run(
        [sys.executable, "-c", program], cwd=ROOT, capture_output=True, text=True, check=True
    )
    modules = set(done.stdout.splitlines()[-1].split())
    assert "kshell" in modules
    assert not modules & HEAVY


def test_few_files_lie_outside_of_the_rooms() -> None:
    assert len([path for path in (ROOT / "kshell").iterdir() if path.is_file()]) <= 8


def test_architecture_names_what_is_there() -> None:
    text = (ROOT / "ARCHITECTURE.md").read_text(encoding="utf-8")
    named = set(re.findall(r"`((?:kshell|tests|verification)/[^`]*)`", text))
    assert [path for path in sorted(named) if not (ROOT / path).exists()] == []
    rooms = {path.parent.name for path in (ROOT / "kshell").glob("*/__init__.py")}
    assert rooms == {path.split("/")[1] for path in named if re.fullmatch(r"kshell/[a-z]+/", path)}
