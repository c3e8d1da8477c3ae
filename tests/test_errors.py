import pytest

from bezstab.errors import unknown_name


@pytest.mark.parametrize("name", ["Alpah", "ALPHA", "alpha\n", "alp"])
def test_an_unknown_name_suggests_the_nearest_in_one_line(name: str) -> None:
    message = str(unknown_name("letter", name, ["Alpha", "Omega"]))
    assert message.startswith(f"unknown letter {name!r}: did you mean Alpha? (names: Alpha, Omega; ")
    assert len(message.splitlines()) == 1


def test_what_is_no_misspelt_name_gets_no_suggestion() -> None:
    message = str(unknown_name("letter", "B4", ["Alpha", "Omega"]))
    assert message == "unknown letter 'B4' (names: Alpha, Omega; or a .toml file)"
