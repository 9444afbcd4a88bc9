"""`python -m perigrain in.deck`, and `perigrain in.deck` where the module is installed: the program."""

import os
import sys

from . import _core


def main() -> int:
    """Works off the command line; the exit code."""
    # Runs of sweeps are worked off in folders of their own, where this module must be found too.
    home = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
    os.environ["PYTHONPATH"] = os.pathsep.join(filter(None, [home, os.environ.get("PYTHONPATH")]))
    return _core.main([sys.executable, "-m", "perigrain"], sys.argv[1:])


if __name__ == "__main__":
    sys.exit(main())
