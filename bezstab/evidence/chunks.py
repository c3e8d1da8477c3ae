"""Independent chunks of a long computation, spread over workers, kept in a store as they arrive."""

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import as_completed
from pathlib import Path
from typing import TypeVar

from bezstab.errors import NumericalError
from bezstab.evidence.chunk_stores import Arrays, ChunkStore
from bezstab.evidence.worker_pools import WorkerPool
from bezstab.stopping import signals_deferred

Chunk = TypeVar("Chunk")

ATTEMPTS = 3
"""Executors that lose a worker: then it is a chunk that kills them."""


def completed_chunks(
    work: Callable[[Chunk], Arrays],
    chunks: Sequence[Chunk],
    workers: WorkerPool,
    store: ChunkStore,
    report_damaged: Callable[[Path], object] = lambda path: None,
) -> Iterator[tuple[int, Arrays]]:
    """Yield (number, work(chunk)) as they arrive, those first that the store already has.

    A chunk whose file is damaged is reported and computed again. Chunks that lose their worker go to others.
    NumericalError if workers are lost ATTEMPTS times; InputError if a chunk cannot be written.
    """
    left = set(range(len(chunks)))
    for number, arrays in _intact_chunks(store, len(chunks), report_damaged):
        left.remove(number)
        yield number, arrays
    for _ in range(ATTEMPTS):
        if not left:
            return
        executor = workers.start()
        with signals_deferred():  # the first chunks of an executor start its processes
            futures = {executor.submit(work, chunks[number]): number for number in sorted(left)}
        try:
            for future in as_completed(futures):
                try:
                    result = future.result()
                except workers.lost:  # of all chunks that were not finished
                    continue
                number = futures[future]
                store.save(number, result)
                left.remove(number)
                yield number, result
        finally:
            for future in futures:
                future.cancel()
            executor.shutdown(wait=False)
    if left:
        raise NumericalError(f"workers were lost {ATTEMPTS} times: {len(left)} of {len(chunks)} chunks are not done")


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
