"""Independent chunks of a long computation, spread over workers, kept in a store as they arrive."""

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, as_completed
from contextlib import suppress
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
) -> Iterator[tuple[int, Arrays]]:
    """Yield (number, work(chunk)) as they arrive, those first that the store already has.

    A chunk whose file is damaged is computed again. Chunks that lose their worker go to others.
    NumericalError if workers are lost ATTEMPTS times; InputError if a chunk cannot be written.
    """
    left = set()
    for number in range(len(chunks)):
        kept = store.load(number)
        if kept is None:
            left.add(number)
        else:
            yield number, kept
    for _ in range(ATTEMPTS):
        if not left:
            return
        executor = workers.start()
        futures: dict[Future[Arrays], int] = {}
        with suppress(workers.lost), signals_deferred():  # the first chunks of an executor start its processes
            for number in sorted(left):
                futures[executor.submit(work, chunks[number])] = number
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
