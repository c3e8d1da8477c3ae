"""The loop of `stepping` as machine code, by numba: one compilation a scene, whatever the methods.

Its operations are loops over entries, innermost those over lanes, of which a processor takes several at once. What
numba makes of a scene is kept in the user's cache folder, under a name that is the hash of all that it is made from.
"""

import os
import sys
from functools import cache
from pathlib import Path
from types import FunctionType
from typing import Any

import numpy as np

from bezstab import compiling, stabilising
from bezstab.compiling import INNER, compiled_choice, compiler, numba_is_installed
from bezstab.mechanism.equations import Mechanism
from bezstab.mechanism.generated_code import LONG, code_of, compiled_source, function_by_operations, machine_source
from bezstab.mechanism.stepping import TakeSteps, read

WORTH_COMPILING = 3 * 10**5
"""Evaluations: Python takes as long for so many as numba takes to be loaded and to compile the scene.

Both grow with the mechanism alike."""

CHEAPER_TOGETHER = 20
"""Times: what an evaluation costs in a batch of numpy, against one of a run alone in Python."""

LANES = 32
"""Runs side by side: what they remember stays in the fastest memory."""


def runs_compiled(evaluations: int, together: bool = False) -> bool:
    """Return whether runs, or runs together, of so many evaluations are to be compiled.

    By default where numba is there and they are long enough to pay. `evaluations` do not include what iterations and
    projections take. InputError where BEZSTAB_COMPILED says neither auto nor yes nor no.
    """
    choice = compiled_choice()
    if choice != "auto":
        return choice == "yes"
    return numba_is_installed() and evaluations >= WORTH_COMPILING * (CHEAPER_TOGETHER if together else 1)


@cache
def machine_steps(mechanism: Mechanism, solving: bool, projecting: bool, stride: int = 1) -> tuple[TakeSteps, int]:
    """Return the function that takes a mechanism's steps as machine code, and how long its row is.

    `solving` and `projecting` say what it can do besides explicit steps, `stride` for how many runs side by side. What
    is compiled is kept for the next process. InputError without numba.
    """
    numba = compiler()
    n = mechanism.size
    codes = {name: code_of(mechanism, name) for name in ("accelerations", "corrections")[: 1 + projecting]}
    texts = {name: machine_source(code, name, stride) for name, code in codes.items()}
    own: dict[str, Any] = {"N": n, "STRIDE": stride, "WIDTH": n * stride, "SOLVING": solving, "PROJECTING": projecting}
    file = _kept_file((*own.values(), *texts.values()))

    def made(function: Any) -> Any:
        """Return a function as machine code that other machine code calls, under a name of the scene's own.

        Code from disk is linked by its names: two scenes must not share any.
        """
        inline = "always" if function.__name__ in PARTS else "never"
        name = f"{function.__name__}_{file.parent.name}"
        named = FunctionType(function.__code__, function.__globals__, name, None, function.__closure__)
        named.__qualname__ = name
        # where nothing allocates, nothing need count references to arrays: that takes longer than most operations
        return numba.njit(error_model="numpy", _nrt=False, inline=inline, **INNER)(named)

    row = 0
    for name, code in codes.items():
        if len(code.assignments) > LONG:
            function, length = function_by_operations(code, stride, made)
            row = max(row, length)
        else:
            function = compiled_source(texts[name], np)
        own[f"{name}_of"] = made(function)
    # numba keeps what is called from a text with a file, if it has nothing but that text from around it
    take = compiled_source(TAKE, np, {"take_steps": read(own, made)}, str(file))
    take.__name__ = take.__qualname__ = f"take_{file.parent.name}"
    steps = numba.njit(error_model="numpy", _nrt=False, no_cfunc_wrapper=True, cache=_keep(file))(take)
    return steps, row


PARTS = (
    *("accelerations_of", "corrections_of", "accelerations_at", "finish"),
    *("solve", "residual", "correct", "renew", "advance"),
)
"""What becomes a part of what calls it: to hand over all the arrays of a program and its room takes a while."""

TAKE = """def take(program, steps, room, states, told):
 take_steps(program, steps, room, states, told)
"""
"""A function of the scene's own name in front of the loop that takes steps: what numba keeps on disk goes by it."""


def _kept_file(made_of: object) -> Path:
    """Return the file beside which numba keeps a scene's code: its name stands for all that makes it."""
    import hashlib  # which takes time that a command without compiled runs need not wait
    from importlib.metadata import version

    # every file of this room, so that no number that one of them lends can be forgotten, and the options of numba
    room = sorted(Path(__file__).parent.glob("*.py*"))
    made_from = [file.read_bytes() for file in (*room, Path(compiling.__file__), Path(stabilising.__file__))]
    made_from += [repr(each).encode() for each in (made_of, sys.version, version("numba"), version("llvmlite"))]
    name = hashlib.sha256(b"\0".join(made_from)).hexdigest()
    home = os.environ.get("XDG_CACHE_HOME") or os.environ.get("LOCALAPPDATA") or Path.home() / ".cache"
    return Path(home) / "bezstab" / name / "steps.py"


def _keep(file: Path) -> bool:
    """Make the place where numba keeps a scene's code; return whether that is the user's alone, so that it is used.

    The file itself is empty and is never read: what runs is the text that this process has made.
    """
    try:
        file.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        file.touch(mode=0o600)
        about = file.parent.stat()
    except OSError:
        return False
    return not hasattr(os, "getuid") or (about.st_uid == os.getuid() and not about.st_mode & 0o022)
