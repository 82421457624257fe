"""What names a result: a hash of everything that determines it.

Two computations share a key exactly when their resolved inputs and the numerical source code are the same, so a stored
result is reused only where computing it again would give it again.
"""

from __future__ import annotations

import ast
import hashlib
import json
import math
from functools import cache
from numbers import Integral, Real
from pathlib import Path

from spaceplane.errors import InputError

NUMERICAL_SOURCES = (
    "vehicle",
    "mesh",
    "flow",
    "aero",
    "environment",
    "dynamics",
    "qualities",
    "control",
    "analysis",
    "pipeline.py",
)
"""Packages and modules whose code moves a result. Reports, plots and the command line are left out on purpose."""


def canonical(value: object) -> str:
    """Return one JSON text per value, whatever the order of its keys and the type of its numbers.

    Args:
        value: nested dicts, lists, tuples, strings, booleans, None and real numbers (numpy's included).

    Raises:
        InputError: a number is not finite, or a value has no JSON form.
    """
    return json.dumps(_plain(value), sort_keys=True, separators=(",", ":"), allow_nan=False)


def result_key(inputs: dict, code: str) -> str:
    """Return the key (64 hexadecimal digits, SHA-256) of the result of `inputs` computed by `code`.

    Args:
        inputs: everything that the computation reads, resolved (no defaults left to fill in).
        code: fingerprint of the source that computes it, see `code_fingerprint`.
    """
    return hashlib.sha256(canonical({"inputs": inputs, "code": code}).encode()).hexdigest()


@cache
def code_fingerprint() -> str:
    """Return a hash (16 hexadecimal digits) of the numerical packages' code, comments and docstrings left out."""
    root = Path(__file__).resolve().parent.parent
    files: list[Path] = []
    for name in NUMERICAL_SOURCES:
        path = root / name
        if path.is_dir():
            files += [file for file in path.rglob("*") if file.suffix in {".py", ".csv", ".toml", ".yaml", ".json"}]
        elif path.is_file():
            files.append(path)
    digest = hashlib.sha256()
    for file in sorted(files):
        digest.update(file.relative_to(root).as_posix().encode() + b"\0")
        text = file.read_text(encoding="utf-8")
        digest.update((_code_only(text) if file.suffix == ".py" else text).encode() + b"\0")
    return digest.hexdigest()[:16]


def _code_only(source: str) -> str:
    tree = ast.parse(source)
    for node in ast.walk(tree):
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef):
            node.body = [item for item in node.body if not _is_text(item)] or [ast.Pass()]
    return ast.unparse(tree)


def _is_text(node: ast.stmt) -> bool:
    return isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, str)


def _plain(value: object) -> object:
    if value is None or isinstance(value, str | bool):
        return value
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, dict):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    if isinstance(value, bool):
        return value
    if isinstance(value, Integral | Real):
        number = float(value)
        if not math.isfinite(number):
            raise InputError(f"case: {value} is not a finite number")
        return number + 0.0  # -0.0 and 0.0 are the same input
    if isinstance(value, Path):
        return value.as_posix()
    raise InputError(f"case: {value!r} of type {type(value).__name__} cannot be stored")
