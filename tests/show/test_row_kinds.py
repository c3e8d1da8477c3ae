"""One vocabulary: every key has one meaning, and every meaning one key."""

import re

import pytest

from bezstab.show import FIELDS, ROW_KINDS

KINDS = [kind for kinds in ROW_KINDS.values() for kind in kinds]


@pytest.mark.promise("Keys of JSON and CSV")
def test_a_key_is_the_same_in_every_kind_of_row() -> None:
    for kind in KINDS:
        keys = [field.key for field in (*kind.fields, *kind.added)]
        assert len(set(keys)) == len(keys), kind.title
        for field in (*kind.fields, *kind.added):
            first = FIELDS[field.key]
            for name in ("kind", "meaning", "unit", "null", "values", "values_of"):
                assert getattr(field, name) == getattr(first, name), field.key


def test_no_two_words_mean_the_same() -> None:
    meanings = [key.meaning.lower() for key in FIELDS.values()]
    assert len(set(meanings)) == len(meanings)


def test_a_word_is_plain_and_its_meaning_a_sentence() -> None:
    for name, key in FIELDS.items():
        assert re.fullmatch(r"[a-z][a-z_]*", name), name
        assert key.meaning[0].isupper(), name
        assert not key.meaning.endswith("."), name
        assert key.description.endswith("."), name
        assert key.description.isascii(), name


def test_moduli_and_angles_of_poles_are_called_alike() -> None:
    for name, key in FIELDS.items():
        if re.search("modulus of the .*pole|modulus predicted|exact modulus", key.meaning, re.IGNORECASE):
            assert "z_abs" in name or name == "worst", name
        if name.endswith("_deg"):
            assert name.endswith("z_angle_deg")
            assert key.unit == "degrees"


def test_what_has_a_unit_says_so_in_its_description() -> None:
    assert FIELDS["h_limit"].description.startswith("Largest step that is stable at this alpha and beta, in s; null ")
    for name in ("h", "time", "seconds", "settle_seconds", "pivot_time", "h_limit"):
        assert FIELDS[name].unit == "s"
    for name in ("alpha", "beta", "kappa"):
        assert ", in 1/s" in FIELDS[name].description


def test_every_verdict_comes_with_whether_it_is_safe() -> None:
    for kind in KINDS:
        keys = {field.key for field in kind.fields}
        assert "safe" in keys or "verdict" not in keys
