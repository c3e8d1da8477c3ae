"""Independent chunks of a long computation: processes or a Dask cluster compute them, a store keeps what is done."""

import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor, ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from multiprocessing.resource_tracker import ensure_running
from pathlib import Path
from typing import TypeVar

from bezstab.compiling import cores
from bezstab.errors import InputError, NumericalError
from bezstab.evidence.chunk_stores import Arrays, ChunkStore
from bezstab.stopping import if_stopped, signals_deferred

Chunk = TypeVar("Chunk")

PATIENCE = 10
"""s, for a scheduler to answer."""

LOST = "a worker was lost, as where memory runs out: --resume goes on with what is not done"


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
