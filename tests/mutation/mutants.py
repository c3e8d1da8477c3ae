"""Mutants: the package with one sign, coefficient, comparison or tolerance changed.

    sign           a + b -> a - b, a * b -> a / b and back; -a -> a; not a -> a
    coefficient    a number: 3 -> 4, 16384 -> 32768, 0.5 -> 0.75, 0.0 -> 1.0
    comparison     a < b -> a >= b (turned round) and a < b -> a <= b (the edge itself)
    tolerance      a number far from one, or the value of a constant in capitals: times 1e4, and times 1e-4

Only what computes is changed: no annotations, messages, docstrings, assertions or reprs.
"""

import ast
import hashlib
from collections import Counter
from dataclasses import dataclass, replace
from itertools import accumulate
from pathlib import Path
from typing import Literal, get_args

ROOT = Path(__file__).resolve().parents[2]
ROOMS = ("methods", "stability", "mechanism", "evidence")

Kind = Literal["sign", "coefficient", "comparison", "tolerance"]
KINDS: tuple[Kind, ...] = get_args(Kind)

OPPOSITE: dict[type[ast.operator], type[ast.operator]] = {
    ast.Add: ast.Sub,
    ast.Sub: ast.Add,
    ast.Mult: ast.Div,
    ast.Div: ast.Mult,
}
TURNED_ROUND: dict[type[ast.cmpop], type[ast.cmpop]] = {
    ast.Lt: ast.GtE,
    ast.LtE: ast.Gt,
    ast.Gt: ast.LtE,
    ast.GtE: ast.Lt,
    ast.Eq: ast.NotEq,
    ast.NotEq: ast.Eq,
}
EDGE: dict[type[ast.cmpop], type[ast.cmpop]] = {
    ast.Lt: ast.LtE,
    ast.LtE: ast.Lt,
    ast.Gt: ast.GtE,
    ast.GtE: ast.Gt,
}
FAR_FROM_ONE = 1e3  # a float beyond it, or below its inverse, is a bound and no coefficient
SMALL = 10  # a larger whole number is a count, which one more or less should not change
MUCH = 1e4  # four decimal places: what a tolerance must not be off by unnoticed


@dataclass(frozen=True)
class Change:
    """An expression and what is to stand in its place."""

    old: ast.expr
    new: ast.expr
    kind: Kind
    function: str


@dataclass(frozen=True)
class Mutant:
    """One change of one file: `path` relative to the root, `line` from one, `source` the whole changed file."""

    path: Path
    line: int
    kind: Kind
    key: str
    source: str


class _Changes(ast.NodeVisitor):
    """Collects the changes worth making, with the name of the function each is in."""

    def __init__(self) -> None:
        self.found: list[Change] = []
        self.function = ""

    def add(self, old: ast.expr, new: ast.expr, kind: Kind) -> None:
        self.found.append(Change(old, new, kind, self.function))

    def visit_FunctionDef(self, node: ast.FunctionDef) -> None:
        if node.name == "__repr__":
            return
        outer = self.function
        self.function = f"{outer}.{node.name}" if outer else node.name
        for default in [*node.args.defaults, *node.args.kw_defaults]:
            if default is not None:
                self.visit(default)
        for statement in node.body:
            self.visit(statement)
        self.function = outer

    def visit_AnnAssign(self, node: ast.AnnAssign) -> None:
        if node.value is not None:
            self.visit(node.value)

    def visit_Assign(self, node: ast.Assign) -> None:
        target, value = node.targets[0], node.value
        if isinstance(target, ast.Name) and target.id.isupper() and _is_float(value):
            self.add_tolerances(value)
        else:
            self.visit(value)

    def visit_Raise(self, node: ast.Raise) -> None:
        """Messages are not mathematics."""

    def visit_Assert(self, node: ast.Assert) -> None:
        """Nor are assertions, which tell the type checker what is known."""

    def visit_JoinedStr(self, node: ast.JoinedStr) -> None:
        """Nor are texts."""

    def visit_BinOp(self, node: ast.BinOp) -> None:
        if type(node.op) in OPPOSITE and not any(_is_sequence(side) for side in (node.left, node.right)):
            self.add(node, ast.BinOp(node.left, OPPOSITE[type(node.op)](), node.right), "sign")
        self.generic_visit(node)

    def visit_UnaryOp(self, node: ast.UnaryOp) -> None:
        if isinstance(node.op, ast.USub | ast.Not):
            self.add(node, node.operand, "sign")
        self.generic_visit(node)

    def visit_Compare(self, node: ast.Compare) -> None:
        for others in (TURNED_ROUND, EDGE):
            if type(node.ops[0]) in others:
                operators = [others[type(node.ops[0])](), *node.ops[1:]]
                self.add(node, ast.Compare(node.left, operators, node.comparators), "comparison")
        self.generic_visit(node)

    def visit_Constant(self, node: ast.Constant) -> None:
        if type(node.value) is int:
            self.add(node, ast.Constant(node.value + 1 if node.value <= SMALL else 2 * node.value), "coefficient")
        elif node.value == 0.0 and isinstance(node.value, float):
            self.add(node, ast.Constant(1.0), "coefficient")
        elif isinstance(node.value, float) and (abs(node.value) > FAR_FROM_ONE or abs(node.value) < 1 / FAR_FROM_ONE):
            self.add_tolerances(node)
        elif isinstance(node.value, float):
            self.add(node, ast.Constant(node.value * 1.5), "coefficient")

    def add_tolerances(self, node: ast.expr) -> None:
        assert isinstance(node, ast.Constant)
        assert isinstance(node.value, float)
        for factor in (MUCH, 1 / MUCH):
            self.add(node, ast.Constant(float(f"{node.value * factor:.12g}")), "tolerance")


def _is_float(node: ast.expr) -> bool:
    return isinstance(node, ast.Constant) and isinstance(node.value, float) and node.value != 0


def _is_sequence(node: ast.expr) -> bool:
    """Return whether an operand is written as a text, list or tuple: its sum or product is no arithmetic."""
    is_text = isinstance(node, ast.Constant) and isinstance(node.value, str)
    return is_text or isinstance(node, ast.JoinedStr | ast.List | ast.Tuple | ast.ListComp)


def mutants_of(path: Path) -> list[Mutant]:
    """Return every mutant of one file of the package, `path` relative to the root."""
    raw = (ROOT / path).read_bytes()
    changes = _Changes()
    changes.visit(ast.parse(raw))
    starts = [0, *accumulate(len(line) + 1 for line in raw.split(b"\n"))]
    mutants = [_mutant(path, raw, starts, change) for change in changes.found]
    times: Counter[str] = Counter()
    for number, mutant in enumerate(mutants):
        times[mutant.key] += 1
        if times[mutant.key] > 1:
            mutants[number] = replace(mutant, key=f"{mutant.key} ({times[mutant.key]})")
    return mutants


def _mutant(path: Path, raw: bytes, starts: list[int], change: Change) -> Mutant:
    """Return the mutant that a change makes; `starts` is where the lines of `raw` begin, in bytes, as ast counts.

    Its key stays when lines move: file, function, line, old, new.
    """
    old, new = change.old, ast.unparse(change.new)
    assert old.end_lineno is not None
    assert old.end_col_offset is not None
    start = starts[old.lineno - 1] + old.col_offset
    end = starts[old.end_lineno - 1] + old.end_col_offset
    changed = raw[:start] + f"({new})".encode() + raw[end:]
    before = " ".join(raw[start:end].decode().split())
    place = f"{path.relative_to('bezstab').as_posix()} {change.function}".strip()
    line = raw[starts[old.lineno - 1] : starts[old.lineno] - 1].decode().strip()
    return Mutant(path, old.lineno, change.kind, f"{place} | {line} | {before} -> {new}", changed.decode())


def all_mutants() -> list[Mutant]:
    """Return the mutants of every file of the four rooms but the doors."""
    files = [path for room in ROOMS for path in sorted((ROOT / "bezstab" / room).glob("*.py"))]
    return [mutant for path in files if path.name != "__init__.py" for mutant in mutants_of(path.relative_to(ROOT))]


def sampled(mutants: list[Mutant], count: int, seed: int) -> list[Mutant]:
    """Return so many mutants, as many of each kind, chosen by a digest of seed and key.

    So each is chosen for itself: a change of one file moves the choice in the others by a few at most.
    """

    def digest(mutant: Mutant) -> bytes:
        return hashlib.sha256(f"{seed} {mutant.key}".encode()).digest()

    chosen: list[Mutant] = []
    for number, kind in enumerate(KINDS):
        share = count // len(KINDS) + (number < count % len(KINDS))
        chosen += sorted((mutant for mutant in mutants if mutant.kind == kind), key=digest)[:share]
    return sorted(chosen, key=digest)
