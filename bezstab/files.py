"""Input files that are read or refused in one line; output files that are written whole or not at all."""

import io
import os
import tempfile
import tomllib
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any, BinaryIO, TypeVar

from bezstab.errors import InputError

Parsed = TypeVar("Parsed")


def read_toml(kind: str, path: Path, parse: Callable[[dict[str, Any]], Parsed]) -> Parsed:
    """Return what `parse` makes of a TOML file's data.

    InputError, in one line with the kind and the path in front, for whatever the system, TOML or `parse` refuses.
    """
    try:
        return parse(tomllib.loads(path.read_bytes().decode("utf-8-sig")))  # some editors begin with a mark of UTF-8
    except RecursionError:
        raise InputError(f"{kind} {path}: brackets nested too deeply") from None
    except (OSError, ValueError) as error:  # InputError and what tomllib raises are ValueErrors
        reason = error.strerror if isinstance(error, OSError) else error
        raise InputError(" ".join(f"{kind} {path}: {reason}".split())) from None


def output_directory(path: Path) -> Path:
    """Return `path`, created if need be; InputError where no file can be made in it."""
    try:
        path.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=path):
            return path
    except OSError as error:
        raise InputError(f"cannot write into {path}: {error.strerror}") from None


def write_whole(path: Path, write: Callable[[BinaryIO], object]) -> None:
    """Put what `write` writes into a temporary neighbour of `path`, which then takes its name in one stroke.

    Whatever interrupts that, `path` keeps what it held before, and no neighbour stays. InputError where the system
    refuses: no such directory, no space, no permission.
    """
    # First into memory: on a full disk those who write in pieces (zip archives, figures) complain again and again,
    # even when they are collected. So the system is asked for one plain write, all that can fail for its reasons.
    content = io.BytesIO()
    write(content)
    temporary = path.with_name(f".{path.name}.{os.urandom(4).hex()}")
    try:
        with temporary.open("xb") as file:
            file.write(content.getbuffer())
        temporary.replace(path)
    except OSError as error:
        raise InputError(f"cannot write {path}: {error.strerror}") from None
    finally:
        with suppress(OSError):  # as where its directory has become a file
            temporary.unlink()
