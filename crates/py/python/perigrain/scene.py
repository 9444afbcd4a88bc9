"""perigrain's own scene: a deck continued from Python, with arrays, values, tables and pictures."""

from __future__ import annotations

import os
import tempfile
from typing import Any, Dict, Iterator, List, Optional, Sequence, Union

from .errors import DataError
from .lmp import lammps
from .reading import Frame, Table, frame_of, joined

Value = Union[str, int, float, Sequence[Union[str, int, float]]]


class Picture(bytes):
    """A PNG that notebooks display; ``save(path)`` writes it."""

    def _repr_png_(self) -> bytes:
        return bytes(self)

    def save(self, path: Union[str, "os.PathLike[str]"]) -> None:
        """Writes it to a file."""
        with open(path, "wb") as file:
            file.write(self)

    def __repr__(self) -> str:
        return f"<Picture of {len(self)} bytes>"

    __str__ = __repr__


class Scene:
    """A deck that has been executed, and its continuation from Python.

    >>> scene = Scene(text, variables={"v": 30})
    >>> for step in scene.steps(1000, every=100):
    ...     print(step, scene["ke"])
    >>> scene.picture("c_damage")

    ``scene["ke"]`` is the value of a thermo keyword, of ``c_ID``, ``f_ID``, ``v_NAME`` or of a formula; columns
    of particles (``scene.x``, ``scene.v``, ``scene.id`` …) are read-only views of its memory.
    ``scene.lammps`` is the same scene with the methods of LAMMPS' module.
    """

    def __init__(
        self,
        deck: str = "",
        *,
        variables: Optional[Dict[str, Value]] = None,
        log: Optional[str] = None,
        screen: bool = False,
        threads: Optional[int] = None,
    ) -> None:
        words: List[str] = ["-log", log or "none"]
        words += [] if screen else ["-screen", "none"]
        words += [] if threads is None else ["-threads", str(threads)]
        for name, value in (variables or {}).items():
            several = value if isinstance(value, (list, tuple)) else [value]
            words += ["-var", name, *map(str, several)]
        self.lammps = lammps(cmdargs=words)
        self.lammps._scene.keep_rows()
        if deck:
            self.do(deck)

    def do(self, lines: str) -> "Scene":
        """Executes lines of a deck."""
        self.lammps.commands_string(lines)
        return self

    def file(self, path: Union[str, "os.PathLike[str]"]) -> "Scene":
        """Executes a deck from a file."""
        self.lammps.file(path)
        return self

    def run(self, steps: int) -> "Scene":
        """Runs steps."""
        self.lammps.command(f"run {_whole(steps)}")
        return self

    def statics(self, steps: int, **words: object) -> "Scene":
        """Makes load steps; words are those of the command, as in `scene.statics(10, time=1.0, control="damage")`."""
        rest = " ".join(f"{name.rstrip('_')} {value}" for name, value in words.items())
        self.lammps.command(f"statics {_whole(steps)} {rest}".rstrip())
        return self

    def steps(self, steps: int, every: int = 1) -> Iterator[int]:
        """Runs steps, and yields the step number before the first, after every `every` steps, and after the last.

        The steps are those of a single run, to the bit, if the scene is only read in between.
        """
        steps, every = _whole(steps), _whole(every)
        if every < 1 or steps < 0:
            raise DataError(f"{steps} steps cannot be looked at every {every}")
        last = self.step + steps
        self.lammps.command("run 0 post no")
        while True:
            yield self.step
            left = last - self.step
            if left <= 0:
                return
            before = self.step
            self.lammps.command(f"run {min(every, left)} post no")
            if self.step == before:
                # a fix or the limit of `timer` has ended it
                return

    @property
    def table(self) -> Table:
        """The thermo output of all runs so far; a row that a second run repeats counts once.

        If runs have different columns, missing values are NaN; ``runs`` has the rows of each set of columns.
        """
        import numpy

        def column(whole: bool, data: bytes) -> Any:
            numbers = numpy.frombuffer(bytearray(data), dtype=numpy.float64)
            return numbers.astype(numpy.int64) if whole else numbers

        tables = self.lammps._scene.rows()
        return joined([Table({name: column(whole, data) for name, whole, data in table}) for table in tables])

    @property
    def step(self) -> int:
        """The step number."""
        return self.lammps.extract_global("ntimestep")

    @property
    def time(self) -> float:
        """Elapsed time."""
        return self.lammps.extract_global("atime")

    @property
    def box(self) -> Any:
        """The bounds of the box: one row of lower and upper bound per axis."""
        import numpy

        lo, hi, *_ = self.lammps.extract_box()
        return numpy.array([lo, hi]).T

    def __len__(self) -> int:
        return self.lammps.get_natoms()

    def __getitem__(self, formula: str) -> float:
        return self.lammps.eval(formula)

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_") or "lammps" not in self.__dict__:
            raise AttributeError(name)
        found = self.lammps.numpy.extract_atom(name)
        if found is None:
            raise AttributeError(f"neither a method nor a column of these particles: `{name}`")
        found.flags.writeable = False
        return found

    def frame(self) -> Frame:
        """A copy of all current particle data."""
        return frame_of(self.lammps)

    def compute(self, id_: str) -> Any:
        """The result of a compute: its scalar, vector, array, or per-atom values (a copy), whichever it has first."""
        scalar, *rest = self.lammps._scene.compute(id_)
        return _first(scalar, rest)

    def fix(self, id_: str) -> Any:
        """The same for a fix."""
        scalar, *rest = self.lammps._scene.fix(id_)
        return _first(scalar, rest)

    def calibrate(self, words: str) -> Any:
        """Runs `calibrate` with an id of its own; returns the vector of results, beginning with `c_ID[1]`.

        >>> scene.calibrate("dsm all axis z strain -0.01")[0]
        """
        method, _, rest = words.strip().partition(" ")
        self.lammps.command(f"calibrate {method} python_calibrate {rest}")
        return self.compute("python_calibrate")

    def picture(self, colour: str = "type", diameter: str = "auto", *, size: Sequence[int] = (800, 600), words: str = "") -> Picture:
        """A picture of all particles; `words` are those of `dump image` (`view 60 30 map damage …`)."""
        width, height = (int(n) for n in size)
        with tempfile.TemporaryDirectory(prefix="perigrain-") as folder:
            path = os.path.join(folder, "picture.png")
            self.lammps.command(f'write_dump all image "{path}" {colour} {diameter} size {width} {height} {words}'.rstrip())
            with open(path, "rb") as file:
                return Picture(file.read())

    def _repr_png_(self) -> Optional[bytes]:
        return bytes(self.picture()) if len(self) else None

    def __repr__(self) -> str:
        if self.lammps._scene.ended is not None:
            return "<Scene, closed>"
        return f"<Scene of {len(self)} particles at step {self.step}>"

    def close(self) -> None:
        """Closes the scene."""
        self.lammps.close()

    def __enter__(self) -> "Scene":
        return self

    def __exit__(self, *_: Any) -> None:
        self.close()


def _whole(steps: Any) -> int:
    """Checks a number of steps: 1e4 is valid, 10.5 is not."""
    try:
        if int(steps) == steps:
            return int(steps)
    except (TypeError, ValueError, OverflowError):
        pass
    raise DataError(f"{steps!r} is no whole number of steps")


def _first(scalar: Optional[float], rest: List[Any]) -> Any:
    import numpy

    vector, *tables = rest
    if vector is not None:
        return numpy.frombuffer(bytearray(vector), dtype=numpy.float64)
    if scalar is not None:
        return scalar
    for table in tables:
        if table is not None:
            data, cols = table
            flat = numpy.frombuffer(bytearray(data), dtype=numpy.float64)
            return flat if cols <= 1 else flat.reshape(-1, cols)
    return None


def calibrate(deck: str, words: str, **options: Any) -> Any:
    """Executes a deck, runs `calibrate`, and returns the vector of results: ``calibrate(deck, "dsm all axis z strain 1e-3")``."""
    with Scene(deck, **options) as scene:
        return scene.calibrate(words)
