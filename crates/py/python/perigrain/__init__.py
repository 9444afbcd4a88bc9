"""perigrain in Python: decks in LAMMPS' language for fracture, erosion, grains and bonded particles.

``lammps`` has the methods of LAMMPS' own Python module, so that scripts written for it run with one import changed;
``Scene``, ``check``, ``plan`` and the readers are perigrain's own.
"""

from ._core import VERSION as __version__
from .benching import BenchError, bench
from .constants import *  # noqa: F403  at the top level, as in LAMMPS' module
from .errors import BusyError, ClosedError, DataError, DeckError, InternalError, PerigrainError, StaleError
from .lmp import lammps
from .looking import Problem, Report, check, plan
from .reading import Frame, Table, read_dump, read_log, read_restart
from .scene import Picture, Scene, calibrate

__all__ = [
    "BenchError",
    "BusyError",
    "ClosedError",
    "DataError",
    "DeckError",
    "Frame",
    "InternalError",
    "PerigrainError",
    "Picture",
    "Problem",
    "Report",
    "Scene",
    "StaleError",
    "Table",
    "bench",
    "calibrate",
    "check",
    "lammps",
    "plan",
    "read_dump",
    "read_log",
    "read_restart",
]


def load_ipython_extension(shell):
    """`%load_ext perigrain`."""
    from .magic import load

    load(shell)
