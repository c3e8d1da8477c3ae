"""The second map of region --accuracy and the trade of tradeoff --predicted: forced errors over the plane, exact."""

from collections.abc import Mapping, Sequence
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING

from bezstab.cli.options import FigureForm, TableForm
from bezstab.cli.output import for_reading, progress, say, show_rows, show_text, write_figure, write_table
from bezstab.errors import InputError, NumericalError
from bezstab.methods import Method
from bezstab.show import FRONTS, Format, Row, formatted

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from bezstab.questions import ReferenceMotion
    from bezstab.stability import BestPoint, Choice, Extent

Window = tuple[Fraction, Fraction]

SLOWER = 10
"""Times: so much weaker than the motion's own rate the feedback is where a map begins, ..."""

DECADES = 100
"""... and times weaker at least than the strongest that is shown."""

BEYOND = 1.25
"""Times the parameters of a point: so far is shown beyond one that lies outside."""


def accuracy_keys(method: Method, motion: "ReferenceMotion", best: "BestPoint | None", chosen: "Choice | None") -> Row:
    """Return what the best points of both maps force, the fastest and the most accurate, as keys of a region's row."""
    from bezstab.stability import combined_error

    def error(point: "BestPoint | Choice | None") -> float | None:
        """Return the error at a point, None without one."""
        if point is None:
            return None
        return float(combined_error(method, point.alpha_hat, point.beta_hat, motion.omega_h))

    return {
        "omega_h": float(motion.omega_h),
        "accurate_alpha_hat": chosen.alpha_hat if chosen else None,
        "accurate_beta_hat": chosen.beta_hat if chosen else None,
        "accurate_z_abs": abs(chosen.pole) if chosen else None,
        "accurate_error": error(chosen),
        "best_error": error(best),
    }


def accurate_choice(method: Method, motion: "ReferenceMotion") -> "Choice | None":
    """Return the choice of the goal accurate; None where there is none, which is said."""
    from bezstab.stability import choose

    try:
        return choose(method, "accurate", margins=False, omega_h=motion.omega_h)
    except (InputError, NumericalError) as error:
        say(f"bezstab: no most accurate point: {error}")
        return None


def write_accuracy_map(
    method: Method,
    motion: "ReferenceMotion",
    best: "BestPoint | None",
    chosen: "Choice | None",
    *,
    alpha_range: Window | None,
    beta_range: Window | None,
    points: int,
    levels: Sequence[float],
    h: float | None,
    marks: Mapping[str, tuple[float, float]],
    path: Path,
    figure: FigureForm,
    table: TableForm,
) -> None:
    """Write the map of forced errors over |z_p| as figure and table at `path`, or nothing where both forms are none.

    InputError for a range that does not begin above zero.
    """
    for option, given in (("--alpha-range", alpha_range), ("--beta-range", beta_range)):
        if given and given[0] <= 0:
            typed = f"{option} {float(given[0]):g} {float(given[1]):g}"
            raise InputError(f"{typed}: the axes of --accuracy are logarithmic, and begin above 0")
    if figure == table == "none":
        return
    import numpy as np

    from bezstab import stability
    from bezstab.show import map_arrays

    stable = stability.region(method)
    fitting = _fitting(stability.useful_window(stable), motion, best, chosen)
    alpha_hat, beta_hat = (
        np.geomspace(float(low), float(high), points)
        for low, high in (alpha_range or fitting[0], beta_range or fitting[1])
    )
    blocks = stability.pole_map(method, alpha_hat, beta_hat)
    z = np.concatenate(list(progress(blocks, method.name, points, len)))
    error = stability.combined_error(method, alpha_hat, beta_hat[:, np.newaxis], motion.omega_h)
    decaying = np.where(np.abs(z) < 1, error, np.nan)

    def draw() -> "Figure":
        from bezstab.show import accuracy_map_figure

        return accuracy_map_figure(
            stable,
            float(motion.omega_h),
            alpha_hat,
            beta_hat,
            np.abs(z),
            decaying,
            levels=levels or [stability.default_rate(method, motion.omega_h)],
            best=best,
            chosen=chosen,
            h=h,
            marks=marks,
        )

    columns = {**map_arrays(alpha_hat, beta_hat, z, h), "combined_error": decaying.ravel()}
    write_table(path, columns, table)
    write_figure(path, draw, figure)


def front_sentence(row: Row) -> str:
    """Return how little a method can force while errors decay so fast."""
    error, z_abs = formatted(row["combined_error"], ".1e"), formatted(row["z_abs_below"], ".4g")
    return f"With |z_p| of {z_abs} at most {row['method']} forces {error} of the motion at least."


def show_predicted_trade(
    methods: Sequence[Method],
    motion: "ReferenceMotion",
    rates: Sequence[float],
    *,
    h: float | None,
    path: Path,
    figure: FigureForm,
    table: TableForm,
    form: Format,
) -> None:
    """Print, draw and write at `path` how little each method can force while errors decay so fast; h in s."""
    from bezstab.show import front_row, untimed_arrays
    from bezstab.stability import RATES, error_front

    asked = list(dict.fromkeys(methods))
    fronts = [error_front(method, rates or RATES, motion.omega_h) for method in progress(asked, "fronts", len(asked))]
    rows = [front_row(point, h) for front in fronts for point in front]

    def draw() -> "Figure":
        from bezstab.show import error_front_figure

        return error_front_figure([front for front in fronts if front])

    write_table(path, untimed_arrays(rows), table)
    write_figure(path, draw, figure)
    show_rows(rows, FRONTS.columns(rows), form, sentence=front_sentence)
    if for_reading(form):
        say_combined(motion)


def say_combined(motion: "ReferenceMotion") -> None:
    """Print below a table of combined errors what they are shares of."""
    show_text(
        "\nErrors of position and velocity are shares of the amplitudes of a motion's own position and velocity, here "
        f"{motion.words}."
    )


def _fitting(shown: "Extent", motion: "ReferenceMotion", best: "BestPoint | None", chosen: "Choice | None") -> "Extent":
    """Return ranges above zero: from feedback much slower than the motion on, to the region's ends and both points."""
    (_, alpha_hat_max), (_, beta_hat_max) = shown
    for point in (best, chosen):
        if point:
            alpha_hat_max = max(alpha_hat_max, BEYOND * point.alpha_hat)
            beta_hat_max = max(beta_hat_max, BEYOND * point.beta_hat)
    slow = float(motion.omega_h) / SLOWER  # alpha h and beta h
    return (
        (min(2 * slow, alpha_hat_max / DECADES), alpha_hat_max),
        (min(slow**2, beta_hat_max / DECADES), beta_hat_max),
    )
