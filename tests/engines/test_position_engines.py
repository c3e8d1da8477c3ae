from fractions import Fraction

from bezstab.engines.position_engines import BRAX_POSITIONAL, JOLT, PBD

H = Fraction(1, 60)


def test_iterations_take_back_their_share_of_what_is_left() -> None:
    share = Fraction(1, 5)
    assert JOLT.point((share,), H) == JOLT.point((share, Fraction(2)), H) == (Fraction(1), Fraction(9, 25))
    assert PBD.point((share, Fraction(3)), H) == (1 - Fraction(4, 5) ** 3, 1 - Fraction(4, 5) ** 3)


def test_a_velocity_taken_from_the_move_is_on_the_diagonal() -> None:
    assert BRAX_POSITIONAL.point((Fraction(1, 2),), H) == PBD.point((Fraction(1, 2),), H) == (Fraction(1, 2),) * 2
