"""Numbers as sentences have them: points, times, factors, and what becomes of an error from step to step."""

from fractions import Fraction

from bezstab.units import alpha_and_beta

Number = Fraction | float

MOST_DIGITS = 17  # of float64: with so many every number other than one is shown as another
THOUSAND = 1000.0
PLAIN = 1e7  # a number from here on has so many zeros that nobody counts them
GONE = 1e-6  # of |z|: after three steps an error is below rounding; at a double root that is zero |z| comes out as 1e-8

SLOWLY = 10.0
"""Seconds to a thousandth: an error that takes so long is said to fall slowly."""

UNITS = ((0.1, 1.0, "s"), (1e-3, 1e-3, "ms"), (1e-6, 1e-6, "µs"))
"""Of times, the largest first: from which on (s) it is used, and its seconds."""


def point_words(alpha_hat: float, beta_hat: float, h: Fraction | float | None) -> str:
    """Return a point as it is judged: α̂ = 1, β̂ = 1 (α = 50 1/s, β = 100 1/s at h = 0.01 s).

    Without a step (s), and so without a unit, only the first half; a negative beta_hat is the square of no β.
    """
    place = f"α̂ = {alpha_hat:.6g}, β̂ = {beta_hat:.6g}"
    if h is None:
        return place
    named = zip("αβ", alpha_and_beta(alpha_hat, beta_hat, h), strict=True)
    in_seconds = ", ".join(f"{name} = {rate:.6g} 1/s" for name, rate in named if rate is not None)
    return f"{place} ({in_seconds} at h = {float(h):.6g} s)"


def gains_words(kp: Number, kd: Number, ki: Number, inertia: Number, h: Number, applied: str) -> str:
    """Return a drive (SI units) as it is judged: kp = 1000, kd = 80 (explicit, inertia 0.1, h = 0.002 s)."""
    integral = f", ki = {float(ki):.6g}" if ki else ""
    judged = f"{applied}, inertia {float(inertia):.6g}, h = {float(h):.6g} s"
    return f"kp = {float(kp):.6g}, kd = {float(kd):.6g}{integral} ({judged})"


def seconds_words(seconds: float) -> str:
    """Return a time (s) to three digits, in the unit that suits it: 1.56 ms; powers of ten where none does."""
    rounded = float(f"{seconds:.3g}")
    for least, size, unit in UNITS:
        if least <= rounded < THOUSAND * size:
            return f"{rounded / size:.3g} {unit}"
    return f"{plain(seconds)} s"


def plain(number: float, digits: int = 3) -> str:
    """Return a number to so many digits: 0.25, 17,300, or a power of ten where nobody counts its zeros."""
    text = f"{number:.{digits}g}"
    return f"{float(text):,.0f}" if 10**digits <= float(text) < PLAIN else text


def times_words(factor: float) -> str:
    """Return a factor to two digits, as a sentence has it: 0.25, 1.1, 3,400."""
    return plain(factor, 2)


def errors_words(times: tuple[float, float]) -> str:
    """Return by how many times the errors of constraint and velocity are larger or smaller."""
    of_constraint, of_velocity = map(_ratio_words, times)
    return f"constraint error {of_constraint}, velocity error {of_velocity}"


def _ratio_words(times: float) -> str:
    """Return how one error compares with another that it is so many times as large as."""
    words = times_words(max(times, 1 / times))
    return "unchanged" if words == "1" else f"{words} times {'larger' if times > 1 else 'smaller'}"


def change_words(
    z_abs: float, verdict: str, steps: int | None, step: float | None, what: str = "error", bound: str = ""
) -> str:
    """Return what becomes of an error: within how many steps it falls to a thousandth, else what a step does to it.

    An error falls to a thousandth in 0.1 s (10 steps), with so many s a step, if known; or slowly: in 288 s. Where the
    number of steps is not known, what a step does by its proven verdict: each step multiplies the error by 0.65. Two
    digits of the modulus, and as many more as it takes to tell it from one. Where rounding has left it on the wrong
    side of one, the verdict alone.

    The error, or `what` else: of a damper alone it is the velocity. `bound` says that it is at most, or at least, so
    much.
    """
    if steps is not None:
        many = counted(steps, "step") if steps < THOUSAND else f"{plain(steps)} steps"
        falls = f"{'an error' if what == 'error' else f'the {what}'} falls"
        if step is None:
            return f"{falls} to a thousandth in {bound}{many}"
        seconds = steps * step
        slowly = "slowly: " if seconds >= SLOWLY else ""
        return f"{falls} {slowly}to a thousandth in {bound}{seconds_words(seconds)} ({many})"
    if verdict == "marginal":
        return f"the {what} neither shrinks nor grows"
    converges = verdict == "converges"
    if converges and z_abs < GONE:
        return f"the {what} is gone within a few steps"
    if not (z_abs < 1 if converges else z_abs > 1):
        return f"the {what} {'shrinks' if converges else 'grows'}, by less at a step than rounding shows"
    digits = next(digits for digits in range(2, MOST_DIGITS + 1) if float(f"{z_abs:.{digits}g}") != 1)
    return f"each step multiplies the {what} by {bound}{z_abs:.{digits}g}"


def as_sentence(said: str) -> str:
    """Return what is said as a sentence: with a capital and a full stop."""
    return f"{said[0].upper()}{said[1:]}."


def counted(number: int, one: str, many: str = "") -> str:
    """Return how many there are of something: 1 sweep, 10 sweeps."""
    return f"1 {one}" if number == 1 else f"{number} {many or one + 's'}"
