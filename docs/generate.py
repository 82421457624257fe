"""Rebuild the generated tables of the documentation and the README from the code and from stored results.

    python docs/generate.py            rewrite every generated block
    python docs/generate.py --check    exit 1 and name the pages that are out of date
    python docs/generate.py --store-demo out/horus-2b/result.json
    python docs/generate.py --store-validation out/validation/validation.json

A block stands between `<!-- generated: NAME -->` and `<!-- end generated -->`; NAME is a function of BLOCKS.
"""

from __future__ import annotations

import argparse
import json
import re
import sys
from collections.abc import Callable
from pathlib import Path

DOCS = Path(__file__).resolve().parent
sys.path.insert(0, str(DOCS))

import blocks  # noqa: E402  (beside this script)
import fast_tier_blocks  # noqa: E402
import flying_qualities_blocks  # noqa: E402
import linear_model_blocks  # noqa: E402
import modes_blocks  # noqa: E402
import performance_blocks  # noqa: E402
import real_gas_blocks  # noqa: E402
import study_blocks  # noqa: E402
import uncertainty_blocks  # noqa: E402

PAGES = [*sorted(DOCS.rglob("*.md")), DOCS.parent / "README.md"]
PATTERN = re.compile(r"(<!-- generated: ([a-z0-9 -]+) -->\n).*?(<!-- end generated -->)", re.DOTALL)
BLOCKS: dict[str, Callable[[], str]] = {}
_MODULES = (
    blocks,
    study_blocks,
    fast_tier_blocks,
    flying_qualities_blocks,
    linear_model_blocks,
    modes_blocks,
    performance_blocks,
    real_gas_blocks,
    uncertainty_blocks,
)
for _module in _MODULES:
    BLOCKS |= _module.BLOCKS


MISSING: dict[str, Path] = {}
"""Blocks left as they are because the stored result they show does not exist."""


def rebuilt(text: str) -> str:
    """The page with every generated block made anew."""

    def block(match: re.Match[str]) -> str:
        name = match[2]
        if name not in BLOCKS:
            raise SystemExit(f"unknown generated block {name!r}; known: {', '.join(BLOCKS)}")
        try:
            text = BLOCKS[name]().strip()
        except FileNotFoundError as error:
            MISSING[name] = Path(error.filename)
            return match[0]
        return f"{match[1]}\n{text}\n\n{match[3]}"

    return PATTERN.sub(block, text)


def stale() -> list[Path]:
    """Pages whose generated blocks are out of date."""
    return [page for page in PAGES if rebuilt(text := page.read_text(encoding="utf-8")) != text]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true", help="change nothing; exit 1 when a page is out of date")
    parser.add_argument("--store-demo", type=Path, metavar="RESULT", help="keep what the pages show of a result.json")
    parser.add_argument("--store-validation", type=Path, metavar="FILE", help="keep the records of a validation.json")
    options = parser.parse_args()
    if options.store_demo:
        blocks.store(blocks.DEMO, blocks.demo_extract(json.loads(options.store_demo.read_text(encoding="utf-8"))))
    if options.store_validation:
        blocks.store_validation(options.store_validation)
    old = stale()
    for name, path in MISSING.items():
        print(f"block {name!r} is left as it is: {path.relative_to(DOCS.parent)} does not exist")
    if options.check:
        for page in old:
            print(f"out of date: {page.relative_to(DOCS.parent)}; run python docs/generate.py")
        return 1 if old or MISSING else 0
    for page in old:
        page.write_text(rebuilt(page.read_text(encoding="utf-8")), encoding="utf-8")
        print(f"rewrote {page.relative_to(DOCS.parent)}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
