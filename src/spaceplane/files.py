"""Folders and files that are written whole or not at all, and files that a user hands in."""

from __future__ import annotations

import csv
import json
import os
import tempfile
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from spaceplane.errors import InputError


def writable_folder(path: Path | str, name: str = "out") -> Path:
    """Make the folder if it is missing and try to write into it, before anything is computed.

    Args:
        path: the folder.
        name: of the option or field that asks for it, for the message.

    Raises:
        InputError: it is a file, or cannot be made or written.
    """
    folder = Path(path)
    if folder.exists() and not folder.is_dir():
        raise InputError(f"{name}: {folder} is a file, a folder is needed")
    with told(folder, name):
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder) as probe:
            probe.write(b"spaceplane")
    return folder


@contextmanager
def told(path: Path | str, name: str = "out") -> Iterator[None]:
    """Turn the operating system's refusal to write `path` into an InputError that names it."""
    try:
        yield
    except OSError as error:
        raise InputError(f"{name}: {path} cannot be written ({error.strerror or error})") from error


@contextmanager
def renamed_when_done(path: Path) -> Iterator[Path]:
    """A name beside `path` to write to; it takes `path`'s place only when the block ends well."""
    partial = path.with_name(f".{path.stem}-{os.getpid()}{path.suffix}")
    try:
        yield partial
        partial.replace(path)
    finally:
        partial.unlink(missing_ok=True)


def write_text(text: str, path: Path) -> None:
    """Write all or nothing, UTF-8.

    Raises:
        OSError: the file cannot be written.
    """
    with renamed_when_done(path) as partial:
        partial.write_text(text, encoding="utf-8")


def write_csv(rows: Iterable[Mapping[str, Any]], path: Path) -> None:
    """Write rows with named columns as CSV, all or nothing; missing values and None are empty. No rows, an empty file.

    Raises:
        OSError: the file cannot be written.
    """
    rows = list(rows)
    columns = list(dict.fromkeys(name for row in rows for name in row))
    with renamed_when_done(path) as partial, partial.open("w", newline="", encoding="utf-8") as file:
        if columns:
            writer = csv.DictWriter(file, columns, restval="", lineterminator="\n")
            writer.writeheader()
            writer.writerows({name: "" if value is None else value for name, value in row.items()} for row in rows)


def json_text(value: Any) -> str:
    """A record as JSON, for people and machines.

    Raises:
        ValueError: a number is not finite.
    """
    return json.dumps(value, indent=1, allow_nan=False, ensure_ascii=False) + "\n"


def read_yaml(path: Path | str, what: str) -> dict:
    """The keys of a YAML file; none for an empty one.

    Args:
        path: the file.
        what: it should be, for the message, such as "vehicle file".

    Raises:
        InputError: missing, not readable, not YAML, or no keys.
    """
    import yaml

    try:
        content = yaml.safe_load(Path(path).read_text(encoding="utf-8"))
    except FileNotFoundError as error:
        raise InputError(f"{what} '{path}': does not exist") from error
    except (OSError, UnicodeDecodeError) as error:
        reason = getattr(error, "strerror", None) or "not a text file"
        raise InputError(f"{what} '{path}': cannot be read ({reason})") from error
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        line = f" at line {mark.line + 1}" if mark else ""
        raise InputError(f"{what} '{path}': not YAML{line} ({getattr(error, 'problem', None) or error})") from error
    if content is None:
        return {}
    if not isinstance(content, dict):
        raise InputError(f"{what} '{path}': must hold keys (name: value), has {type(content).__name__}")
    return content
