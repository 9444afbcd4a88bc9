"""`python -m perigrain in.deck`: the program, where only the module is installed."""

import os
import sys

from . import _core

# Runs of sweeps are worked off in folders of their own, where this module must be found too.
_home = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
os.environ["PYTHONPATH"] = os.pathsep.join(filter(None, [_home, os.environ.get("PYTHONPATH")]))

sys.exit(_core.main([sys.executable, "-m", "perigrain"], sys.argv[1:]))
