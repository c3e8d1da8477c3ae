"""Independent chunks of a long computation, spread over processes or a Dask cluster, kept on disk as they arrive."""

import os
import shutil
import signal
from collections import Counter, deque
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, Future, ProcessPoolExecutor, wait
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing import get_context
from pathlib import Path
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from bezstab.errors import InputError, NumericalError
from bezstab.files import output_directory, write_whole

Chunk = TypeVar("Chunk")
Arrays = Mapping[str, NDArray[np.generic]]

ATTEMPTS = 3
"""A chunk that loses its worker so often is what kills them."""

PATIENCE = 10
"""s, for a scheduler to answer."""


@dataclass(frozen=True)
class WorkerPool:
    """So many executors made by `start`, each with one chunk at a time, and what it raises when its worker is lost."""

    start: Callable[[], Executor]
    count: int
    lost: type[Exception]


@contextmanager
def worker_pool(count: int | None = None, scheduler: str | None = None) -> Iterator[WorkerPool]:
    """Give `count` processes (by default one for each core), or the workers of the Dask cluster at tcp://host:port.

    InputError without Dask or without an answer.
    """
    if scheduler is None:
        yield _process_pool(count or _cores())
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
        threads = sum(client.nthreads().values())
        yield WorkerPool(start=client.get_executor, count=threads or 1, lost=KilledWorker)


def _process_pool(count: int) -> WorkerPool:
    """Return a pool of executors of one process each, so that a lost one takes no other's chunk with it."""
    spawn = get_context("spawn")  # a fork while other executors' threads run may never wake up

    def start() -> Executor:
        return ProcessPoolExecutor(max_workers=1, mp_context=spawn, initializer=_die_quietly)

    return WorkerPool(start=start, count=count, lost=BrokenExecutor)


def _cores() -> int:
    """Return the number of cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0)) or 1
    return os.cpu_count() or 1


def _die_quietly() -> None:
    signal.signal(signal.SIGINT, signal.SIG_DFL)  # Ctrl-C: the parent says so, once


@dataclass(frozen=True)
class ChunkStore:
    """A directory that keeps the finished chunks of one job, each in a file called by its number."""

    path: Path

    def finished(self) -> dict[int, Path]:
        """Return the files of the finished chunks by number, ascending."""
        files = {int(path.stem): path for path in self.path.glob("*.npz")}
        return dict(sorted(files.items()))

    def save(self, number: int, arrays: Arrays) -> None:
        """Write one finished chunk."""
        write_whole(self.path / f"{number}.npz", lambda file: np.savez(file, **arrays))  # type: ignore[arg-type]

    def discard(self) -> None:
        """Remove the directory: the job's result has been written."""
        shutil.rmtree(self.path)


def chunk_store(path: Path, job: str, resume: bool) -> ChunkStore:
    """Return the store of a job at `path`, empty unless `resume`; InputError if what lies there is of another job.

    `job` is a text that says all on which the result depends; it is kept beside the chunks.
    """
    described = path / "job.txt"
    if resume and described.exists() and described.read_text(encoding="utf-8") != job:
        raise InputError(f"--resume: {path} was left by a run with other options; without --resume it is overwritten")
    if not resume and described.exists():
        shutil.rmtree(path)
    write_whole(output_directory(path) / described.name, lambda file: file.write(job.encode()))
    return ChunkStore(path)


def completed_chunks(
    work: Callable[[Chunk], Arrays], chunks: Sequence[Chunk], workers: WorkerPool, store: ChunkStore
) -> Iterator[tuple[int, Arrays]]:
    """Yield (number, work(chunk)) as they arrive, those first that the store already has.

    A chunk whose worker is lost goes to another. NumericalError if that happens to one ATTEMPTS times.
    """
    finished = store.finished()
    for number, path in finished.items():
        with np.load(path, allow_pickle=False) as arrays:
            yield number, dict(arrays)
    waiting = deque(number for number in range(len(chunks)) if number not in finished)
    # An executor is idle, or busy with one chunk: then it is found by the future of that chunk's result.
    idle = [workers.start() for _ in range(min(workers.count, len(waiting)))]
    busy: dict[Future[Arrays], tuple[Executor, int]] = {}
    losses = Counter[int]()
    try:
        while waiting or busy:
            while waiting and idle:
                executor, number = idle.pop(), waiting.popleft()
                future = executor.submit(work, chunks[number])
                busy[future] = executor, number
            for future in wait(busy, return_when=FIRST_COMPLETED).done:
                executor, number = busy.pop(future)
                try:
                    result = future.result()
                except workers.lost:
                    losses[number] += 1
                    if losses[number] == ATTEMPTS:
                        raise NumericalError(f"chunk {number} lost its worker {ATTEMPTS} times") from None
                    executor.shutdown()
                    executor = workers.start()
                    waiting.append(number)
                else:
                    store.save(number, result)
                    yield number, result
                idle.append(executor)
    finally:
        for future in busy:
            future.cancel()
        still_busy = [executor for executor, _ in busy.values()]
        for executor in (*idle, *still_busy):
            executor.shutdown(wait=False)
