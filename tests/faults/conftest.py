"""Makes the helpers in tests/support importable."""

import sys
from pathlib import Path

sys.path += [str(Path(__file__).parents[1] / "support"), str(Path(__file__).parents[2])]
