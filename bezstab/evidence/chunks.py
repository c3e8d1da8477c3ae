"""Independent chunks of a long computation, spread over workers, kept in a store as they arrive."""

from collections import Counter, deque
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, Future, wait
from pathlib import Path
from typing import TypeVar

from bezstab.errors import NumericalError
from bezstab.evidence.chunk_stores import Arrays, ChunkStore
from bezstab.evidence.worker_pools import WorkerPool
from bezstab.stopping import signals_deferred

Chunk = TypeVar("Chunk")

ATTEMPTS = 3
"""A chunk that loses its worker so often is what kills them."""


def completed_chunks(
    work: Callable[[Chunk], Arrays],
    chunks: Sequence[Chunk],
    workers: WorkerPool,
    store: ChunkStore,
    report_damaged: Callable[[Path], object] = lambda path: None,
) -> Iterator[tuple[int, Arrays]]:
    """Yield (number, work(chunk)) as they arrive, those first that the store already has.

    A chunk whose file is damaged is reported and computed again; one whose worker is lost goes to another.
    NumericalError if that happens to one ATTEMPTS times; InputError if a chunk cannot be written.
    """
    finished: set[int] = set()
    for number, arrays in _intact_chunks(store, len(chunks), report_damaged):
        finished.add(number)
        yield number, arrays
    waiting = deque(number for number in range(len(chunks)) if number not in finished)
    # An executor is idle, or busy with one chunk: then it is found by the future of that chunk's result.
    idle = [workers.start() for _ in range(min(workers.count, len(waiting)))]
    busy: dict[Future[Arrays], tuple[Executor, int]] = {}
    losses = Counter[int]()
    try:
        while waiting or busy:
            while waiting and idle:
                executor, number = idle.pop(), waiting.popleft()
                with signals_deferred():  # the first chunk of an executor starts its process
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
        for executor in (*idle, *(executor for executor, _ in busy.values())):
            executor.shutdown(wait=False)


def _intact_chunks(
    store: ChunkStore, count: int, report_damaged: Callable[[Path], object]
) -> Iterator[tuple[int, Arrays]]:
    """Yield those of `count` chunks that the store has, and report each whose file is damaged."""
    for number in filter(store.has, range(count)):
        arrays = store.load(number)
        if arrays is None:
            report_damaged(store.file(number))
        else:
            yield number, arrays
