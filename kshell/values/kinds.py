"""How values are written in scene files, as JSON schemas: for editors, `kshell explain` and the reference of all keys.

The checks stand beside the types that use these (`kshell.scene.places`, `kshell.scene.options`, ...). The formats
"expression" and "group" are words for people: nothing checks them by these schemas.
"""

from __future__ import annotations

from typing import Any

Schema = dict[str, Any]

NUMBER: Schema = {"type": "number"}
POSITIVE: Schema = {"type": "number", "exclusiveMinimum": 0}
COUNT: Schema = {"type": "integer", "minimum": 1}
TEXT: Schema = {"type": "string"}
EXPRESSION: Schema = {"type": "string", "format": "expression"}
GROUP: Schema = {"type": "string", "format": "group"}
PATH: Schema = {"type": "string", "format": "path"}
AUTO: Schema = {"const": "auto"}


def either(*schemas: Schema) -> Schema:
    """One of several."""
    return {"anyOf": list(schemas)}


def listed(item: Schema, least: int = 1, most: int | None = None) -> Schema:
    """A list of `least` to `most` items."""
    return {"type": "array", "items": item, "minItems": least, **({} if most is None else {"maxItems": most})}


def table(**keys: Schema) -> Schema:
    """A table that has exactly these keys."""
    return {"type": "object", "properties": keys, "required": list(keys), "additionalProperties": False}


def by_group(schema: Schema) -> Schema:
    """A value, or a table of surface group to value."""
    parts = schema.get("anyOf", [schema])
    return either(*parts, {"type": "object", "additionalProperties": either(*parts), "minProperties": 1})


def matrix(size: int) -> Schema:
    """Rows and columns."""
    return listed(listed(NUMBER, size, size), size, size)


FROM_FILE: Schema = {
    "type": "object",
    "properties": {"file": PATH, "field": TEXT, "within": POSITIVE},
    "required": ["file"],
    "additionalProperties": False,
}
SCALAR = either(NUMBER, EXPRESSION)
SCALAR_OR_FILE = either(NUMBER, EXPRESSION, FROM_FILE)
VECTOR = listed(SCALAR, 3, 3)
CENTRE = listed(SCALAR, 2, 3)
POINT = listed(NUMBER, 2, 3)
DIRECTION = listed(NUMBER, 2, 3)
GROUPS = either(GROUP, listed(GROUP))
PLACE = either(GROUP, listed(GROUP), POINT)


def words(schema: Schema) -> str:
    """The kind of a value for people: "number or expression", "list of 3 numbers"."""
    if "anyOf" in schema:
        parts = list(dict.fromkeys(words(part) for part in schema["anyOf"] if part.get("type") != "null"))
        return parts[0] if len(parts) == 1 else f"{', '.join(parts[:-1])} or {parts[-1]}"
    if "const" in schema:
        return _value(schema["const"])
    if "enum" in schema:
        return words({"anyOf": [{"const": value} for value in schema["enum"]]})
    match schema.get("type"):
        case "array":
            least, most = schema.get("minItems", 0), schema.get("maxItems")
            count = "" if most is None else f"{least} " if least == most else f"{least} to {most} "
            inner = schema.get("items", {})
            plural = (
                f"lists{words(inner).removeprefix('list')}"
                if inner.get("type") == "array"
                else _plural(inner)
            )
            return f"list of {count}{plural}"
        case "object":
            keys = ", ".join(schema.get("properties", {}))
            return f"table of {keys}" if keys else "table of names and values"
        case "string":
            return {"expression": "expression", "group": "group name", "path": "path"}.get(
                schema.get("format", ""), "text"
            )
        case "integer":
            return "whole number"
        case "boolean":
            return "true or false"
        case kind:
            return str(kind or "value")


def _plural(schema: Schema) -> str:
    parts = [words(part) for part in schema["anyOf"]] if "anyOf" in schema else [words(schema)]
    return " or ".join(part if part == "text" else f"{part}s" for part in parts)


def _value(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    return f'"{value}"' if isinstance(value, str) else str(value)
