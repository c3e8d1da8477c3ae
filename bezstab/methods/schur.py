"""The Schur-Cohn (Jury) test in exact rational arithmetic: where a polynomial's roots lie in the unit disc.

Polynomials are sequences of Fraction in ascending powers of z.
"""

from math import gcd
from typing import Literal

from bezstab.methods.polynomials import Polynomial, divided, monic, polynomial_gcd
from bezstab.rationals import whole_multiples

Verdict = Literal["converges", "marginal", "diverges"]

WORKING_BITS = 1024  # a step loses up to 25 of them where 24 roots lie near z = 1; what they leave open takes all bits


def recursion_verdict(polynomial: Polynomial) -> Verdict:
    """Return what the linear recursion with this characteristic polynomial does, proven.

    converges: every root has |z| < 1; marginal: bounded without decay, that is the roots on the unit circle are
    simple and none lies outside; diverges: a root outside, or a repeated one on the circle.
    The polynomial is real, with a non-zero leading coefficient; ZeroDivisionError if it is zero.

    Roots on the circle are shared with the reciprocal polynomial, so they all sit, with their multiplicity, in
    G = gcd(P, P*). A reciprocal G has all its roots on the circle, and simple, if and only if every root of G'
    has |z| < 1 (A. Cohn, Math. Z. 14, 1922); what is left of P must have its roots inside.
    """
    p = monic(polynomial)
    if is_schur(p):
        return "converges"
    if abs(p[0]) > abs(p[-1]):  # the product of all |z| exceeds one
        return "diverges"
    reciprocal = monic(p[::-1])
    shared = polynomial_gcd(p, reciprocal)
    rest, _ = divided(p, shared)
    derivative = [k * a for k, a in enumerate(shared)][1:]
    return "marginal" if is_schur(derivative) and is_schur(rest) else "diverges"


def is_schur(polynomial: Polynomial) -> bool:
    """Return whether every root has |z| < 1; True for a constant, which has none, and for no coefficients.

    By Schur's recursion p <- (lead(p) p - p(0) p*) / z, p* the coefficients in reverse: as long as |p(0)| < |lead(p)|
    it takes a polynomial with all roots inside to one of a degree less with all roots inside, and back (I. Schur,
    J. reine angew. Math. 147, 1917). The polynomial is as in `recursion_verdict`.

    A proof either way: whole numbers, whose last bits are dropped as long as their sum of errors decides nothing.
    """
    whole, _ = whole_multiples(polynomial)
    while len(whole) > 1 and whole[-1] == 0:
        whole.pop()
    decided = _whole_is_schur(whole, WORKING_BITS)
    return bool(_whole_is_schur(whole, None)) if decided is None else decided


def _whole_is_schur(p: list[int], bits: int | None) -> bool | None:
    """Return is_schur of whole coefficients, kept to so many bits (None: all); None if what is dropped might decide."""
    error = 0  # of every coefficient, at most
    while len(p) > 1:
        lead, last = abs(p[-1]), abs(p[0])
        if lead - last <= 2 * error:
            return False if last - lead >= 2 * error else None
        error *= lead + last + 2 * max(abs(a) for a in p) + 2 * error  # of two products, each factor off by it
        p = [p[-1] * a - p[0] * b for a, b in zip(p[1:], p[-2::-1], strict=True)]  # p(0) - k lead(p) is 0
        if bits is None:
            shared = gcd(*p)
            p = [a // shared for a in p]
            continue
        beyond = p[-1].bit_length() - bits
        if beyond > 0:
            p = [a >> beyond for a in p]
            error = (error >> beyond) + 2  # rounding of p, and of the error itself
    return True
