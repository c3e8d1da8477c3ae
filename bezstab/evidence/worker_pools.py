"""Who does the work: processes of this machine, or the workers of a Dask cluster."""

import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from multiprocessing.resource_tracker import ensure_running

from bezstab.compiling import cores
from bezstab.errors import InputError
from bezstab.stopping import if_stopped

PATIENCE = 10
"""s, for a scheduler to answer."""


@dataclass(frozen=True)
class WorkerPool:
    """How an executor of all workers is started, and what it raises when a worker is lost."""

    start: Callable[[], Executor]
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
                yield WorkerPool(start=partial(_processes, count or cores()), lost=BrokenProcessPool)
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
        yield WorkerPool(start=client.get_executor, lost=KilledWorker)


def _start_helper() -> None:
    """Start the process by which multiprocessing cleans up after a run that was killed, and have it say nothing then.

    It is started here because that unblocks signals, which `completed_chunks` blocks while it starts workers.
    """
    if os.name == "posix":
        os.environ.setdefault("PYTHONWARNINGS", "ignore:resource_tracker")
        ensure_running()


def _processes(count: int) -> Executor:
    """Return an executor of so many processes."""
    spawn = multiprocessing.get_context("spawn")  # a fork while an executor's threads run may never wake up
    return ProcessPoolExecutor(count, mp_context=spawn, initializer=_begin_work)


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
