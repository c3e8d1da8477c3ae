"""One vocabulary: every word has one meaning, and every meaning one word."""

import re

from bezstab.show import VOCABULARY
from bezstab.show.schemas import ROW_KINDS

USED = {key for kinds in ROW_KINDS.values() for kind in kinds for key in (*kind.keys, *kind.added)}


def test_every_key_of_every_command_is_a_word_and_every_word_a_key() -> None:
    assert set(VOCABULARY) == USED


def test_no_two_words_mean_the_same() -> None:
    meanings = [key.meaning.lower() for key in VOCABULARY.values()]
    assert len(set(meanings)) == len(meanings)


def test_a_word_is_plain_and_its_meaning_a_sentence() -> None:
    for name, key in VOCABULARY.items():
        assert re.fullmatch(r"[a-z][a-z_]*", name), name
        assert key.meaning[0].isupper(), name
        assert not key.meaning.endswith("."), name
        assert key.description.endswith("."), name
        assert key.description.isascii(), name


def test_moduli_and_angles_of_poles_are_called_alike() -> None:
    for name, key in VOCABULARY.items():
        if re.search("modulus of the .*pole|modulus predicted|exact modulus", key.meaning, re.IGNORECASE):
            assert "z_abs" in name or name == "worst", name
        if name.endswith("_deg"):
            assert name.endswith("z_angle_deg")
            assert key.unit == "degrees"


def test_what_has_a_unit_says_so_in_its_description() -> None:
    assert VOCABULARY["h_limit"].description.startswith(
        "Largest step that is stable at this alpha and beta, in s; null "
    )
    for name in ("h", "time", "seconds", "settle_seconds", "pivot_time", "h_limit"):
        assert VOCABULARY[name].unit == "s"
    for name in ("alpha", "beta", "kappa"):
        assert ", in 1/s" in VOCABULARY[name].description


def test_every_verdict_comes_with_whether_it_is_safe() -> None:
    for kinds in ROW_KINDS.values():
        assert all("safe" in kind.keys for kind in kinds if "verdict" in kind.keys)
