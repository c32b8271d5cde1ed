"""From what a user types to keys of a scene file: "load.line_force", "support.kind", "--set load.0.value"."""

from __future__ import annotations

from kshell.errors import InputError, clipped
from kshell.mesh.words import nearest_name
from kshell.scene.keys import Block, Key, blocks
from kshell.values.naming import listing

Found = list[tuple[Block, Key | None]]


def names() -> list[str]:
    """All that can be looked up, dotted."""
    out: dict[str, None] = {}
    for name, block in blocks().items():
        parts = name.split(".") if name else []
        for length in range(1, len(parts) + 1):
            out[".".join(parts[:length])] = None
        for key in block.keys:
            out[".".join([*parts[:1], key.name])] = None
            out[".".join([*parts, key.name])] = None
    return list(out)


def find(asked: str) -> Found:
    """The blocks, or the keys of blocks, of a dotted name; numbers of lists and names of groups may stand in it.

    Raises
    ------
    InputError
        If there is none, with those that are near.
    """
    parts = [part for part in asked.strip().strip("[]").split(".") if not part.isdigit()]
    if parts[:1] == ["group"] and len(parts) > 2 and blocks()["group"].key(parts[1]) is None:
        del parts[1]  # the name of a group
    if parts[:1] == ["group"] and len(parts) > 2:
        del parts[0]
    if parts[1:] == ["kind"]:  # which are all of them
        parts = parts[:1]
    found = _blocks_named(parts) or _keys_named(parts)
    if not found:
        raise InputError(f'no key "{clipped(asked)}" in scene files: {_near(".".join(parts))}')
    return found


def _blocks_named(parts: list[str]) -> Found:
    name = ".".join(parts)
    return [(b, None) for key, b in blocks().items() if name and (key == name or key.startswith(f"{name}."))]


def _keys_named(parts: list[str]) -> Found:
    if not parts:
        return []
    above, last = ".".join(parts[:-1]), parts[-1]
    candidates = [
        b for name, b in blocks().items() if name == above or (above and name.startswith(f"{above}."))
    ]
    return [(block, key) for block in candidates if (key := block.key(last)) is not None]


def _near(name: str) -> str:
    known, last = names(), name.rpartition(".")[2]
    same = [other for other in known if last and other.rpartition(".")[2] == last]
    if not same:
        ends = {other.rpartition(".")[2] for other in known}
        near = nearest_name(last, sorted(ends), cutoff=0.65)
        same = [other for other in known if other.rpartition(".")[2] == near]
        whole = nearest_name(name, known, cutoff=0.65)
        same = list(dict.fromkeys([] if whole is None else [whole, *same])) or same
    if same:
        return f"did you mean {listing(same[:6])}?"
    top = [other for other in known if "." not in other]
    return f"there are {listing(top, most=40)}; kshell explain lists them"
