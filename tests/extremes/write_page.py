"""Write figures/extremes.md, what held of all extremes, in minutes: run by `make extremes`."""

from pathlib import Path

from tests.extremes.checks import EXTREMES, Extreme

PAGE = Path(__file__).parents[2] / "figures" / "extremes.md"
HEAD = """# What holds at the extremes

Written by `make extremes`; the slow tests look at a few of each. Each line says what must come out, in how many cases
it did, and which came nearest to failing.

"""


def row(extreme: Extreme) -> str:
    """Return the line about one kind of check, after all of its cases."""
    found = [(case, extreme.check(*case)) for case in extreme.cases]
    held = sum(each.margin >= 0 for _, each in found)
    case, nearest = min(found, key=lambda item: item[1].margin)
    named = ", ".join(str(part) if isinstance(part, str) else f"{part:g}" for part in case)
    return f"- **{extreme.what}:** {extreme.expected}. {held} of {len(found)}; nearest {named}: {nearest.seen}"


if __name__ == "__main__":
    PAGE.write_text(HEAD + "\n".join(map(row, EXTREMES)) + "\n", encoding="utf-8")
