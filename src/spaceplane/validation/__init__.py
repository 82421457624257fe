"""Why to trust it: published and exact cases, run by `spaceplane validate`."""

from spaceplane.validation.cases import CASES, run
from spaceplane.validation.page import markdown_page, write
from spaceplane.validation.records import Record, markdown_table, passed, read

__all__ = ["CASES", "Record", "markdown_page", "markdown_table", "passed", "read", "run", "write"]
