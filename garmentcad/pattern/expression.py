"""Expressions of a spec: arithmetic over named numbers in a safe grammar. Parsed with `ast` and a whitelist of nodes; nothing is ever executed by Python.

Numbers, names, `+ - * / **`, parentheses, and the functions of FUNCTIONS. All numbers are floats, so that no expression can make a huge integer.
"""

from __future__ import annotations

import ast
import math
import warnings
from collections.abc import Callable, Collection, Mapping
from functools import lru_cache

from garmentcad.errors import ExpressionError, did_you_mean

MAX_LENGTH = 400
MAX_DEPTH = 40
MAX_EXPONENT = 16.0

FUNCTIONS: dict[str, tuple[Callable[..., float], int, int]] = {  # function, fewest and most arguments
    "sqrt": (math.sqrt, 1, 1), "sin": (math.sin, 1, 1), "cos": (math.cos, 1, 1), "tan": (math.tan, 1, 1),
    "asin": (math.asin, 1, 1), "acos": (math.acos, 1, 1), "atan": (math.atan, 1, 1), "atan2": (math.atan2, 2, 2),
    "rad": (math.radians, 1, 1), "deg": (math.degrees, 1, 1), "abs": (abs, 1, 1), "hypot": (math.hypot, 2, 2),
    "min": (min, 2, 16), "max": (max, 2, 16),
}  # fmt: skip
_GRAMMAR = f"allowed are numbers, names, + - * / **, parentheses and the functions {', '.join(FUNCTIONS)}"


def evaluate(expression: float | str, names: Mapping[str, float], key: str | None = None, later: Collection[str] = ()) -> float:
    """Value of a number or an expression over `names`. `key` is the place named in errors; `later` are names that get their values only after this one.

    ExpressionError: bad grammar, an unknown name, division by zero, a value outside a function's domain, a result that is not finite.
    """
    try:
        value = _value(_parse(expression), names) if isinstance(expression, str) else float(expression)
    except ZeroDivisionError:
        raise ExpressionError(f"{expression!r} divides by zero", key=key) from None
    except OverflowError:
        raise ExpressionError(f"{expression!r} is too large; results must be finite", key=key) from None
    except _UnknownName as unknown:
        # Of a name that gets its value later no other one is proposed: the order is wrong, or it goes in a circle.
        order = " up to here: parameters get their values first, then values, each from those above it"
        said = order if unknown.name in later else did_you_mean(unknown.name, names)
        raise ExpressionError(f"{str(expression)[:100]!r}: unknown name {unknown.name!r}{said}", key=key) from None
    except _Refusal as refusal:
        raise ExpressionError(f"{str(expression)[:100]!r}: {refusal}", key=key) from None
    if not math.isfinite(value):
        raise ExpressionError(f"{expression!r} gives {value}; results must be finite", key=key)
    return value


def check_grammar(text: str) -> str | None:
    """What is wrong with the form of an expression, or None; names and values are not looked at."""
    try:
        _parse(text)
    except _Refusal as refusal:
        return str(refusal)
    return None


class _Refusal(Exception):
    pass


class _UnknownName(Exception):
    def __init__(self, name: str) -> None:
        self.name = name


@lru_cache(maxsize=4096)
def _parse(text: str) -> ast.expr:
    if len(text) > MAX_LENGTH:
        raise _Refusal(f"the expression has {len(text)} characters; at most {MAX_LENGTH} are allowed")
    if not text.isascii():
        raise _Refusal("only ASCII characters are allowed in expressions")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")  # `1or 2` is refused, not warned about
            body = ast.parse(text.strip(), mode="eval").body
    except (SyntaxError, ValueError, MemoryError, RecursionError):
        raise _Refusal(f"not an expression; {_GRAMMAR}") from None
    _check(body, 0)
    return body


def _check(node: ast.expr, depth: int) -> None:
    """Refuse every node that is not on the whitelist."""
    if depth > MAX_DEPTH:
        raise _Refusal(f"nested deeper than {MAX_DEPTH} levels")
    match node:
        case ast.Constant(value=value) if type(value) in (int, float):
            pass
        case ast.Name():
            pass
        case ast.UnaryOp(op=ast.UAdd() | ast.USub(), operand=operand):
            _check(operand, depth + 1)
        case ast.BinOp(left=left, op=ast.Add() | ast.Sub() | ast.Mult() | ast.Div() | ast.Pow(), right=right):
            _check(left, depth + 1)
            _check(right, depth + 1)
        case ast.Call(func=ast.Name(id=name), args=arguments, keywords=[]):
            if name not in FUNCTIONS:
                raise _Refusal(f"unknown function {name!r}{did_you_mean(name, FUNCTIONS)}")
            _, fewest, most = FUNCTIONS[name]
            if not fewest <= len(arguments) <= most:
                raise _Refusal(f"{name} takes {fewest if fewest == most else f'{fewest} to {most}'} values, came {len(arguments)}")
            for argument in arguments:
                _check(argument, depth + 1)
        case _:
            raise _Refusal(f"{ast.unparse(node)[:60]!r} is not allowed; {_GRAMMAR}")


def _value(node: ast.expr, names: Mapping[str, float]) -> float:
    match node:
        case ast.Constant(value=value):
            return float(value)  # type: ignore[arg-type]
        case ast.Name(id=name):
            if name not in names:
                raise _UnknownName(name)
            return names[name]
        case ast.UnaryOp(op=op, operand=operand):
            value = _value(operand, names)
            return -value if isinstance(op, ast.USub) else value
        case ast.BinOp(left=left, op=op, right=right):
            return _binary(op, _value(left, names), _value(right, names))
        case ast.Call(func=ast.Name(id=name), args=arguments):
            values = [_value(argument, names) for argument in arguments]
            try:
                return FUNCTIONS[name][0](*values)
            except ValueError:
                raise _Refusal(f"{name}({', '.join(f'{value:g}' for value in values)}) is not defined") from None
    raise AssertionError(ast.dump(node))  # _check lets no other node through


def _binary(op: ast.operator, a: float, b: float) -> float:
    match op:
        case ast.Add():
            return a + b
        case ast.Sub():
            return a - b
        case ast.Mult():
            return a * b
        case ast.Div():
            return a / b
    if abs(b) > MAX_EXPONENT:
        raise _Refusal(f"the exponent {b:g} is larger than {MAX_EXPONENT:g}")
    if a < 0.0 and b != int(b):
        raise _Refusal(f"{a:g} ** {b:g} is not defined")
    return math.pow(a, b) if a != 0.0 or b >= 0.0 else a**b  # 0 ** -1 divides by zero
