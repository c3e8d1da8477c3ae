"""Who does the work: processes of this machine, one each for a chunk, or the workers of a Dask cluster."""

import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing.resource_tracker import ensure_running

from bezstab.compiling import cores
from bezstab.errors import InputError
from bezstab.stopping import if_stopped

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

    Processes are ended at once when the context is left, whatever they do. InputError without Dask or without an
    answer.
    """
    if scheduler is None:
        _start_helper()
        others = set(multiprocessing.active_children())

        def end_processes() -> None:
            for process in set(multiprocessing.active_children()) - others:
                process.kill()

        with if_stopped(end_processes):
            try:
                yield WorkerPool(start=_one_process, count=count or cores(), lost=BrokenProcessPool)
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
        threads = sum(client.nthreads().values())
        yield WorkerPool(start=client.get_executor, count=threads or 1, lost=KilledWorker)


def _start_helper() -> None:
    """Start the process by which multiprocessing cleans up after a run that was killed, and have it say nothing then.

    It is started here because that unblocks signals, which `completed_chunks` blocks while it starts workers.
    """
    if os.name == "posix":
        os.environ.setdefault("PYTHONWARNINGS", "ignore:resource_tracker")
        ensure_running()


def _one_process() -> Executor:
    """Return an executor of one process: of several, the loss of one would cost the chunks of all."""
    spawn = multiprocessing.get_context("spawn")  # a fork while other executors' threads run may never wake up
    return ProcessPoolExecutor(1, mp_context=spawn, initializer=_begin_work)


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
