"""How the bench measures times: what is compared takes turns, so that a busy moment does not decide."""

import time
from collections.abc import Callable
from typing import Any

ROUNDS = 3  # of turns: a busy moment seldom lasts that long
TURN = 0.2  # s: a call that is shorter is repeated in its turn


def interleaved(
    *calls: Callable[[], Any], rounds: int = ROUNDS, clock: Callable[[], float] = time.perf_counter
) -> list[tuple[float, Any]]:
    """Return the shortest time of each of several calls (s) and its last result; what disturbs a call only slows it.

    They take turns, `rounds` times, and a call is repeated until its turn of TURN is over.
    """
    found: list[tuple[float, Any]] = [(float("inf"), None) for _ in calls]
    for _ in range(rounds):
        for number, call in enumerate(calls):
            begin = clock()
            while True:
                start = clock()
                result = call()
                end = clock()
                found[number] = min(found[number][0], end - start), result
                if end - begin >= TURN:
                    break
    return found
