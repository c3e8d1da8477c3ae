"""The two kinds of bad news: a user's mistake, and numerical trouble."""


class InputError(ValueError):
    """A user's mistake, said in one line that names what was given and what is accepted."""


class NumericalError(ArithmeticError):
    """A computation that broke down, said in one line that names when and where."""
