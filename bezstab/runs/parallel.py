"""Independent chunks of a long computation: joblib computes them, here or on a Dask cluster, and keeps what is done."""

import importlib.util
import logging
import multiprocessing.resource_tracker
import os
import signal
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import CancelledError
from concurrent.futures.process import BrokenProcessPool
from contextlib import closing, contextmanager, suppress
from dataclasses import dataclass
from functools import cache, partial
from pathlib import Path
from typing import TypeVar

from bezstab.errors import InputError, NumericalError
from bezstab.files import output_directory, write_whole
from bezstab.stability.arrays import Arrays

Chunk = TypeVar("Chunk")

PATIENCE = 10
"""s, for a scheduler to answer and for its first worker to come."""

LOST_WORKER = "a worker was lost, as where memory runs out: --resume goes on with what is not done"
LOST_SCHEDULER = "the scheduler was lost: --resume goes on with what is not done"


def joblib_is_installed() -> bool:
    """Return whether joblib is there; it is not loaded."""
    return importlib.util.find_spec("joblib") is not None


@dataclass(frozen=True)
class KeptResults:
    """What a job has finished: a file for each chunk, in a folder beside the job's result.

    `job` is a text that says all on which the result depends; it is kept with each chunk.
    """

    folder: Path
    job: str

    def file(self, number: int) -> Path:
        """Return where a chunk is kept."""
        return self.folder / f"{number}.joblib"

    def load(self, number: int) -> Arrays | None:
        """Return a finished chunk; None where there is none, or a damaged one. InputError if it is of another job."""
        import joblib

        try:
            job, result = joblib.load(self.file(number))
        except Exception:  # a damaged file makes joblib raise nearly anything
            return None
        if job != self.job:
            raise InputError(
                f"--resume: {self.folder} is of a run with other options; without --resume it is overwritten"
            )
        return dict(result)

    def save(self, number: int, result: Arrays) -> None:
        """Keep a finished chunk; InputError if the system refuses."""
        import joblib

        compressed = partial(joblib.dump, (self.job, result), compress=True)  # then damage shows

        def write() -> None:
            output_directory(self.folder)
            write_whole(self.file(number), compressed)

        try:
            write()
        except InputError:  # another run of the same job may just finish, and remove the folder: once
            write()

    def discard(self) -> None:
        """Remove the folder, as when the job's result has been written; what is not of ours stays."""
        for file in self.folder.glob("*.joblib*"):  # also what a killed run had half written
            file.unlink(missing_ok=True)
        with suppress(OSError):
            self.folder.rmdir()


def completed_chunks(
    work: Callable[[Chunk], Arrays],
    chunks: Sequence[Chunk],
    kept: KeptResults,
    workers: int | None = None,
    scheduler: str | None = None,
) -> Iterator[tuple[int, Arrays]]:
    """Yield (number, work(chunk)) as they arrive, those first that are kept already.

    `workers` processes compute the rest (by default one for each core), or the Dask cluster at tcp://host:port.
    InputError if a chunk cannot be kept, without Dask or without an answer; NumericalError if a process is lost, or if
    a chunk loses so many workers of a cluster that Dask gives it up.
    """
    from joblib import Parallel, cpu_count, delayed, parallel_config

    left = []
    for number in range(len(chunks)):
        result = kept.load(number)
        if result is None:
            left.append(number)
        else:
            yield number, result
    with _cluster(scheduler) if scheduler else _processes():
        count = min(workers or cpu_count(), len(left)) or 1
        jobs = (delayed(_numbered)(work, number, chunks[number], os.getpid()) for number in left)
        with parallel_config("dask" if scheduler else "loky", n_jobs=count), _deaf_to_terminals():  # processes start
            arriving = Parallel(return_as="generator_unordered", pre_dispatch="all")(jobs)
        with closing(arriving):  # which ends what processes still do
            for number, result in arriving:
                if isinstance(result, Exception):
                    with suppress(BrokenProcessPool):  # of the workers that this ends
                        arriving.throw(result)
                    raise result
                kept.save(number, result)
                yield number, result


def _numbered(
    work: Callable[[Chunk], Arrays], number: int, chunk: Chunk, parent: int
) -> tuple[int, Arrays | Exception]:
    """Return a chunk's number and what work finds of it, or raises; a worker ends with the process that started it.

    What it raises is returned: a pool that is told of it ends its workers, and may report their end in its place.
    """
    _end_with(parent)
    try:
        return number, work(chunk)
    except Exception as error:
        return number, error


@contextmanager
def _processes() -> Iterator[None]:
    """Let no process outlive what is inside; NumericalError if one is lost."""
    from joblib.externals.loky import get_reusable_executor

    _start_cleaners()
    try:
        yield
    except BrokenProcessPool:
        raise NumericalError(LOST_WORKER) from None
    finally:  # through the pool, which else would give its dead workers to the next job
        get_reusable_executor(reuse=True).shutdown(kill_workers=True)


@contextmanager
def _deaf_to_terminals() -> Iterator[None]:
    """Block what a terminal sends to every process of a command: processes that are started inside never hear it."""
    if os.name != "posix":
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, (signal.SIGINT, signal.SIGHUP))
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _start_cleaners() -> None:
    """Start the processes that clean up after a run that was killed, and have them say nothing then.

    They are started here because that unblocks signals, which are blocked while workers start.
    """
    from joblib.externals.loky.backend import resource_tracker

    os.environ.setdefault("PYTHONWARNINGS", "ignore:resource_tracker")
    resource_tracker.ensure_running()
    if os.name == "posix":
        multiprocessing.resource_tracker.ensure_running()


@contextmanager
def _cluster(scheduler: str) -> Iterator[None]:
    """Have joblib use the Dask cluster at tcp://host:port; InputError without Dask or without an answer."""
    try:
        from distributed import Client, KilledWorker
    except ImportError:
        raise InputError("--scheduler needs an optional package: pip install 'bezstab[dask]'") from None
    logging.getLogger("distributed.client").setLevel(logging.CRITICAL)  # what it loses is said here, in a line
    try:
        client = Client(scheduler, timeout=PATIENCE)
    except (OSError, ValueError) as error:
        raise InputError(f"--scheduler {scheduler}: {error}") from None
    with client:
        with suppress(TimeoutError):
            client.wait_for_workers(2, timeout=PATIENCE)  # joblib does not use a single thread there
        try:
            yield
        except TimeoutError:
            raise InputError(f"--scheduler {scheduler}: no worker came within {PATIENCE} s") from None
        except KilledWorker:
            raise NumericalError(LOST_WORKER) from None
        except CancelledError:
            raise NumericalError(LOST_SCHEDULER) from None


@cache
def _end_with(parent: int) -> None:
    """Have this process end when its parent does, even by SIGKILL, which leaves no time to say so.

    Nothing happens in a process that is not a child of that one.
    """

    def wait() -> None:
        while os.getppid() == parent:
            time.sleep(1)
        os._exit(1)

    if os.getppid() == parent:
        threading.Thread(target=wait, daemon=True).start()
