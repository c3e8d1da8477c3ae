"""What is said of runs in words."""

from collections.abc import Sequence

from bezstab.runs.measured_poles import Measurement

MOST_LISTED = 20  # times in a message


def exact_rate_words(measurement: Measurement) -> str:
    """Return along which motion the exact rates of a method are; why there are none, where the motion ends."""
    name = measurement.method.name
    if measurement.periodic:
        return f"Exact rates of {name}: along the motion of the mechanism."
    shown = "What is shown is how errors grow over the run."
    return f"No rate of {name} is exact: the motion does not begin anew. {shown}"


def passages_words(times: Sequence[float]) -> str:
    """Return where a run has gone through singular configurations, and what that means; times in s."""
    listed = ", ".join(f"{time:.6g}" for time in times[:MOST_LISTED])
    more = ", ..." if len(times) > MOST_LISTED else ""
    what = "a singular configuration" if len(times) == 1 else f"{len(times)} singular configurations"
    where = f"the run goes through {what}, at t = {listed}{more} s"
    return f"{where}: there the motion can branch, and which way it goes is left to rounding"
