"""What a geometry file may do besides describing a geometry: gmsh's language runs programs and writes files.

A file is looked through before gmsh opens it, with all files it includes or merges and the options files that gmsh
reads beside each of them (`name.opt`). Words are found as gmsh's own scanner finds them: comments from // and between
/* and */, strings between two equal quotes without escapes.

Source: gmsh reference manual, "General scripting commands"; grammar Gmsh.y and scanner Gmsh.l of gmsh 4.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

from kshell.errors import InputError

# statements, and what is wrong with them
FORBIDDEN = {
    r"(?<![\w.])(System|SystemCall|NonBlockingSystemCall)\b(?!\s*[=.;~({\[])": "runs a command of the system",
    r"(?<![\w.])OnelabRun\b": "runs a program",
    r"(?<![\w.])StringToName\b": "makes up words that cannot be looked at",
    r"(?<![\w.])(Print|Save)\b(?!\s*[=.;~({\[])": "writes a file",
    r"(?<![\w.])CreateDir\b": "makes a folder",
    r"(?<![\w.])(Printf|Error|Warning)\b[^;]*\)\s*>": "writes into a file",
    r"(?<![\w.])Exit\b": "ends the program",
    r"(?<![\w.])ExternalProcess\b": "runs a program",
    r"\.\s*CommandLine\b": "runs a program",
    r"(?<![\w.])Plugin\s*\([^)]*\)\s*\.\s*\w*[fF]ile\w*\s*=": "writes a file",
    r"(?<![\w.])General\s*\.\s*(\w*FileName|SaveSession|SaveOptions)\s*=": "writes a file",
    r"(?<![\w.])Solver\s*\.": "sets up programs to run",
}
_FORBIDDEN = [(re.compile(pattern), why) for pattern, why in FORBIDDEN.items()]
_OPENS = re.compile(r"(?<![\w.])(Include|Merge|MergeWithBoundingBox)\b(?!\s*[=.~])([^;]*)")
# names of files as they are written: "name", or this folder and "name"
_HERE = re.compile(
    r"^\s*(?:Str\w*\s*[\(\[]\s*)?(?:Current(?:Directory|Dir)\s*,\s*)?\x01(\d+)\x01\s*[\)\]]?\s*$|"
    r"^\s*AbsolutePath\s*[\(\[]\s*\x01(\d+)\x01\s*[\)\]]\s*$"
)
_STRING = re.compile(r"//[^\n]*|/\*.*?(?:\*/|\Z)|\"[^\"]*(?:\"|\Z)|'[^']*(?:'|\Z)", re.DOTALL)

# files that hold geometry or a mesh and are not read as scripts
DATA = (
    ".step", ".stp", ".brep", ".brp", ".rle", ".iges", ".igs", ".xao", ".sat", ".stl", ".unv", ".vtk", ".mesh", ".off",
    ".obj", ".med", ".mmed", ".bdf", ".nas", ".ply", ".ply2", ".cgns", ".wrl", ".p3d",
)  # fmt: skip
PROGRAMS = (".py", ".m", ".exe", ".gz", ".pro")


def require_harmless(path: Path) -> None:
    """Raise if a geometry file, or one that it opens, runs programs or writes files.

    Raises
    ------
    InputError
        The message names the file, the line and the word.
    """
    for file in _files(path, set()):
        _look_through(file)


def _files(path: Path, seen: set[Path]) -> Iterator[Path]:
    """The scripts that gmsh reads when it opens a file."""
    here = path.resolve()
    if here in seen or not here.is_file():  # of a file that is missing gmsh itself says so
        return
    seen.add(here)
    suffix = here.suffix.lower()
    if suffix in PROGRAMS:
        raise InputError(f"{path.name}: {_unasked('is opened by gmsh as a program')}")
    if suffix not in DATA and not _is_mesh(here):
        yield here
        code, strings = _scanned(here)
        for match in _OPENS.finditer(code):
            name = _HERE.match(match[2])
            if name is None:
                raise InputError(
                    f"{_place(here, code, match.start())}: {match[1]} of a file whose name is made up on the way. "
                    f"{_unasked('cannot be looked at')}"
                )
            yield from _files(here.parent / strings[int(name[1] or name[2])], seen)
    yield from _files(here.with_name(here.name + ".opt"), seen)


def _is_mesh(path: Path) -> bool:
    with path.open("rb") as file:
        start = file.read(11)
    return start.startswith(
        (b"$MeshFormat", b"$NOD", b"$Comments", b"$PARA", b"$PTS", b"$ELM", b"$View", b"$PostFormat")
    )


def _scanned(path: Path) -> tuple[str, list[str]]:
    """The words of a script, with each string replaced by its number, and the strings."""
    strings: list[str] = []

    def short(match: re.Match[str]) -> str:
        text = match[0]
        if text[0] == "/":
            return "\n" * text.count("\n") or " "
        strings.append(text.strip(text[0]))
        return f" \x01{len(strings) - 1}\x01 " + "\n" * text.count("\n")

    return _STRING.sub(short, path.read_text(encoding="latin-1").replace("\x01", " ")), strings


def _look_through(path: Path) -> None:
    code, _ = _scanned(path)
    for pattern, why in _FORBIDDEN:
        match = pattern.search(code)
        if match:
            word = match[0].split()[0].partition("(")[0].strip(". ")
            raise InputError(
                f"{_place(path, code, match.start())}: {word} {why}. {_unasked('may not do that unasked')}"
            )


def _place(path: Path, code: str, at: int) -> str:
    return f"{path.name}, line {code.count(chr(10), 0, at) + 1}"


def _unasked(what: str) -> str:
    return (
        f"A geometry file {what}: look into it, and allow it by --allow-system (in Python allow_system=True) if it is "
        "to be trusted, or mesh it in gmsh and give the .msh"
    )
