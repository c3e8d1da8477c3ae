"""Independent chunks of a long computation: processes or a Dask cluster compute them, a store keeps what is done.

The store is a directory beside the result, locked while a run works in it.
"""

import multiprocessing
import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Executor, ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from multiprocessing.resource_tracker import ensure_running
from pathlib import Path
from typing import BinaryIO, TypeVar

import numpy as np
from numpy.typing import NDArray

from bezstab.compiling import cores
from bezstab.errors import InputError, NumericalError
from bezstab.files import output_directory, write_whole
from bezstab.stopping import if_stopped, signals_deferred

if sys.platform == "win32":
    import msvcrt
else:
    import fcntl

Chunk = TypeVar("Chunk")
Arrays = Mapping[str, NDArray[np.generic]]

JOB = "job.txt"
LOCK = "lock.txt"
SEAL = "number of the chunk"
"""The name of the last array in a chunk's file: no array of a result is called so, and a damaged file may lack it."""

PATIENCE = 10
"""s, for a scheduler to answer."""

LOST = "a worker was lost, as where memory runs out: --resume goes on with what is not done"


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


def completed_chunks(
    work: Callable[[Chunk], Arrays],
    chunks: Sequence[Chunk],
    workers: Executor,
    store: ChunkStore,
    report_damaged: Callable[[Path], object],
) -> Iterator[tuple[int, Arrays]]:
    """Yield (number, work(chunk)) as they arrive, those first that the store already has.

    A chunk whose file is damaged is reported and computed again. InputError if a chunk cannot be written.
    """
    left = []
    for number in range(len(chunks)):
        kept = store.load(number)
        if kept is not None:
            yield number, kept
            continue
        left.append(number)
        if store.file(number).exists():
            report_damaged(store.file(number))
    with signals_deferred():  # the first chunks start the processes
        futures = {workers.submit(work, chunks[number]): number for number in left}
    for future in as_completed(futures):
        number, result = futures[future], future.result()
        store.save(number, result)
        yield number, result


@contextmanager
def worker_pool(count: int | None = None, scheduler: str | None = None) -> Iterator[Executor]:
    """Give an executor: `count` processes (by default one for each core), or the Dask cluster at tcp://host:port.

    All processes that this one has started are ended at once when the context is left, whatever they do. InputError
    without Dask or without an answer; NumericalError if a process is lost, or if a chunk loses so many workers of a
    cluster that Dask gives it up.
    """
    if scheduler is None:
        _start_helper()

        def end_processes() -> None:
            for process in multiprocessing.active_children():
                process.kill()

        spawn = multiprocessing.get_context("spawn")  # a fork while an executor's threads run may never wake up
        with if_stopped(end_processes):
            try:
                yield ProcessPoolExecutor(count or cores(), mp_context=spawn, initializer=_begin_work)
            except BrokenProcessPool:
                raise NumericalError(LOST) from None
            finally:
                end_processes()
        return
    try:
        from distributed import Client, KilledWorker
    except ImportError:
        raise InputError("--scheduler needs an optional package: pip install 'bezstab[dask]'") from None
    try:
        client = Client(scheduler, timeout=PATIENCE)
    except (OSError, ValueError) as error:
        raise InputError(f"--scheduler {scheduler}: {error}") from None
    with client:
        try:
            yield client.get_executor()
        except KilledWorker:
            raise NumericalError(LOST) from None


def _start_helper() -> None:
    """Start the process by which multiprocessing cleans up after a run that was killed, and have it say nothing then.

    It is started here because that unblocks signals, which `completed_chunks` blocks while it starts workers.
    """
    if os.name == "posix":
        os.environ.setdefault("PYTHONWARNINGS", "ignore:resource_tracker")
        ensure_running()


def _begin_work() -> None:
    """Let a worker end when its parent does.

    INT and HUP stay blocked, as they were when the process was started: of those the parent speaks, once.
    """
    if hasattr(signal, "pthread_sigmask"):
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGTERM})
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    """Wait for the parent to end, even by SIGKILL, which leaves it no time to say so; then end at once."""
    parent = multiprocessing.parent_process()
    assert parent is not None
    parent.join()
    os._exit(1)
