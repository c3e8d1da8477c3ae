"""The command that measures what holds at extreme sizes: extremes."""

from bezstab import evidence
from bezstab.cli.options import command, flag
from bezstab.cli.output import progress, show_rows
from bezstab.show import EXTREMES


@command(flag("--short", "Fewer methods, and runs of 1e5 steps."), "compiled", "form")
def extremes(short: bool) -> bool:
    """Measure what holds at the extremes of sizes, steps and masses.

    Each check says beforehand what must come out. Poles from 1e-300 to 1e300, and multiple roots, are compared with 50
    digits and more. There are runs of 1e7 steps, steps around the largest stable one, a singular configuration, fast
    cranks, and large ratios of masses. Exit status 1 if something does not hold.

    Example: bezstab extremes --short
    """
    checks = list(evidence.extreme_checks(not short))
    outcomes = [check() for check in progress(checks, "extremes")]
    show_rows(EXTREMES, map(EXTREMES.row, outcomes))
    return all(outcome.held for outcome in outcomes)
