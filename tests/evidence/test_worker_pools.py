"""Processes that work for others: what they answer, what they raise, how they end."""

import os
import time

import pytest

from bezstab.errors import NumericalError
from bezstab.evidence.worker_pools import OneProcess, WorkerLostError


def break_down(when: float) -> None:
    raise NumericalError(f"at {when:g} s")


def test_a_process_answers_again_and_again() -> None:
    process = OneProcess()
    assert process.submit(pow, 2, exp=10).result() == 1024
    assert process.submit(os.getpid).result() == process.submit(os.getpid).result() != os.getpid()
    process.shutdown()


def test_what_a_worker_raises_is_raised_here_with_where_it_was() -> None:
    process = OneProcess()
    with pytest.raises(NumericalError) as caught:
        process.submit(break_down, 0.5).result()
    assert str(caught.value) == "at 0.5 s"
    assert "break_down" in caught.value.__notes__[0]
    assert process.submit(abs, -1).result() == 1
    process.shutdown()


def test_what_cannot_be_sent_is_no_lost_worker() -> None:
    process = OneProcess()
    with pytest.raises(Exception, match="pickle"):
        process.submit(lambda: 0).result()
    process.shutdown()


def test_a_process_that_ends_is_lost() -> None:
    process = OneProcess()
    with pytest.raises(WorkerLostError):
        process.submit(os._exit, 0).result()
    with pytest.raises(WorkerLostError):
        process.submit(abs, -1).result()
    process.shutdown()


def test_a_busy_process_is_ended_at_once() -> None:
    process = OneProcess()
    future = process.submit(time.sleep, 1000)
    process.shutdown()
    with pytest.raises(WorkerLostError):
        future.result(timeout=1)
