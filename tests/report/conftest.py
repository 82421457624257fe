"""A result folder made once for all tests of the report."""

from __future__ import annotations

from pathlib import Path

import pytest

from .example_result import write_example


@pytest.fixture(scope="session")
def out_dir(tmp_path_factory) -> Path:
    return write_example(tmp_path_factory.mktemp("example"))
