"""Studies are tested on a stand-in for the pipeline; see fake.py."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
