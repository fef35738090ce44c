"""Kernels that Python calls are entries, and no others: what Python needs to call a kernel takes up to half of the time to compile it."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

PACKAGE = Path(__file__).resolve().parent.parent / "garmentcad"
KINDS = {"kernel", "long_kernel", "making_kernel", "row_kernel", "inlined_kernel", "inlined", "parallel_kernel"}


def decorators(function: ast.FunctionDef) -> set[str]:
    return {mark.id for mark in function.decorator_list if isinstance(mark, ast.Name)}


def parsed() -> dict[str, ast.Module]:
    return {".".join(path.relative_to(PACKAGE.parent).with_suffix("").parts): ast.parse(path.read_text(encoding="utf-8")) for path in PACKAGE.rglob("*.py")}


def kernels(tree: ast.Module) -> dict[str, bool]:
    """Kernels of a module by name, and whether they are entries."""
    found = {}
    for node in tree.body:
        if isinstance(node, ast.FunctionDef) and decorators(node) & KINDS:
            found[node.name] = "entry" in decorators(node)
        if isinstance(node, ast.Assign) and isinstance(node.value, ast.Call) and isinstance(node.value.func, ast.Name) and node.value.func.id in KINDS:
            assert isinstance(node.targets[0], ast.Name)
            found[node.targets[0].id] = False
    return found


def called_from_python(node: ast.AST) -> Iterator[str]:
    """Names that are called outside kernels."""
    if isinstance(node, ast.FunctionDef) and decorators(node) & KINDS:
        return
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
        yield node.func.id
    for child in ast.iter_child_nodes(node):
        yield from called_from_python(child)


def test_kernels_that_python_calls_are_entries_and_no_others() -> None:
    trees = parsed()
    entry = {(module, name): is_entry for module, tree in trees.items() for name, is_entry in kernels(tree).items()}
    called = set()
    for module, tree in trees.items():
        known = {name: (module, name) for name in kernels(tree)}
        for node in ast.walk(tree):
            if isinstance(node, ast.ImportFrom):
                known |= {alias.asname or alias.name: (node.module or "", alias.name) for alias in node.names if (node.module, alias.name) in entry}
        called |= {known[name] for name in called_from_python(tree) if name in known}
    assert len(entry) > 100
    assert {kernel for kernel, is_entry in entry.items() if is_entry} == called
