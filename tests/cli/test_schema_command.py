"""What every command prints as JSON, held against its schema by a validator that is not ours."""

import json

import click
import pytest
from jsonschema import Draft202012Validator

from bezstab.cli import main
from bezstab.show import ROW_KINDS, json_schema
from tests.cli.examples import EXAMPLES, WITHOUT_ROWS, each_example, printed_rows
from tests.cli.running import run


def test_every_command_that_prints_rows_has_a_schema_and_an_example() -> None:
    names = set(main.list_commands(click.Context(main))) - WITHOUT_ROWS
    assert names == set(ROW_KINDS) == set(EXAMPLES)


@pytest.mark.parametrize("name", ROW_KINDS)
def test_a_schema_is_printed_and_is_one(name: str) -> None:
    result = run("schema", name)
    assert result.exit_code == 0
    schema = json.loads(result.stdout)
    assert schema == json_schema(name)
    Draft202012Validator.check_schema(schema)


@pytest.mark.promise(
    "Keys of JSON and CSV",
    computed=(
        "one vocabulary for all commands; every example is valid under its schema, by a validator that is not "
        "ours, every row with the same keys"
    ),
)
@pytest.mark.usefixtures("_few_extremes")
@pytest.mark.parametrize("example", each_example())
def test_an_example_is_valid_and_every_row_has_the_same_keys(example: str) -> None:
    rows = printed_rows(example)
    Draft202012Validator(json_schema(example.partition(" ")[0])).validate(rows)
    assert len(rows) >= 1
    assert len({tuple(row) for row in rows}) == 1


def test_the_validator_refuses_other_rows() -> None:
    (row,) = printed_rows("poles --method SYM --alpha 1 --beta 0.5")
    validator = Draft202012Validator(json_schema("poles"))
    assert validator.is_valid([row])
    assert not validator.is_valid([{**row, "z": 1}])  # a key that is not in the vocabulary
    assert not validator.is_valid([{**row, "z_abs": "0.5"}])  # a number that is a text
    assert not validator.is_valid([{key: value for key, value in row.items() if key != "safe"}])


def test_a_command_without_rows_has_no_schema() -> None:
    result = run("schema", "explore")
    assert result.exit_code == 2
    assert "explore" in result.stderr
