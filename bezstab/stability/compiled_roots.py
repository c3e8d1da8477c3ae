"""As machine code: the root of largest modulus of one polynomial after the other, followed along a row.

Imported only where numba is there and pays. Each polynomial of a row differs little from the one before:

    row of points   . . . . . . . . . . .
    root            o o o o o o x o o o o     o  the last three, extrapolated, start Newton's method; what it finds is
                                x                largest if the polynomial, divided by it, has all its roots within its
                                                 modulus, which Schur's recursion tells
                                              x  elsewhere (kinks, double roots): all roots, by Aberth's iteration

What neither settles is left at nan, for numpy's slower and more careful way (root_finding).
"""

import numpy as np

from bezstab.compiling import machine_code
from bezstab.stability.arrays import EPS, ComplexArray, FloatArray

CONVERGED = 1e-9  # relative correction after which a quadratically convergent iterate is exact to rounding
LARGER = 1e-9  # relative: by so much the largest root must outdo the others to be it without doubt
SMOOTH = 1e-2  # of the square of a root's change from point to point: that of the change of this change
NEWTON_STEPS = 5  # from the extrapolated root two suffice; more than five hint at another root
ITERATIONS = 60  # of Aberth: it needs about fifteen, from a circle; at a multiple root it would go on
SMALL, LARGE = 1e-6, 1e6  # |z| between which powers up to z^16, and
ORDINARY = 1e80  # squares of coefficients below which, products of both with them are within float64, squared too
SETTLED = 1e-15  # of the circle around all roots: by so little a root near zero moves when it has arrived
NEAREST = 1e-100  # |p| of the feedback, where not zero: the rounding of its square is a normal number yet
SPLITTER = 2.0**27 + 1  # multiplying by it parts the 53 bits of a float64 into two halves (Dekker)


@machine_code
def follow_pencil(
    table: FloatArray, feedback: FloatArray, alpha_hat: FloatArray, beta_hat: FloatArray, poles: ComplexArray
) -> None:
    """Write into `poles` the dominant pole at each of a row of points, Im >= 0; nan where it is not settled.

    The poles are the roots of sum_kj table[k, j] z^k mu^j at both roots mu of the feedback; `feedback` is the matrix
    from (alpha_hat, beta_hat) to mu^2 + p mu + q, rounded and what that leaves over, shape (2, 2, 2).
    """
    steps = len(table) - 1
    coefficients = np.empty(steps + 1, np.complex128)
    work = np.empty(steps + 1, np.complex128)
    nowhere = complex(np.nan, 0.0)
    first, second = (nowhere, nowhere, nowhere), (nowhere, nowhere, nowhere)  # the last three of either mu
    for i in range(alpha_hat.size):
        p, p_low = _combination(feedback[0], alpha_hat[i], beta_hat[i])
        q, q_low = _combination(feedback[1], alpha_hat[i], beta_hat[i])
        if (p != 0 and abs(p) < NEAREST) or (q != 0 and abs(q) < NEAREST**2):
            poles[i] = nowhere
            continue
        first_mu, second_mu = _feedback_roots(p, p_low, q, q_low)
        _write_coefficients(table, first_mu, coefficients)
        is_real = first_mu.imag == 0
        pole = _largest(coefficients, _extrapolated(first), is_real, work)
        first = (pole, first[0], first[1])
        if is_real:
            _write_coefficients(table, second_mu, coefficients)
            other = _largest(coefficients, _extrapolated(second), True, work)
            second = (other, second[0], second[1])
            if _square(other) > _square(pole) or np.isnan(other.real):  # a pole that is nan stays so
                pole = other
        poles[i] = _in_upper_half(pole)


@machine_code
def follow_rows(rows: FloatArray, found: ComplexArray) -> None:
    """Write into `found` the largest root, Im >= 0, of each of a row of real polynomials; nan where it is not settled.

    `rows` has the coefficients, ascending, shape (degree + 1, points).
    """
    degree = len(rows) - 1
    coefficients = np.empty(degree + 1, np.complex128)
    work = np.empty(degree + 1, np.complex128)
    nowhere = complex(np.nan, 0.0)
    last = (nowhere, nowhere, nowhere)
    for i in range(found.size):
        for k in range(degree + 1):
            coefficients[k] = rows[k, i]
        root = _largest(coefficients, _extrapolated(last), True, work)
        last = (root, last[0], last[1])
        found[i] = _in_upper_half(root)


@machine_code
def _combination(factors: FloatArray, x: float, y: float) -> tuple[float, float]:
    """Return a x + b y as an unevaluated sum of two numbers; factors = ((a, b), what rounding them leaves over)."""
    ax, ax_low = _two_product(factors[0, 0], x)
    by, by_low = _two_product(factors[0, 1], y)
    total = ax + by
    virtual = total - ax
    low = (ax - (total - virtual)) + (by - virtual)
    return total, low + (ax_low + by_low + (factors[1, 0] * x + factors[1, 1] * y))


@machine_code
def _two_product(x: float, y: float) -> tuple[float, float]:
    """Return x y rounded, and its rounding error, exactly (T. J. Dekker, Numer. Math. 18, 1971)."""
    product = x * y
    x_shifted, y_shifted = SPLITTER * x, SPLITTER * y
    x_high, y_high = x_shifted - (x_shifted - x), y_shifted - (y_shifted - y)
    x_low, y_low = x - x_high, y - y_high
    return product, x_low * y_low - (((product - x_high * y_high) - x_low * y_high) - x_high * y_low)


@machine_code
def _feedback_roots(p: float, p_low: float, q: float, q_low: float) -> tuple[complex, complex]:
    """Return both roots of mu^2 + p mu + q, p and q unevaluated sums; real ones with Im = 0, the larger first."""
    half, half_low = 0.5 * p, 0.5 * p_low
    square, square_low = _two_product(half, half)
    high = square - q
    virtual = high - square
    low = (square - (high - virtual)) + (-q - virtual)
    discriminant = high + (low + (square_low + 2 * half * half_low - q_low))
    root = np.sqrt(abs(discriminant))
    if discriminant < 0:
        return complex(-half, root), complex(-half, -root)
    further = -(half + np.copysign(root, half))
    nearer = q / further if further != 0 else 0.0
    return complex(further, 0.0), complex(nearer, 0.0)


@machine_code
def _write_coefficients(table: FloatArray, mu: complex, coefficients: ComplexArray) -> None:
    """Write the coefficients in z, ascending, at one mu."""
    last = table.shape[1] - 1
    for k in range(table.shape[0]):
        total = complex(table[k, last], 0.0)
        for j in range(last - 1, -1, -1):
            total = total * mu + table[k, j]
        coefficients[k] = total


@machine_code
def _largest(coefficients: ComplexArray, start: complex, is_real: bool, work: ComplexArray) -> complex:
    """Return the root of largest modulus of one polynomial; nan where it is not settled."""
    largest = 0.0
    for coefficient in coefficients:
        largest = max(largest, _square(coefficient))
    if not 1 / ORDINARY < largest < ORDINARY:  # nan too
        return complex(np.nan, 0.0)
    root = _followed(coefficients, start)
    if is_real and abs(root.imag) < CONVERGED * abs(root.real):  # a double root, or a real one, may stray as far
        root = complex(root.real, 0.0)
    if _rest_within(coefficients, root, is_real and root.imag != 0, work):
        return root
    return _largest_of_all(coefficients, work)


@machine_code
def _extrapolated(last: tuple[complex, complex, complex]) -> complex:
    """Return the root to be expected from the last three, the latest first: by a parabola, next to a kink by a line."""
    now, before, earlier = last
    change = now - before
    bend = change - (before - earlier)
    if _square(bend) < SMOOTH * _square(change):  # not of nan
        return now + change + bend
    return now + change


@machine_code
def _followed(coefficients: ComplexArray, start: complex) -> complex:
    """Return the root that Newton's method reaches from a start; nan where it does not settle."""
    z = start
    for _ in range(NEWTON_STEPS):
        value, slope = _value_and_slope(coefficients, z)
        step = _quotient(value, slope)
        z = z - step
        if _square(step) <= CONVERGED**2 * _square(z):
            return z
    return complex(np.nan, 0.0)


@machine_code
def _rest_within(coefficients: ComplexArray, root: complex, is_pair: bool, work: ComplexArray) -> bool:
    """Return whether all other roots have a smaller modulus, by a margin; of a pair, all but the conjugate too."""
    size = np.sqrt(_square(root))
    if not SMALL < size < LARGE:  # nan too
        return False
    left = len(coefficients) - 2  # the degree of what is left
    work[0] = coefficients[-1]
    for k in range(1, left + 1):
        work[k] = coefficients[left + 1 - k] + root * work[k - 1]
    if is_pair:
        left -= 1
        conjugate = complex(root.real, -root.imag)
        for k in range(1, left + 1):
            work[k] = work[k] + conjugate * work[k - 1]
    scale = 1 / (size * (1 - LARGER))
    power = 1.0
    for k in range(1, left + 1):
        power *= scale
        work[k] = work[k] * power
    while left > 0:
        leading = _square(work[0])
        if not _square(work[left]) < leading:
            return False
        ratio = work[left] * work[0] * (1 / leading)
        for k in range((left + 2) // 2):
            above, below = work[k], work[left - k]
            work[left - k] = below - ratio * complex(above.real, -above.imag)
            work[k] = above - ratio * complex(below.real, -below.imag)
        left -= 1
    return True


@machine_code
def _largest_of_all(coefficients: ComplexArray, roots: ComplexArray) -> complex:
    """Return the largest root from all of them by Aberth's iteration, from a circle; nan where they do not settle."""
    degree = len(coefficients) - 1
    radius = _circle(coefficients)
    if not SMALL < radius < LARGE:
        return complex(np.nan, 0.0)
    for k in range(degree):
        angle = 2 * np.pi * k / degree + 0.7  # none the conjugate of another
        roots[k] = complex(radius * np.cos(angle), radius * np.sin(angle))
    for _ in range(ITERATIONS):
        settled = True
        for k in range(degree):
            moved = _square(_moved_root(coefficients, roots, k))
            if not (moved <= CONVERGED**2 * _square(roots[k]) or moved <= (SETTLED * radius) ** 2):
                settled = False
        if settled:
            largest: complex = roots[0]
            for k in range(1, degree):
                if _square(roots[k]) > _square(largest):
                    largest = roots[k]
            return largest
    return complex(np.nan, 0.0)


@machine_code
def _circle(coefficients: ComplexArray) -> float:
    """Return a radius near the largest root's: half of Fujiwara's bound."""
    degree = len(coefficients) - 1
    leading = np.sqrt(_square(coefficients[degree]))
    radius = 0.0
    for k in range(1, degree + 1):
        radius = max(radius, (np.sqrt(_square(coefficients[degree - k])) / leading) ** (1 / k))
    return radius


@machine_code
def _moved_root(coefficients: ComplexArray, roots: ComplexArray, place: int) -> complex:
    """Move one of the roots by Newton's correction repelled by the others, and return by how much."""
    z = roots[place]
    value, slope = _value_and_slope(coefficients, z)
    if value == 0:
        return 0j
    repulsion = 0j
    for j in range(len(coefficients) - 1):
        difference = z - roots[j]
        if j != place and difference != 0:
            repulsion += _quotient(1 + 0j, difference)
    step = _quotient(value, slope - value * repulsion)
    roots[place] = z - step
    return step


@machine_code
def _value_and_slope(coefficients: ComplexArray, z: complex) -> tuple[complex, complex]:
    """Return a polynomial and its derivative, by Horner's rule."""
    value: complex = coefficients[-1]
    slope = 0j
    for k in range(len(coefficients) - 2, -1, -1):
        slope = slope * z + value
        value = value * z + coefficients[k]
    return value, slope


@machine_code
def _in_upper_half(z: complex) -> complex:
    """Return z or its conjugate, without an imaginary part that is its rounding."""
    imag = abs(z.imag)
    return complex(z.real, 0.0 if imag < EPS * abs(z.real) else imag)


@machine_code
def _square(z: complex) -> float:
    """Return |z|^2."""
    return z.real * z.real + z.imag * z.imag


@machine_code
def _quotient(numerator: complex, denominator: complex) -> complex:
    """Return the quotient of numbers whose squares are within float64."""
    scale = 1 / _square(denominator)
    real = (numerator.real * denominator.real + numerator.imag * denominator.imag) * scale
    imag = (numerator.imag * denominator.real - numerator.real * denominator.imag) * scale
    return complex(real, imag)
