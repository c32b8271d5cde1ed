"""From the command line to a scene: a scene file with overrides, or a mesh file described by options."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from kshell.errors import InputError, clipped

if TYPE_CHECKING:
    from kshell.scene.scene import Scene


def is_scene(source: Path) -> bool:
    """Whether a path names a scene file."""
    return source.suffix.lower() == ".toml"


def no_overrides(source: Path, overrides: Sequence[str]) -> None:
    """Refuse --set on a mesh file."""
    if overrides:
        raise InputError(
            f"--set {clipped(overrides[0])}: {source} is a mesh, --set changes the values of a scene file"
        )


def scene_of(source: Path, plate: dict[str, Any], overrides: Sequence[str]) -> Scene:
    """The scene of a file and the options that describe it."""
    from kshell.scene.scene import Scene

    given = {key: value for key, value in plate.items() if value not in (None, [])}
    if is_scene(source):
        if given:
            option = next(iter(given)).replace("_", "-")
            raise InputError(
                f"--{option} describes the plate or shell of a mesh file, but {source} is a scene file: use --set, "
                "for example --set thickness=0.02"
            )
        _require_once(overrides)
        return Scene.load(source, overrides)
    no_overrides(source, overrides)
    return _scene_of_options(source, given)


def _require_once(overrides: Sequence[str]) -> None:
    """Refuse two values for one key, of which the last would win without a word."""
    seen: dict[str, str] = {}
    for override in overrides:
        key = override.partition("=")[0].strip()
        if key in seen:
            raise InputError(
                f"--set {clipped(override)}: {key} is given twice, before with {clipped(seen[key])}: leave one out"
            )
        seen[key] = override


def _scene_of_options(mesh: Path, given: dict[str, Any]) -> Scene:
    from kshell.material.materials import Isotropic
    from kshell.scene.loads import Pressure
    from kshell.scene.scene import Scene
    from kshell.scene.supports import Clamped, SimplySupported, Symmetry

    missing = [f"--{key}" for key in ("thickness", "E", "nu") if key not in given]
    if missing:
        raise InputError(
            f"{', '.join(missing)} missing: a mesh file needs --thickness, --E and --nu, a scene file not"
        )
    kinds = {"clamped": Clamped, "supported": SimplySupported, "symmetry": Symmetry}
    supports = [kind(name) for key, kind in kinds.items() for name in given.get(key, [])]
    loads = [Pressure(_number_or_text(given["pressure"]))] if "pressure" in given else []
    return Scene(
        mesh=mesh,
        thickness=_number_or_text(given["thickness"]),
        material=Isotropic(E=given["E"], nu=given["nu"], density=given.get("density", 0.0)),
        supports=supports,
        loads=loads,
        mesh_size=given.get("mesh_size"),
        mesh_order=given.get("mesh_order", "auto"),
        facets=given.get("facets", "auto"),
        crease=given.get("crease", 30.0),
        geometry=given.get("geometry"),
        title=mesh.name,
    )


def _number_or_text(text: str) -> float | str:
    try:
        return float(text)
    except ValueError:
        return text


def number(text: str | None) -> int | str | None:
    """A whole number, or the text itself."""
    return int(text) if text is not None and text.isascii() and text.isdigit() and len(text) < 10 else text


def flag(text: str | None) -> bool | str | None:
    """true and false as such, other text as it is."""
    return {"true": True, "false": False}.get(text, text) if text is not None else None


def parameters_of(settings: Sequence[str]) -> dict[str, list[Any]]:
    """Values of a sweep from "key=a..b:n" (n values from a to b) and "key=a,b,c".

    Raises
    ------
    InputError
        If one is neither, or a key is given twice.
    """
    from kshell.scene.toml import value_of

    out: dict[str, list[Any]] = {}
    for setting in settings:
        key, equals, text = setting.partition("=")
        key, text = key.strip(), text.strip()
        if not equals or not all(key.split(".")) or not text:
            raise InputError(
                f'--set {setting}: write KEY=A..B:N or KEY=A,B, such as "thickness=0.008..0.016:5"'
            )
        if key in out:
            raise InputError(f"--set {setting}: {key} is given twice: give all its values at once")
        if ".." in text and not text.startswith(('"', "'", "[")):
            out[key] = _evenly(setting, text)
            continue
        listed = value_of(f"[{text}]")
        out[key] = listed if isinstance(listed, list) else [value_of(part) for part in text.split(",")]
    return out


def _evenly(setting: str, text: str) -> list[float]:
    ends, _, count = text.partition(":")
    first, _, last = ends.partition("..")
    try:
        a, b, n = float(first), float(last), int(count)
    except ValueError:
        a, b, n = 0.0, float("inf"), 0
    if not (abs(a) < float("inf") and abs(b) < float("inf") and n >= 2):
        raise InputError(
            f"--set {setting}: write A..B:N with two numbers and how many, at least 2, such as 0.008..0.016:5"
        )
    return [a + (b - a) * k / (n - 1) for k in range(n)]
