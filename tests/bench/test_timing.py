"""What is compared takes turns, and a busy moment does not decide."""

from collections.abc import Callable

from tests.bench.timing import ROUNDS, TURN, interleaved


class Machine:
    """A clock, and calls that take their time on it; in a busy moment they take ten times as long."""

    def __init__(self, busy: tuple[float, float] = (0.0, 0.0)) -> None:
        self.now, self.busy, self.called = 0.0, busy, ""

    def clock(self) -> float:
        return self.now

    def call(self, name: str, seconds: float) -> Callable[[], str]:
        def called() -> str:
            self.called += name
            self.now += seconds * (10 if self.busy[0] <= self.now < self.busy[1] else 1)
            return name

        return called


def test_calls_take_turns_and_short_ones_are_repeated_in_theirs() -> None:
    machine = Machine()
    found = interleaved(machine.call("a", 1.0), machine.call("b", TURN / 3.5), clock=machine.clock)
    assert machine.called == ROUNDS * "abbbb"
    assert [result for _, result in found] == ["a", "b"]


def test_a_busy_moment_does_not_decide() -> None:
    """Whenever it begins, though it lasts for a turn of each: the ratio is that of a quiet machine."""
    for begin in (0.0, 0.5, 1.0, 2.5):
        machine = Machine((begin, begin + 3.0))
        (slow, _), (fast, _) = interleaved(machine.call("a", 1.0), machine.call("b", 0.25), clock=machine.clock)
        assert abs(slow / fast - 4) < 1e-9
