"""The built-in one-step methods: Runge-Kutta methods by their tableaux, and symplectic Euler."""

from fractions import Fraction

from bezstab.methods.recipes import recipe
from bezstab.methods.schemes import Family, Method, RungeKutta
from bezstab.rationals import ZERO

KUTTA = "Kutta, Z. Math. Phys. 46, 1901"


def runge_kutta(stages: int) -> Method:
    """Return the classical explicit Runge-Kutta method RK1 to RK4, whose order is its number of stages."""
    match stages:
        case 1:
            scheme, source = explicit_scheme([""], "1"), "Euler, Institutionum calculi integralis I, 1768"
        case 2:
            scheme, source = explicit_scheme(["", "1/2"], "0 1"), "Runge, Math. Ann. 46, 1895 (midpoint)"
        case 3:
            scheme, source = explicit_scheme(["", "1/2", "-1 2"], "1/6 2/3 1/6"), KUTTA
        case 4:
            scheme, source = explicit_scheme(["", "1/2", "0 1/2", "0 0 1"], "1/6 1/3 1/3 1/6"), KUTTA
        case _:
            raise ValueError(f"no classical Runge-Kutta method of {stages} stages: expected 1 to 4")
    return Method(f"RK{stages}", scheme, source, family=Family("Runge-Kutta", stages))


def semi_implicit_euler() -> Method:
    """Return SIE, the paper's 'Euler semi-implicit': an Euler step, then one with the slope found at its end.

    It is not what physics engines call semi-implicit Euler: that is symplectic Euler, SYM.
    """
    source = "paper Table 5 ('Euler semi-implicit'; Matsuno, 1966; not symplectic Euler, which is SYM)"
    return Method("SIE", explicit_scheme(["", "1"], "0 1"), source, family=Family("SIE", 0))


def symplectic_euler() -> Method:
    """Return SYM: v_{k+1} = v_k + h a_k, then x_{k+1} = x_k + h v_{k+1} (Hairer, Lubich & Wanner, Eq. I.1.9)."""
    scheme = recipe({
        "a0": "acceleration(x0, v0)",
        "v1": "v0 + a0",
        "x1": "x0 + v1",
    })  # fmt: skip
    return Method("SYM", scheme, "Hairer, Lubich & Wanner, Eq. I.1.9", family=Family("symplectic Euler", 0))


def explicit_scheme(rows: list[str], weights: str) -> RungeKutta:
    """Return the scheme with the sub-diagonal parts of A's rows and the weights b written as '1/6 2/3 1/6'."""
    b = tuple(Fraction(entry) for entry in weights.split())
    tableau = []
    for row in rows:
        below_diagonal = [Fraction(entry) for entry in row.split()]
        tableau.append((*below_diagonal, *[ZERO] * (len(b) - len(below_diagonal))))
    return RungeKutta(tuple(tableau), b)
