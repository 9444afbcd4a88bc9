"""`python -m perigrain in.deck`, and `perigrain in.deck` where the module is installed: the program."""

import os
import sys

from . import _core


def main() -> int:
    """Executes the command line; returns the exit code."""
    # Each run of a sweep has its own folder, and must find this module from there.
    home = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
    os.environ["PYTHONPATH"] = os.pathsep.join(filter(None, [home, os.environ.get("PYTHONPATH")]))
    return _core.main([sys.executable, "-m", "perigrain"], sys.argv[1:])


if __name__ == "__main__":
    sys.exit(main())
