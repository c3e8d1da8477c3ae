"""Where finished chunks are kept: a directory beside the result, locked while a run works in it."""

import os
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

import numpy as np
from numpy.typing import NDArray

from bezstab.errors import InputError
from bezstab.files import output_directory, write_whole

if sys.platform == "win32":
    import msvcrt
else:
    import fcntl

Arrays = Mapping[str, NDArray[np.generic]]

JOB = "job.txt"
LOCK = "lock.txt"
SEAL = "number of the chunk"
"""The name of the last array in a chunk's file: no array of a result is called so, and a damaged file may lack it."""


@dataclass(frozen=True)
class ChunkStore:
    """A directory that keeps the finished chunks of one job, each in a file called by its number."""

    path: Path

    def file(self, number: int) -> Path:
        """Return where a chunk is kept."""
        return self.path / f"{number}.npz"

    def load(self, number: int) -> Arrays | None:
        """Return a finished chunk; None if it has no file, or a damaged one. No object in it is ever unpickled."""
        try:
            # Opened here, for numpy forgets to close what turns out to be damaged.
            with self.file(number).open("rb") as file, np.load(file, allow_pickle=False) as archive:
                arrays = dict(archive)
            return arrays if arrays.pop(SEAL) == number else None
        except Exception:  # a damaged zip archive makes numpy raise nearly anything
            return None

    def save(self, number: int, arrays: Arrays) -> None:
        """Write one finished chunk; InputError if the system refuses."""
        sealed = {**arrays, SEAL: np.array(number)}
        write_whole(self.file(number), lambda file: np.savez(file, **sealed))  # type: ignore[arg-type]

    def discard(self) -> None:
        """Remove the directory: the job's result has been written. What cannot be removed does no harm."""
        _empty(self.path)
        with suppress(OSError):
            (self.path / LOCK).unlink()  # last: another run waits for it
            self.path.rmdir()


@contextmanager
def chunk_store(path: Path, job: str, resume: bool) -> Iterator[ChunkStore]:
    """Give the store of a job at `path`, empty unless `resume`, to this run alone.

    `job` is a text that says all on which the result depends; it is kept beside the chunks. InputError if what lies
    there is of another job, or if another run is at work there: that run is named. A run that is killed leaves no
    lock behind, for the system holds it as long as the process lives.
    """
    with _locked(path):
        description = path / JOB
        described = description.read_bytes() if description.is_file() else None
        if resume and described is not None and described != job.encode():
            raise InputError(
                f"--resume: {path} was left by a run with other options; without --resume it is overwritten"
            )
        if not resume or described is None:
            _empty(path)
        write_whole(description, lambda file: file.write(job.encode()))
        yield ChunkStore(path)


def _empty(directory: Path) -> None:
    """Remove all files but the lock from a directory, those too that a killed run had half written."""
    with suppress(OSError):
        for file in directory.iterdir():
            if file.name != LOCK:
                with suppress(OSError):
                    file.unlink()


@contextmanager
def _locked(directory: Path) -> Iterator[None]:
    """Hold the lock of a directory, made if need be; InputError that names the holder where that is another process."""
    output_directory(directory)
    path = directory / LOCK
    try:
        file = path.open("a+b", buffering=0)
    except OSError as error:
        raise InputError(f"cannot write {path}: {error.strerror}") from None
    with file:  # and with it goes the lock
        # the run that had the lock may have removed the file before it could be locked
        if not _try_to_lock(file) or not os.fstat(file.fileno()).st_nlink:
            file.seek(0)
            holder = file.read(100).decode(errors="replace") or "another process"
            raise InputError(
                f"{directory} is in use by another run ({holder}): wait for it, or choose another --output"
            )
        with suppress(OSError):  # on a full disk: then the holder has no name
            file.truncate(0)
            file.write(f"process {os.getpid()}".encode())
        yield


def _try_to_lock(file: BinaryIO) -> bool:
    """Return whether the file could be locked for this process; the system lets go of it when the process ends.

    InputError where the file system has no locks.
    """
    try:
        if sys.platform == "win32":
            msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)
        else:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except (BlockingIOError, PermissionError):  # held by another: as Unix says it, as Windows does
        return False
    except OSError as error:
        raise InputError(f"cannot lock {file.name}: {error.strerror}; choose another --output") from None
    return True
