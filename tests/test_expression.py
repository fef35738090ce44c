"""Expressions: the same values as Python's own arithmetic, and nothing else gets through."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from garmentcad.errors import ExpressionError, InputError
from garmentcad.pattern.expression import FUNCTIONS, check_grammar, evaluate

NAMES = {"waist": 720.0, "hip": 960.0, "ease": 20.0}


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("(waist + ease) / 2", 370.0), ("-hip/4 + 2*3", -234.0), ("2**3**2", 512.0), ("-2**2", -4.0), ("1e3", 1000.0), (".5 + +1", 1.5),
        ("waist / rad(90)", 720 / (math.pi / 2)), ("deg(atan2(1, 1))", 45.0), ("hypot(3, 4)", 5.0), ("min(3, 1, 2) + max(3, 1)", 4.0),
        ("abs(-3)", 3.0), ("sqrt(2)", math.sqrt(2)), ("sin(rad(30))", 0.5), ("cos(0) + tan(0)", 1.0), ("asin(1) + acos(1) + atan(0)", math.pi / 2),
        ("  waist ", 720.0), (12, 12.0), (2.5, 2.5), ("2 ** -2", 0.25), ("0 ** 0", 1.0),
    ],
)  # fmt: skip
def test_values(text: float | str, value: float) -> None:
    assert evaluate(text, NAMES) == pytest.approx(value, rel=1e-14)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("wast + 1", "did you mean 'waist'"), ("1 / (ease - 20)", "divides by zero"), ("0 ** -1", "divides by zero"), ("sqrt(-4)", "sqrt(-4) is not defined"),
        ("(-8) ** 0.5", "is not defined"), ("10 ** 17", "exponent 17"), ("9e99 ** 16", "too large"), ("1e308 * 10", "must be finite"),
        ("1e999", "must be finite"), ("sqr(2)", "did you mean 'sqrt'"), ("sqrt(1, 2)", "takes 1 values, came 2"), ("min(1)", "takes 2 to 16"),
        ("__import__('os')", "unknown function"), ("().__class__", "is not allowed"), ("waist.real", "is not allowed"), ("[1][0]", "is not allowed"),
        ("lambda: 1", "is not allowed"), ("1 if 2 else 3", "is not allowed"), ("1 < 2", "is not allowed"), ("True", "is not allowed"),
        ("'a' * 9", "is not allowed"),
        ("2j", "is not allowed"), ("7 // 2", "is not allowed"), ("7 % 2", "is not allowed"), ("1 << 9", "is not allowed"), ("~1", "is not allowed"),
        ("sqrt(x=1)", "is not allowed"), ("min(*[1, 2], 3)", "is not allowed"), ("(a := 1)", "is not allowed"), ("f'{1}'", "is not allowed"),
        ("", "not an expression"), ("1 +", "not an expression"), ("1; 2", "not an expression"),
        ("1or 2", "not an expression"), ("1\n2", "not an expression"), ("a\0b", "not an expression"),
        ("wäist", "ASCII"), ("1" * 401, "at most 400"), ("(" * 199 + "1", "not an expression"), ("-" * 200 + "1", "nested deeper"),
        ("+".join("1" * 100), "nested deeper"), ("nan", "unknown name"), ("inf", "unknown name"), (math.nan, "must be finite"),
    ],
)  # fmt: skip
def test_refusals(text: float | str, message: str) -> None:
    with pytest.raises(ExpressionError) as caught:
        evaluate(text, NAMES, key="panels.front.points.left")
    assert message in str(caught.value)
    assert str(caught.value).startswith("panels.front.points.left: ")


def test_grammar_is_checked_without_names() -> None:
    assert check_grammar("unknown_name * 2") is None
    assert "did you mean 'hypot'" in str(check_grammar("hypo(1, 2)"))


@given(st.text(alphabet="0123456789.+-*/() ewaistrdmnx,_", max_size=40))
def test_any_text_gives_python_s_value_or_is_refused(text: str) -> None:
    try:
        value = evaluate(text, NAMES)
    except InputError:
        return
    scope = {name: function for name, (function, _, _) in FUNCTIONS.items()}
    expected = eval(text.strip(), {"__builtins__": {}}, scope | NAMES)
    assert value == pytest.approx(float(expected), rel=1e-12)
