"""Who does the work: processes of this machine, one each for a chunk, or the workers of a Dask cluster."""

import multiprocessing
import os
import signal
import threading
import traceback
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing.connection import Connection
from multiprocessing.resource_tracker import ensure_running
from typing import Any, ParamSpec, TypeVar

from bezstab.compiling import cores
from bezstab.errors import InputError
from bezstab.stopping import if_stopped, signals_deferred

Parameters = ParamSpec("Parameters")
Result = TypeVar("Result")

PATIENCE = 10
"""s, for a scheduler to answer."""


@dataclass(frozen=True)
class WorkerPool:
    """So many executors made by `start`, each with one chunk at a time, and what it raises when its worker is lost."""

    start: Callable[[], Executor]
    count: int
    lost: type[Exception]


class WorkerLostError(Exception):
    """A worker process has ended in the middle of its work."""


@contextmanager
def worker_pool(count: int | None = None, scheduler: str | None = None) -> Iterator[WorkerPool]:
    """Give `count` processes (by default one for each core), or the workers of the Dask cluster at tcp://host:port.

    InputError without Dask or without an answer.
    """
    if scheduler is None:
        with if_stopped(_kill_processes):
            yield WorkerPool(start=OneProcess, count=count or cores(), lost=WorkerLostError)
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


def _kill_processes() -> None:
    for process in multiprocessing.active_children():
        process.kill()


class OneProcess(Executor):
    """An executor of one process, with one call at a time, that can be ended at any moment.

    The standard library's ProcessPoolExecutor finishes what it is doing before it ends, be it an hour's work, and
    holds semaphores, about which there are complaints on standard error when a run is killed. This one has a pipe.
    """

    def __init__(self) -> None:
        spawn = multiprocessing.get_context("spawn")  # a fork while other executors' threads run may never wake up
        self._connection, end_of_worker = spawn.Pipe()
        self._process = spawn.Process(target=_serve, args=(end_of_worker,), daemon=True)
        if os.name == "posix":
            ensure_running()  # multiprocessing's helper; the start of the first process does it, and unblocks signals
        with signals_deferred():  # a worker whose parent ends while it is started complains
            self._process.start()
        end_of_worker.close()  # so that the pipe ends when the worker does
        self._asking: threading.Thread | None = None

    def submit(
        self, function: Callable[Parameters, Result], /, *args: Parameters.args, **kwargs: Parameters.kwargs
    ) -> Future[Result]:
        """Return the future of function(*args, **kwargs); it raises WorkerLostError if the process ends meanwhile."""
        future = Future[Result]()
        self._asking = threading.Thread(target=self._ask, args=(future, (function, args, kwargs)), daemon=True)
        self._asking.start()
        return future

    def _ask(self, future: Future[Any], call: tuple[Callable[..., Any], tuple[Any, ...], dict[str, Any]]) -> None:
        future.set_running_or_notify_cancel()
        try:
            self._connection.send(call)
            answer = self._connection.recv()
        except (EOFError, OSError):
            future.set_exception(WorkerLostError())
        except Exception as error:
            future.set_exception(error)
        else:
            if answer.error:
                future.set_exception(answer.error)
            else:
                future.set_result(answer.result)

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """End the process at once, whatever it does; the arguments are those of every Executor, without effect."""
        self._process.kill()
        self._process.join()
        if self._asking:
            self._asking.join()
        self._connection.close()


@dataclass(frozen=True)
class Answer:
    """What came of a call in a worker: its result, or what it raised."""

    result: Any = None
    error: Exception | None = None


def _serve(connection: Connection) -> None:
    """Answer calls, as a worker process, until the parent closes the pipe or is gone.

    INT and HUP stay blocked, as they were when the process was started: of those the parent speaks, once.
    """
    if hasattr(signal, "pthread_sigmask"):
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGTERM})
    threading.Thread(target=_end_with_parent, daemon=True).start()
    while True:
        try:
            function, args, kwargs = connection.recv()
        except EOFError:
            return
        try:
            answer = Answer(result=function(*args, **kwargs))
        except Exception as error:
            error.add_note(f"in a worker process:\n{traceback.format_exc()}")
            answer = Answer(error=error)
        try:
            connection.send(answer)
        except BrokenPipeError:  # nobody is there any more
            return


def _end_with_parent() -> None:
    """Wait for the parent to end, even by SIGKILL, which leaves it no time to say so; then end at once."""
    parent = multiprocessing.parent_process()
    assert parent is not None
    parent.join()
    os._exit(1)
