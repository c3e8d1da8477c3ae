"""Methods written in one line, as a user's file would have them."""

from bezstab.methods.schemes import LinearMultistep, Method, RungeKutta
from bezstab.rationals import rational


def multistep(name: str, rho: str, sigma: str) -> Method:
    """Return a linear multistep method; coefficients in descending powers of z."""
    return Method(name, LinearMultistep(tuple(map(rational, rho.split())), tuple(map(rational, sigma.split()))), "")


def runge_kutta(name: str, rows: str, weights: str) -> Method:
    """Return a Runge-Kutta method; all rows of A or those below the first, and the weights b."""
    b = tuple(map(rational, weights.split()))
    given = [row.split() for row in rows.split(";")]
    all_rows = given if len(given) == len(b) else [[], *given]
    tableau = tuple(tuple(map(rational, [*row, *["0"] * (len(b) - len(row))])) for row in all_rows)
    return Method(name, RungeKutta(tableau, b), "")
