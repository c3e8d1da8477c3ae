"""Directories of finished chunks: every damage is seen, one run at a time, nothing but what is known is removed."""

import multiprocessing
import shutil
from pathlib import Path

import numpy as np
import pytest

from bezstab.errors import InputError
from bezstab.evidence import chunk_store
from tests.evidence.samples import of_campaign

SQUARES = {"square": np.array([1, 4, 9]), "name": np.array(["a", "b"])}


@pytest.mark.parametrize("stride", of_campaign([1], [13]))
def test_a_flipped_bit_is_seen_or_does_no_harm(stride: int, tmp_path: Path) -> None:
    with chunk_store(tmp_path / "job", "squares", resume=False) as store:
        store.save(0, SQUARES)
        content = store.file(0).read_bytes()
        seen = 0
        bits = range(0, 8 * len(content), stride)
        for bit in bits:
            damaged = bytearray(content)
            damaged[bit // 8] ^= 1 << bit % 8
            store.file(0).write_bytes(damaged)
            loaded = store.load(0)
            seen += loaded is None
            if loaded is not None:
                assert {key: array.tolist() for key, array in loaded.items()} == {
                    key: array.tolist() for key, array in SQUARES.items()
                }
        assert seen > len(bits) / 2  # most bits matter


def test_every_truncation_is_seen(tmp_path: Path) -> None:
    with chunk_store(tmp_path / "job", "squares", resume=False) as store:
        store.save(0, SQUARES)
        content = store.file(0).read_bytes()
        for length in range(0, len(content), 7):
            store.file(0).write_bytes(content[:length])
            assert store.load(0) is None


def test_a_chunk_of_another_number_or_job_is_not_taken(tmp_path: Path) -> None:
    with chunk_store(tmp_path / "squares", "squares", resume=False) as store:
        store.save(0, SQUARES)
        shutil.copy(store.file(0), store.file(1))
        assert store.load(0) is not None
        assert store.load(1) is None
        with chunk_store(tmp_path / "cubes", "cubes", resume=False) as other:
            shutil.copy(store.file(0), other.file(0))
            assert other.load(0) is None


def test_what_is_no_chunk_is_not_one(tmp_path: Path) -> None:
    with chunk_store(tmp_path / "job", "squares", resume=False) as store:
        (store.path / "7.npz").mkdir()
        assert not store.has(7)


def test_chunks_without_a_job_are_not_trusted(tmp_path: Path) -> None:
    with chunk_store(tmp_path / "job", "squares", resume=False) as store:
        store.save(0, SQUARES)
    (tmp_path / "job" / "job.txt").unlink()
    with chunk_store(tmp_path / "job", "squares", resume=True) as store:
        assert not store.has(0)


def test_a_damaged_job_is_one_of_other_options(tmp_path: Path) -> None:
    with chunk_store(tmp_path / "job", "squares", resume=False):
        (tmp_path / "job" / "job.txt").write_bytes(b"\xff\xfe")
    with pytest.raises(InputError, match="other options"), chunk_store(tmp_path / "job", "squares", resume=True):
        pass


def test_two_runs_do_not_work_in_the_same_place(tmp_path: Path) -> None:
    with chunk_store(tmp_path / "job", "squares", resume=False) as store:
        store.save(0, SQUARES)
        for resume in (False, True):
            with pytest.raises(InputError, match=r"in use by another run \(process \d+\)"):
                chunk_store(tmp_path / "job", "squares", resume).__enter__()
        assert store.load(0) is not None  # nothing of the first was touched
    with chunk_store(tmp_path / "job", "squares", resume=True) as store:
        assert store.has(0)


def test_what_a_killed_run_had_half_written_goes_and_what_is_not_ours_stays(tmp_path: Path) -> None:
    with chunk_store(tmp_path / "job", "squares", resume=False) as store:
        (store.path / ".3.npz.0a1b").touch()
        store.discard()
    assert not (tmp_path / "job").exists()
    with chunk_store(tmp_path / "job", "squares", resume=False) as store:
        (store.path / "mine").mkdir()
        store.discard()
    assert [path.name for path in (tmp_path / "job").iterdir()] == ["mine"]


def count_up(path: Path, times: int) -> None:
    """Add one to a number in a file, so often, reading and writing it only inside the store's lock."""
    done = 0
    while done < times:
        try:
            with chunk_store(path / "job", "count", resume=False) as store:
                number = int((path / "count").read_text())
                (path / "count").write_text(f"{number + 1}")
                store.save(0, SQUARES)
                store.discard()
                done += 1
        except InputError:
            continue  # in use


@pytest.mark.slow
def test_many_runs_that_come_and_go_never_meet(tmp_path: Path) -> None:
    (tmp_path / "count").write_text("0")
    spawn = multiprocessing.get_context("spawn")
    processes = [spawn.Process(target=count_up, args=(tmp_path, 10)) for _ in range(3)]
    for process in processes:
        process.start()
    for process in processes:
        process.join(timeout=100)
        assert process.exitcode == 0
    assert (tmp_path / "count").read_text() == "30"
