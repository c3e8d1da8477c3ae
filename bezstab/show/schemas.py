"""The rows that each command prints, as a JSON Schema."""

from collections.abc import Mapping
from typing import Any

from bezstab.show.fields import Field, Kind, RowKind
from bezstab.show.row_kinds import ROW_KINDS

DIALECT = "https://json-schema.org/draft/2020-12/schema"

JSON_TYPES: Mapping[Kind, Mapping[str, Any]] = {
    "number": {"type": "number"},
    "integer": {"type": "integer"},
    "text": {"type": "string"},
    "truth": {"type": "boolean"},
    "numbers": {"type": "array", "items": {"type": "number"}},
    "text rows": {"type": "array", "items": {"type": "array", "items": {"type": "string"}}},
}


def json_schema(command: str) -> dict[str, Any]:
    """Return the JSON Schema of what a command of ROW_KINDS prints as JSON: a list of rows, every key described."""
    kinds = [_row_schema(kind) for kind in ROW_KINDS[command]]
    return {
        "$schema": DIALECT,
        "title": f"bezstab {command} --format json",
        "type": "array",
        "items": kinds[0] if len(kinds) == 1 else {"anyOf": kinds},
    }


def _row_schema(kind: RowKind) -> dict[str, Any]:
    """Return the schema of one kind of row: no key but its own, and those that it always has."""
    return {
        "title": kind.title,
        "type": "object",
        "properties": {
            field.key: _value_schema(field, field.key in kind.sometimes) for field in (*kind.fields, *kind.added)
        },
        "required": [field.key for field in kind.fields],
        "additionalProperties": False,
    }


def _value_schema(field: Field, sometimes: bool) -> dict[str, Any]:
    """Return the schema of one value, which is null where the key says so, or `sometimes`."""
    schema: dict[str, Any] = {"description": field.description, **JSON_TYPES[field.kind]}
    may_be_null = bool(field.null) or sometimes
    if values := field.values:
        schema["enum"] = [*values, *([None] if may_be_null else [])]
    if may_be_null:
        schema["type"] = [schema["type"], "null"]
    return schema
