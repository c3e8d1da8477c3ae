from bezstab.errors import InputError, NumericalError


def test_bad_news_comes_in_two_kinds_that_python_knows() -> None:
    assert issubclass(InputError, ValueError)
    assert issubclass(NumericalError, ArithmeticError)
