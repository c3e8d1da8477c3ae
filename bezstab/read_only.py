"""Results whose arrays nobody can write: what is remembered, and handed out again, stays what it was."""

import numpy as np


class ReadOnlyArrays:
    """What a dataclass of results derives from: its arrays, those in its tuples too, are read-only.

    To write into one raises numpy's ValueError; a copy can be written.
    """

    def __post_init__(self) -> None:
        for value in vars(self).values():
            for each in value if isinstance(value, tuple) else (value,):
                if isinstance(each, np.ndarray):
                    each.flags.writeable = False
