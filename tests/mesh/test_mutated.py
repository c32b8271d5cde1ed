"""A mesh that is damaged arrives whole or is refused: never with another area or other groups, never with a traceback.

Each file is changed in a few bytes, words or lines by a seeded generator: it is read or refused in words, whatever it
holds. Files of formats that announce how many nodes and cells they hold are cut off or lose a line: what is still read
has the area of the whole, and each group its length or area.
"""

from __future__ import annotations

import random
import re

import meshio
import numpy as np
import pytest

from kshell.errors import InputError
from kshell.mesh import check, read_mesh
from tests.mesh.mesh_samples import square, write_with_gmsh
from tests.mesh.test_abaqus import PLATE, SETS
from tests.mesh.test_formats import MDPA, OBJ, POINTS, SU2, TRIANGLES, stl, unv
from tests.mesh.test_nastran import SAME as DECKS

SEEDS = 60  # mutations of each file
WORDS = (
    b"nan",
    b"inf",
    b"-1",
    b"0",
    b"1e400",
    b"1,5",
    b"999999999999",
    b"18446744073709551616",
    b"abc",
    b"2147483648",
)


def gmsh_file(version, binary=False):
    def make(path):
        write_with_gmsh(path, version, binary, 1, False)
        return path.read_bytes()

    return make


def through_meshio(path):
    mesh = square(3)
    half = np.repeat([1, 2], 9)
    meshio.write(
        path, meshio.Mesh(mesh.points, [("triangle", mesh.triangles)], cell_data={"medit:ref": [half]})
    )
    return path.read_bytes()


def text(content):
    return lambda path: content.encode()


FILES = {
    "two.msh": gmsh_file(2.2),
    "four.msh": gmsh_file(4.1),
    "binary.msh": gmsh_file(4.1, True),
    "one.msh": gmsh_file(1.0),
    "plate.inp": text(PLATE + SETS),
    "plate.bdf": text(DECKS["small fields"]),
    "free.bdf": text(DECKS["free fields"]),
    "plate.obj": text(OBJ["v//vn"]),
    "plate.stl": text(stl(("A", TRIANGLES[:2]), ("B", TRIANGLES[2:]))),
    "plate.su2": text(SU2),
    "plate.unv": text(unv(POINTS, [(91, [k + 1 for k in cell]) for cell in TRIANGLES], [("A", 8, [1])])),
    "plate.mdpa": text(MDPA),
    "plate.med": gmsh_file(4.1),
    "plate.mesh": through_meshio,
    "plate.vtu": through_meshio,
}  # fmt: skip


def mutated(rng: random.Random, data: bytes) -> bytes:
    """Some bytes, words or lines changed."""
    for _ in range(rng.choice((1, 1, 2, 3))):
        if not data:
            return data
        lines = data.split(b"\n")
        at = rng.randrange(len(lines))
        what = rng.choice(("cut", "byte", "drop", "word", "word", "line", "twice", "swap"))
        if what == "cut":
            data = data[: rng.randrange(len(data))]
        elif what == "byte":
            k = rng.randrange(len(data))
            data = data[:k] + bytes([rng.randrange(256)]) + data[k + 1 :]
        elif what == "drop":
            k = rng.randrange(len(data))
            data = data[:k] + data[k + rng.choice((1, 4, 8, 100)) :]
        elif what == "word":
            found = rng.choice(list(re.finditer(rb"\S+", data)) or [None])
            if found is not None:
                data = data[: found.start()] + rng.choice(WORDS) + data[found.end() :]
        elif what == "line":
            data = b"\n".join(lines[:at] + lines[at + 1 :])
        elif what == "twice":
            data = b"\n".join([*lines[:at], lines[at], *lines[at:]])
        else:
            other = rng.randrange(len(lines))
            lines[at], lines[other] = lines[other], lines[at]
            data = b"\n".join(lines)
    return data


@pytest.mark.parametrize("name", FILES)
def test_damaged_files_are_refused_in_words_or_read(tmp_path, name):
    path = tmp_path / name
    whole = FILES[name](path)
    path.write_bytes(whole)
    good = read_mesh(path)
    refused = 0
    for seed in range(SEEDS):
        data = mutated(random.Random(f"{name} {seed}"), whole)
        path.write_bytes(data)
        try:
            mesh = read_mesh(path)
        except InputError:
            refused += 1
            continue
        assert np.isfinite(mesh.points).all()
        assert mesh.triangles.max() < len(mesh.points)
    path.write_bytes(whole)
    assert read_mesh(path).areas.sum() == good.areas.sum()
    assert refused > SEEDS // 10


def cut_or_counts(rng: random.Random, data: bytes) -> bytes:
    """A file cut off, or with a line of numbers left out: what it announces no longer agrees with what it holds."""
    lines = data.split(b"\n")
    if rng.random() < 0.5:
        return b"\n".join(lines[: rng.randrange(1, len(lines) - 1)])
    numbers = [
        k for k, line in enumerate(lines) if re.fullmatch(rb"\s*[-+0-9.eED]+(\s+[-+0-9.eED]+)+\s*", line)
    ]
    lost = rng.choice(numbers)
    return b"\n".join(lines[:lost] + lines[lost + 1 :])


# formats that announce what they hold
ANNOUNCED = ("two.msh", "four.msh", "one.msh", "plate.su2", "plate.unv", "plate.mesh")


@pytest.mark.parametrize("name", ANNOUNCED)
def test_area_and_groups_stay_or_the_file_is_refused(tmp_path, name):
    path = tmp_path / name
    whole = FILES[name](path)
    path.write_bytes(whole)
    good = {group.name: group.measure for group in check.summary(read_mesh(path)).groups}
    area = read_mesh(path).areas.sum()
    for seed in range(SEEDS):
        path.write_bytes(cut_or_counts(random.Random(f"{name} {seed}"), whole))
        try:
            mesh = read_mesh(path)
        except InputError:
            continue
        found = check.summary(mesh)
        assert mesh.areas.sum() == pytest.approx(area), seed
        for group in found.groups:
            if not mesh.groups[group.name].lost:
                assert group.measure == pytest.approx(good[group.name]), seed
