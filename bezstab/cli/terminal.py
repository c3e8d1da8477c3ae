"""What a terminal can show: words for characters that its encoding lacks, escapes for those that would command it."""

import codecs
import io
import os
import re
import sys
import unicodedata
from typing import TextIO

BREAK = "\N{ZERO WIDTH SPACE}"
"""Stands in a word where a letter or a digit beside it would run together with it: there it becomes a space."""

WORDS = {
    "\N{COMBINING CIRCUMFLEX ACCENT}": f"_hat{BREAK}",
    "\N{COMBINING DIAERESIS}": f"ddot{BREAK}",
    "ċ": f"{BREAK}cdot{BREAK}",
    "λ": f"{BREAK}lambda{BREAK}",  # Unicode's own name of it is LAMDA
    "∠": f"{BREAK}angle{BREAK}",
    "√": f"{BREAK}sqrt{BREAK}",
    "∞": f"{BREAK}infinity{BREAK}",
    "°": f"{BREAK}deg{BREAK}",
    "²": f"^2{BREAK}",
    "³": f"^3{BREAK}",
    "⁴": f"^4{BREAK}",
    "₁": f"_1{BREAK}",
    "₂": f"_2{BREAK}",
    "₃": f"_3{BREAK}",
    "±": "+-",
    "×": "x",
    "·": "*",
    "−": "-",
    "–": "-",
    "—": "-",
    "→": "->",
    "≤": "<=",
    "≥": ">=",
    "…": "...",
    "“": '"',
    "”": '"',
    "’": "'",
}
"""How characters of ours are spelled where an encoding lacks them; Greek letters are called by their names."""

GREEK = "GREEK SMALL LETTER "


def spelled(text: str, encoding: str) -> str:
    """Return the text with words for what an encoding such as ascii lacks: α̂ = 2αh becomes alpha_hat = 2 alpha h.

    A letter with an accent loses it; what has no word is escaped: \\u4e2d.
    """
    if _has(encoding, text):
        return text
    words = (character if _has(encoding, character) else _word(character, encoding) for character in text)
    separated = re.sub(f"(?<=[A-Za-z0-9]){BREAK}+(?=[A-Za-z0-9])", " ", "".join(words))
    return separated.replace(BREAK, "")


def visible(text: str) -> str:
    """Return the text on one line, without what would command a terminal: a line's end is \\n, the escape \\x1b."""
    return "".join(
        character if unicodedata.category(character) not in ("Cc", "Zl", "Zp") else _escaped(character)
        for character in text
    )


def text_width() -> int | None:
    """Return how many characters a line on standard output can have; None where nothing says, as on a pipe.

    COLUMNS, if it is set to a positive number, counts more than the terminal, as everywhere.
    """
    columns = os.environ.get("COLUMNS", "")
    if columns.isdecimal() and int(columns) > 0:
        return int(columns)
    try:
        return os.get_terminal_size(sys.stdout.fileno()).columns or None  # a terminal may not know: 0
    except (OSError, ValueError):  # no terminal, or no file at all
        return None


def output_encoding() -> str:
    """Return the encoding of what standard output can show."""
    stream = sys.stdout
    return stream.shown_encoding if isinstance(stream, SpellingStream) else stream.encoding


class SpellingStream(io.TextIOWrapper):
    """A standard stream that spells what its encoding lacks, instead of failing; its errors carry its name."""

    def __init__(self, stream: io.TextIOWrapper, title: str) -> None:
        self.title = title
        self.shown_encoding = stream.encoding
        is_ascii = codecs.lookup(stream.encoding).name == "ascii"
        line_buffering, write_through = stream.line_buffering, stream.write_through
        super().__init__(
            stream.detach(),
            encoding="utf-8" if is_ascii else stream.encoding,  # click takes ascii for a mistake and writes UTF-8
            errors="backslashreplace",
            line_buffering=line_buffering,
            write_through=write_through,
        )

    def write(self, text: str, /) -> int:
        """Write a text, spelled."""
        try:
            return super().write(spelled(text, self.shown_encoding))
        except OSError as error:
            error.filename = self.title
            raise

    def flush(self) -> None:
        """Hand what was written to the system."""
        try:
            super().flush()
        except OSError as error:
            error.filename = self.title
            raise


def prepare_streams() -> None:
    """Make the standard streams of this process fit for any text.

    A closed standard error is silent. With a closed standard output there is nowhere to answer: one line, exit
    status 2. The descriptor of a closed stream is taken, or the next file that is opened would get it, and with it
    what libraries print there.
    """
    for descriptor in (0, 1, 2):
        try:
            os.fstat(descriptor)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # it gets the lowest number that is free, which is this one
    sys.stderr = _prepared(sys.stderr, "standard error") or open(os.devnull, "w", encoding="utf-8")  # noqa: SIM115
    answers = _prepared(sys.stdout, "standard output")
    if answers is None:
        sys.stderr.write("bezstab: standard output is closed: there is nowhere to answer\n")
        sys.exit(2)
    sys.stdout = answers


def _prepared(stream: TextIO | None, title: str) -> TextIO | None:
    return SpellingStream(stream, title) if isinstance(stream, io.TextIOWrapper) else stream


def _has(encoding: str, text: str) -> bool:
    """Return whether the encoding has every character of the text."""
    try:
        text.encode(encoding)
    except UnicodeEncodeError:
        return False
    return True


def _word(character: str, encoding: str) -> str:
    """Return what stands for a character that the encoding lacks."""
    if character in WORDS:
        return WORDS[character]
    name = unicodedata.name(character, "")
    if name.startswith(GREEK) and name.count(" ") == GREEK.count(" "):  # one word after it: no accent
        return f"{BREAK}{name.removeprefix(GREEK).lower()}{BREAK}"
    plain = "".join(part for part in unicodedata.normalize("NFKD", character) if not unicodedata.combining(part))
    return plain if plain and _has(encoding, plain) else _escaped(character)


def _escaped(character: str) -> str:
    return character.encode("unicode_escape").decode("ascii")
