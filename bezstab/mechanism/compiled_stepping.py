"""The loop of `stepping` as machine code, by numba: one compilation a scene, whatever the methods.

Its operations are loops over entries, innermost those over lanes, of which a processor takes several at once. What
numba makes of a scene is kept in the user's cache folder, under a name that is the hash of all that it is made from.
"""

import hashlib
import math
import os
import sys
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import Any

from bezstab import compiling, stabilising
from bezstab.compiling import INNER, check_numba, compiled_choice, compiler, numba_is_installed
from bezstab.mechanism.compiled import Mechanism
from bezstab.mechanism.generated_code import CODES, TAKE, MachineCode, compiled_source, machine_code
from bezstab.mechanism.stepping import TakeSteps, read
from bezstab.methods import Method, implicit
from bezstab.stabilising import NOTHING, AfterStep

WORTH_COMPILING = 3 * 10**5
"""Evaluations of a run: Python takes as long for so many as numba takes to be loaded and to compile the scene.

Both grow with the mechanism alike."""

WORTH_LOADING = 10**5
"""The same where the scene's code is kept from before."""

ITERATIONS_OF_A_SOLUTION = 4
"""Evaluations that Newton's method usually takes for each of an implicit method's, or more."""

CHEAPER_TOGETHER = 20
"""Times: what an evaluation costs in a batch of numpy, against one of a run alone in Python."""

LANES = 32
"""Runs side by side: what they remember stays in the fastest memory."""

_compiled: set[tuple[Mechanism, tuple[str, ...], int]] = set()
"""What this process has compiled or loaded: with which functions of a state, and for how many runs together."""


def functions_called(solving: bool, after: AfterStep) -> tuple[str, ...]:
    """Return the functions of a state that steps call: if equations are solved, and with this after each step."""
    return ("accelerations", *(("slope",) if solving else ()), *after.calls)


def runs_compiled(
    mechanism: Mechanism, method: Method, evaluations: int, after: AfterStep = NOTHING, together: bool = False
) -> bool:
    """Return whether a run, or runs together, of so many evaluations are to be compiled. InputError if that cannot be.

    That is without numba. By default where numba is there and it pays: the run is long, or its scene has been compiled
    before. `evaluations` do not include what iterations and projections take. InputError, too, where BEZSTAB_COMPILED
    says neither auto nor yes nor no.
    """
    choice = compiled_choice()
    if choice == "no":
        return False
    if choice == "yes":
        check_numba()
        return True
    if not numba_is_installed():
        return False
    solving = implicit(method)
    stride = LANES if together else 1
    names = functions_called(solving, after)
    if (mechanism, names, stride) in _compiled:
        return True
    if together:
        evaluations //= CHEAPER_TOGETHER
    if solving:
        evaluations *= ITERATIONS_OF_A_SOLUTION
    if evaluations < WORTH_LOADING:
        return False
    return evaluations >= WORTH_COMPILING or _is_kept(_kept_file(mechanism, names, stride))


CALLED_OFTEN = ("combine", "arguments", "copy", "take", "add_sizes", "invert_one", "correct", "shift")
"""What the loop calls from several places, besides the functions of a state, which are long."""


@cache
def machine_steps(mechanism: Mechanism, names: tuple[str, ...], stride: int) -> tuple[TakeSteps, int]:
    """Return the function that takes a mechanism's steps as machine code, and how large a room its variables need.

    `names`: with which functions of a state; `stride`: for how many runs side by side. What is compiled is kept for the
    next process. InputError without numba.
    """
    numba = compiler()
    code = _code(mechanism, names, stride)
    file = _kept_file(mechanism, names, stride)
    n = mechanism.size

    def made(function: Any) -> Any:
        """Return a function as machine code that other machine code calls, under a name of the scene's own.

        Code from disk is linked by its names: two scenes must not share any. What is called from one place becomes a
        part of what calls it, and so is compiled once.
        """
        inline = "never" if function.__name__ in (*CALLED_OFTEN, *code.names) else "always"
        function.__name__ = function.__qualname__ = f"{function.__name__}_{file.parent.name}"
        # where nothing allocates, nothing need count references to arrays: that takes longer than most operations
        return numba.njit(error_model="numpy", _nrt=False, inline=inline, **INNER)(function)

    own: dict[str, Any] = {"N": n, "STRIDE": stride, "WIDTH": n * stride, "ALONE": stride == 1}
    generated = compiled_source(code.source, math, code.tables)
    for name in code.names:
        own[name] = generated[name] = made(generated[name])
    # numba keeps what is called from a text with a file, if it has nothing but that text from around it
    take = compiled_source(TAKE, math, {"take_steps": read(own, made)}, str(file))["take"]
    take.__name__ = take.__qualname__ = f"take_{file.parent.name}"
    steps = numba.njit(error_model="numpy", _nrt=False, no_cfunc_wrapper=True, cache=_keep(file))(take)
    _compiled.add((mechanism, names, stride))
    return steps, code.size


@cache
def _code(mechanism: Mechanism, names: tuple[str, ...], stride: int) -> MachineCode:
    """Return the text of a mechanism's own functions."""
    return machine_code({name: CODES[name](mechanism.equations) for name in names}, stride)


@cache
def _kept_file(mechanism: Mechanism, names: tuple[str, ...], stride: int) -> Path:
    """Return the file beside which numba keeps a scene's code: its name stands for all that makes it."""
    code = _code(mechanism, names, stride)
    # every file of this room, so that no number that one of them lends can be forgotten, and the options of numba
    room = sorted(Path(__file__).parent.glob("*.py"))
    made_from = [file.read_bytes() for file in (*room, Path(compiling.__file__), Path(stabilising.__file__))]
    made_from += [code.source.encode(), *(table.tobytes() for table in code.tables.values())]
    made_from += [each.encode() for each in (sys.version, version("numba"), version("llvmlite"))]
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


def _is_kept(file: Path) -> bool:
    """Return whether there is code of a scene from before."""
    return any(file.parent.glob("**/*.nbi"))
