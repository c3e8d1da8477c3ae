"""Results whose arrays nobody can write: what is remembered, and handed out again, stays what it was."""

from collections.abc import Mapping

import numpy as np


class ReadOnlyArrays:
    """What a dataclass of results derives from: its arrays, in tuples, lists and mappings too, are read-only.

    To write into one raises numpy's ValueError; a copy can be written.
    """

    def __post_init__(self) -> None:
        for value in vars(self).values():
            _make_read_only(value)


def _make_read_only(value: object) -> None:
    if isinstance(value, np.ndarray):
        value.flags.writeable = False
    elif isinstance(value, (tuple, list)):
        for each in value:
            _make_read_only(each)
    elif isinstance(value, Mapping):
        for each in value.values():
            _make_read_only(each)
