import pytest

from bezstab.lazy import lazy_names

load = lazy_names("bezstab.methods")


def test_a_name_is_that_of_the_module_that_defines_it() -> None:
    from bezstab.methods.orders import accuracy

    assert load("accuracy") is accuracy


def test_any_other_name_is_an_attribute_error_that_names_both() -> None:
    with pytest.raises(AttributeError, match=r"module 'bezstab\.methods' has no attribute 'rational'"):
        load("rational")
