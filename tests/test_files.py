from pathlib import Path
from typing import Any, BinaryIO

import pytest

from bezstab.errors import InputError
from bezstab.files import read_toml, write_whole


@pytest.mark.parametrize("error", [RuntimeError, KeyboardInterrupt])
def test_an_interruption_leaves_what_was_there(tmp_path: Path, error: type[BaseException]) -> None:
    (path := tmp_path / "a.bin").write_bytes(b"old")

    def half(file: BinaryIO) -> None:
        file.write(b"ne")
        raise error

    with pytest.raises(error):
        write_whole(path, half)
    assert [entry.read_bytes() for entry in tmp_path.iterdir()] == [b"old"]


def test_what_cannot_be_written_is_the_users_mistake(tmp_path: Path) -> None:
    (tmp_path / "taken").mkdir()
    for path in (tmp_path / "missing" / "a.bin", tmp_path / "taken"):
        with pytest.raises(InputError, match="cannot write"):
            write_whole(path, lambda file: file.write(b""))
    assert [entry.name for entry in tmp_path.iterdir()] == ["taken"]


def test_a_toml_file_is_parsed_and_named_when_refused(tmp_path: Path) -> None:
    (path := tmp_path / "a.toml").write_bytes(b"\xef\xbb\xbfb = 3\r\n")  # with the mark that some editors write
    assert read_toml("thing", path, lambda data: data["b"]) == 3

    def refuse(_data: dict[str, Any]) -> None:
        raise InputError("b is\nodd")

    with pytest.raises(InputError, match=f"^thing {path}: b is odd$"):
        read_toml("thing", path, refuse)
