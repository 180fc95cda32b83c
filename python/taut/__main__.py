"""python -m taut: the command taut, which lies beside the module."""

import os
import sys

os.environ.setdefault("TAUT_PYTHON", sys.executable)  # which draws
os.execv(os.path.join(os.path.dirname(__file__), "bin", "taut"), ["taut", *sys.argv[1:]])
