"""Maps as machine code: whether that pays, and the rows of a map shared among the cores.

A map is cut into pieces of points, always the same ones, so that it does not depend on the number of cores.
"""

from collections.abc import Callable

import numpy as np

from bezstab.compiling import check_numba, compiled_choice, cores, numba_is_installed
from bezstab.stability.arrays import ComplexArray, FloatArray
from bezstab.stability.exact_sums import split
from bezstab.stability.pencils import Pencil
from bezstab.stability.plane_pencils import PlanePencil, coefficients_at

PIECE = 8192
"""Points that one core takes at a time: a millisecond, which outweighs the call."""

WORTH_COMPILING = 10**7
"""Points of a map: numpy takes twice as long for so many as numba takes to be loaded and to compile."""

FEWEST = 2**16
"""Points of a map that is compiled because it is asked for: fewer are no map, but some points of it."""

FEWEST_ROOTS = {Pencil: 2, PlanePencil: 4}
"""Of fewer numpy has the largest by a formula, as fast."""

MOST_ROOTS = 16
"""Whose powers, of what `compiled_roots` takes for ordinary, are within float64."""


def is_compiled(pencil: Pencil | PlanePencil, points: int) -> bool:
    """Return whether a map of so many points is to be compiled. InputError if it must be and numba is missing.

    By default where numba is there and it pays. Poles that have a formula are never compiled.
    """
    if points < FEWEST or not FEWEST_ROOTS[type(pencil)] <= _degree(pencil) <= MOST_ROOTS:
        return False
    choice = compiled_choice()
    if choice == "yes":
        check_numba()
        return True
    return choice == "auto" and points >= WORTH_COMPILING and numba_is_installed()


def _degree(pencil: Pencil | PlanePencil) -> int:
    return pencil.steps if isinstance(pencil, Pencil) else pencil.degree


def write_followed(
    pencil: Pencil | PlanePencil, alpha_hat: FloatArray, beta_hat: FloatArray, poles: ComplexArray
) -> None:
    """Write into `poles` the dominant pole at each of a row of points, Im >= 0; nan where it is not settled.

    By all cores, in threads. InputError without numba.
    """
    from concurrent.futures import ThreadPoolExecutor

    follow = _follower(pencil)

    def write(start: int) -> None:
        piece = slice(start, start + PIECE)
        follow(alpha_hat[piece], beta_hat[piece], poles[piece])

    with ThreadPoolExecutor(cores()) as threads:
        list(threads.map(write, range(0, poles.size, PIECE)))


def _follower(pencil: Pencil | PlanePencil) -> Callable[[FloatArray, FloatArray, ComplexArray], None]:
    """Return a function that writes the dominant poles of a piece."""
    from bezstab.stability.compiled_roots import follow_pencil, follow_rows

    if isinstance(pencil, PlanePencil):
        return lambda alpha_hat, beta_hat, poles: follow_rows(
            np.stack(coefficients_at(pencil, alpha_hat, beta_hat)), poles
        )
    halves = np.array([[split(entry) for entry in row] for row in pencil.feedback])
    feedback = np.ascontiguousarray(np.moveaxis(halves, -1, 1))
    return lambda alpha_hat, beta_hat, poles: follow_pencil(pencil.table, feedback, alpha_hat, beta_hat, poles)
