import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bezstab.stability.low_degrees import cubic_parts, largest_quadratic_root, polynomial_of_pair, quadratic_roots

ROOTS = st.floats(-3, 3).filter(lambda root: root == 0 or abs(root) > 1e-6)


@given(first=ROOTS, second=ROOTS)
def test_real_roots_of_a_quadratic_come_back_the_larger_first(first: float, second: float) -> None:
    half, last = np.array([-(first + second) / 2]), np.array([first * second])
    z = quadratic_roots(half, last, np.array([(first - second) ** 2 / 4]))[:, 0]
    assert abs(z[0]) >= abs(z[1]) - 1e-15
    larger, smaller = sorted((first, second), key=abs, reverse=True)
    assert min(abs(z[0] - larger), abs(z[0] - smaller)) < 1e-14
    assert abs(z[0] + z[1] - first - second) < 1e-14


@given(real=st.floats(-2, 2), imaginary=st.floats(1e-3, 2))
def test_of_a_pair_the_upper_root_is_given(real: float, imaginary: float) -> None:
    z = np.empty(1, complex)
    largest_quadratic_root(np.array([-real]), np.array([-(imaginary**2)]), into=z)
    assert z[0].real == real
    assert abs(z[0].imag - imaginary) < 1e-15


@given(alone=ROOTS, half=st.floats(-2, 2), last=st.floats(-2, 2))
def test_a_cubic_falls_into_a_root_and_a_quadratic(alone: float, half: float, last: float) -> None:
    b, c, d = 2 * half - alone, last - 2 * half * alone, -last * alone
    z, found_half, found_last = cubic_parts(np.array([b]), np.array([c]), np.array([d]))
    product = np.polymul([1, -z[0]], [1, 2 * found_half[0], found_last[0]])
    assert np.abs(product - [1, b, c, d]).max() < 1e-13  # backward stable: the cubic itself comes back


@given(coefficients=st.lists(st.floats(-2, 2), min_size=1, max_size=7), middle=st.floats(-2, 2), apart=st.floats(-2, 2))
def test_a_polynomial_at_both_roots_of_a_quadratic(coefficients: list[float], middle: float, apart: float) -> None:
    p, q = np.array([-2 * middle]), np.array([middle**2 - apart])  # mu = middle +- sqrt(apart), real or not
    value, factor = polynomial_of_pair(coefficients, p, q)
    root = np.emath.sqrt(apart)
    for sign in (1, -1):
        expected = np.polyval(coefficients[::-1], middle + sign * root)
        assert abs(value[0] + sign * factor[0] * root - expected) < 1e-10  # sums of terms up to 2 * 4^6


@pytest.mark.parametrize(
    ("alone", "half", "last"), [(1234567.8, 3.3, 101.7), (-1.7e-6, 3.3, 101.7), (271828.1, 1.1e-3, 1.3e-5)]
)
def test_a_root_far_from_the_others_leaves_them_their_digits(alone: float, half: float, last: float) -> None:
    """The quadratic is divided out from the end at which nothing cancels."""
    b, c, d = 2 * half - alone, last - 2 * half * alone, -last * alone
    z, found_half, found_last = cubic_parts(np.array([b]), np.array([c]), np.array([d]))
    product = np.polymul([1, -z[0]], [1, 2 * found_half[0], found_last[0]])
    assert product == pytest.approx([1, b, c, d], rel=1e-14)
