"""Work that takes long, shared among processes or machines, while the terminal shows how much is done."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from bezstab.cli.output import progress, say
from bezstab.errors import InputError
from bezstab.files import output_directory
from bezstab.runs.options import Work
from bezstab.runs.parallel import KeptResults, completed_chunks, joblib_is_installed
from bezstab.stability.arrays import Arrays
from bezstab.stopping import Stopped


@contextmanager
def results_of_chunks(
    compute: Callable[[Any], Arrays], chunks: Sequence[Any], path: Path, job: str, work: Work
) -> Iterator[list[Arrays]]:
    """Give the results of independent chunks, in their order; processes or a cluster's workers compute them.

    Finished chunks are kept in `path` + .chunks, so that a run of the same `job` can resume; once the results are used
    they are deleted. Without joblib this process computes them, and none are kept.
    """
    if not joblib_is_installed():
        if work.resume or work.scheduler or (work.workers or 1) > 1:
            raise InputError(
                "--workers, --scheduler and --resume need an optional package: pip install 'bezstab[parallel]'"
            )
        yield [compute(chunk) for chunk in progress(chunks, path.name)]
        return
    kept = KeptResults(path.with_name(f"{path.name}.chunks"), job)
    if not work.resume:
        kept.discard()
    output_directory(kept.folder)
    try:
        arriving = completed_chunks(compute, chunks, kept, work.workers, work.scheduler)
        results = dict(progress(arriving, path.name, len(chunks)))
        yield [results[number] for number in range(len(chunks))]
    except Stopped:
        say(f"bezstab: what is finished lies in {kept.folder}: --resume goes on from there")
        raise
    kept.discard()
