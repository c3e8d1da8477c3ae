import pytest

from bezstab.errors import InputError
from bezstab.show import ROW_KINDS, json_schema
from bezstab.show.schemas import DIALECT


def test_a_schema_describes_every_key_and_allows_no_other() -> None:
    schema = json_schema("check")
    assert schema["$schema"] == DIALECT
    row = schema["items"]["anyOf"][0]
    assert row["additionalProperties"] is False
    assert row["properties"]["h_limit"]["type"] == ["number", "null"]
    assert ", in s;" in row["properties"]["h_limit"]["description"]
    assert row["properties"]["safe"]["type"] == "boolean"
    assert row["properties"]["verdict"]["enum"] == ["converges", "marginal", "diverges"]
    assert "kappa" in row["properties"]  # with --scene only
    assert "kappa" not in row["required"]


def test_a_command_with_several_kinds_of_rows_has_each() -> None:
    assert [kind["title"] for kind in json_schema("verify")["items"]["anyOf"]] == [
        kind.title for kind in ROW_KINDS["verify"]
    ]


def test_an_unknown_command_is_refused() -> None:
    with pytest.raises(InputError, match="'explore' prints no rows: expected one of poles"):
        json_schema("explore")
