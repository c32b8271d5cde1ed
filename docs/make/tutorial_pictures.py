"""Draw the pictures of the tutorials anew: `python -m docs.make.tutorial_pictures`."""

from __future__ import annotations

import sys
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from PIL import Image

import kshell as ks
from kshell.cli.commands import run

TUTORIALS = Path(__file__).parents[1] / "tutorials"
DOTS = 75  # per inch
COLOURS = 128  # a third of the bytes


def started(kind: str, folder: str) -> ks.Scene:
    """What `kshell new` writes."""
    if run(["new", kind, "-o", f"{folder}/{kind}"]):
        sys.exit(1)
    return ks.Scene.load(Path(folder) / kind / f"{kind}.toml")


def column() -> Any:
    """The path of the buckling column."""
    thickness, force = 0.005, 21_614.0
    mesh = ks.geometry.Plane().mesh(20, 2, 1, ("foot", "head", "side", "other side"), (0, 1), (0, 0.1))
    scene = ks.Scene(
        title="Column, 1 mm off in its middle",
        mesh=mesh,
        thickness=thickness,
        material=ks.Isotropic(E=210e9, nu=0.3),
        supports=[ks.Fixed("foot", "xyz"), ks.Fixed("head", "yz")],
        loads=[ks.LineForce("head", (-1.1 * force, 0, 0))],
        imperfection=ks.Imperfection(amplitude=0.001),
        probes={"middle": (0.5, 0.05, 0)},
    )
    return ks.trace(scene)


def main() -> None:
    """All of them."""
    with TemporaryDirectory() as folder:
        pictures = {
            "plate": (ks.solve(started("plate", folder)), "deflection"),
            "tank": (ks.solve(started("tank", folder)), "von_mises_bottom"),
            "roof": (ks.solve(started("roof", folder)), "deflection"),
            "panel": (ks.solve(ks.Scene.load(TUTORIALS / "panel" / "panel.toml")), "von_mises_top"),
            "column": (column(), "load_deflection"),
        }
    for name, (result, what) in pictures.items():
        path = TUTORIALS / f"{name}.png"
        result.plot(what).savefig(path, dpi=DOTS)
        Image.open(path).convert("RGB").quantize(COLOURS).save(path, optimize=True)
        print(f"written: {path}")


if __name__ == "__main__":
    main()
