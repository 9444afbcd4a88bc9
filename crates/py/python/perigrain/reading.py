"""Logs, dumps and restart files as numpy arrays."""

from __future__ import annotations

import gzip
import html
import os
import re
from typing import IO, Any, Dict, Iterator, List, Optional, Tuple, Union

from .errors import DataError

Path = Union[str, "os.PathLike[str]"]

# The lines before the first row of a run, and after its last.
_BEGIN = "Per MPI rank memory allocation"
_END = "Loop time of"


class Table(Dict[str, Any]):
    """A mapping of columns by heading, such as thermo output: ``table["Step"]``, ``pandas.DataFrame(table)``.

    ``len(table)`` is the number of rows, ``table.runs`` has the rows of each run separately.
    """

    def __init__(self, columns: Dict[str, Any], runs: Optional[List["Table"]] = None) -> None:
        super().__init__(columns)
        #: The rows of each `run` separately.
        self.runs: List["Table"] = [self] if runs is None else runs

    @property
    def data(self) -> Dict[str, Any]:
        """The columns as a plain dictionary."""
        return dict(self)

    @property
    def columns(self) -> List[str]:
        """The headings."""
        return list(self)

    def __missing__(self, name: str) -> Any:
        raise DataError(f"there is no column `{name}`: there are {', '.join(self) or 'none'}")

    def __len__(self) -> int:
        return len(next(iter(self.values()), ()))

    __eq__ = object.__eq__
    __ne__ = object.__ne__
    __hash__ = object.__hash__  # type: ignore[assignment]

    def to_pandas(self) -> Any:
        """A `pandas.DataFrame` of it."""
        import pandas

        return pandas.DataFrame(self)

    def __repr__(self) -> str:
        return f"<Table of {len(self)} rows: {', '.join(self)}>"

    def _repr_html_(self) -> str:
        most = 20
        cells = lambda tag, row: "".join(f"<{tag}>{html.escape(str(c))}</{tag}>" for c in row)  # noqa: E731
        rows = [cells("td", [f"{self.data[c][k]:.6g}" for c in self]) for k in range(min(len(self), most))]
        more = f"<caption>{len(self)} rows, the first {most} shown</caption>" if len(self) > most else ""
        return f"<table>{more}<tr>{cells('th', self)}</tr>{''.join(f'<tr>{row}</tr>' for row in rows)}</table>"


def read_log(path: Path) -> Table:
    """All thermo output in a log file of perigrain or LAMMPS (styles `one`, `custom`, `multi`, `yaml`).

    If runs have different columns, missing values are NaN; ``runs`` has each run separately.
    """
    with _opened(path) as file:
        blocks = list(_blocks(file))
    return joined([table for table in map(_rows, blocks) if table is not None])


def joined(runs: List[Table]) -> Table:
    """Concatenates tables by rows."""
    import numpy

    names = list(dict.fromkeys(name for run in runs for name in run))
    columns = {}
    for name in names:
        parts = [run[name] if name in run else numpy.full(len(run), numpy.nan) for run in runs]
        columns[name] = numpy.concatenate(parts)
    return Table(columns, runs)


def _blocks(lines: Any) -> Iterator[List[str]]:
    """The lines between a run's beginning and its end, or the end of an incomplete log."""
    block: Optional[List[str]] = None
    for line in lines:
        if line.startswith(_BEGIN):
            block = []
        elif block is not None and line.startswith(_END):
            yield block
            block = None
        elif block is not None:
            block.append(line.rstrip("\n"))
    if block:
        yield block


def _rows(block: List[str]) -> Optional[Table]:
    block = [line for line in block if line.strip()]
    if not block:
        return None
    if block[0].startswith("------------ Step"):
        return _multi(block)
    for k, line in enumerate(block):
        if line.startswith("keywords:"):
            names = re.findall(r"'([^']*)'|([^\s,\[\]']+)", line.split(":", 1)[1])
            rows = [re.findall(r"[^\s,\[\]]+", row.strip()[1:]) for row in block[k + 1 :] if row.strip().startswith("- [")]
            return _numbers([a or b for a, b in names], rows)
    return _numbers(block[0].split(), [line.split() for line in block[1:]])


def _multi(block: List[str]) -> Table:
    names: List[str] = []
    rows: List[List[str]] = []
    for line in block:
        if line.startswith("------------ Step"):
            words = line.replace("=", " = ").split()
            rows.append([words[2]])
            names = names or ["Step"]
            continue
        for name, value in re.findall(r"(\S+)\s*=\s*(\S+)", line):
            if rows:
                rows[-1].append(value)
                if len(rows) == 1:
                    names.append(name)
    return _numbers(names, rows)


def _numbers(names: List[str], rows: List[List[str]]) -> Table:
    """Rows of numbers; other lines in between (warnings) are skipped."""
    import numpy

    kept = []
    for row in rows:
        if len(row) != len(names):
            continue
        try:
            kept.append([float(a) for a in row])
        except ValueError:
            continue
    table = numpy.array(kept).reshape(len(kept), len(names))
    columns = {}
    for k, name in enumerate(names):
        column = table[:, k]
        whole = name in ("Step", "Atoms", "Elapsed")
        columns[name] = column.astype(numpy.int64) if whole and numpy.isfinite(column).all() else column.copy()
    return Table(columns)


class Frame(Table):
    """Particles at one time: columns by name, `step`, `time` (if known), `box` and `periodic`."""

    def __init__(self, columns: Dict[str, Any], step: int, box: Any, periodic: Tuple[bool, ...], time: Optional[float]) -> None:
        super().__init__(columns)
        self.step, self.box, self.periodic, self.time = step, box, periodic, time

    def __repr__(self) -> str:
        return f"<Frame of step {self.step}: {len(self)} particles with {', '.join(self)}>"

    def rows(self, *names: str) -> Any:
        """Several columns side by side, as ``frame.rows("x", "y", "z")``."""
        import numpy

        return numpy.stack([self[name] for name in names], axis=-1)


def read_dump(path: Path) -> List[Frame]:
    """The snapshots of a text dump (`custom`, `atom`, `local`; also `.gz`), of perigrain or of LAMMPS."""
    with _opened(path) as file:
        return list(_frames(file, str(path)))


def _frames(file: Any, name: str) -> Iterator[Frame]:
    import numpy

    step, time, box, periodic, n = 0, None, None, (False,) * 3, 0
    lines = iter(file)
    for line in lines:
        if not line.startswith("ITEM:"):
            raise DataError(f"`{name}` is no text dump: a line that begins with ITEM: is missing")
        item = line[5:].strip()
        try:
            if item == "TIMESTEP":
                step, time = int(next(lines)), None
            elif item == "TIME":
                time = float(next(lines))
            elif item == "UNITS":
                next(lines)
            elif item.startswith("NUMBER OF"):
                n = int(next(lines))
            elif item.startswith("BOX BOUNDS"):
                periodic = tuple(word.startswith("p") for word in item.split()[-3:])
                box = numpy.array([[float(a) for a in next(lines).split()[:2]] for _ in range(3)])
            else:
                names = item.split()[1:]
                rows = [next(lines).split() for _ in range(n)]
                if any(len(row) != len(names) for row in rows):
                    raise DataError(f"`{name}`: a row of step {step} has not {len(names)} columns")
                yield Frame({c: _column([r[k] for r in rows]) for k, c in enumerate(names)}, step, box, periodic, time)
        except (StopIteration, ValueError) as e:
            if isinstance(e, DataError):
                raise
            raise DataError(f"`{name}` ends or breaks off in the snapshot of step {step}") from None


def _column(words: List[str]) -> Any:
    import numpy

    for kind in (numpy.int64, numpy.float64):
        try:
            return numpy.array(words, dtype=kind)
        except ValueError:
            continue
    return numpy.array(words)


def read_restart(path: Path) -> Frame:
    """The particles of a restart file of perigrain: every column of the scene, by LAMMPS' names."""
    from .lmp import lammps

    with lammps(cmdargs=["-log", "none", "-screen", "none"]) as lmp:
        lmp.command(f'read_restart "{os.fspath(path)}"')
        return frame_of(lmp)


def frame_of(lmp: Any) -> Frame:
    """A copy of all current particle data of a scene."""
    import numpy

    names = "id type mask molecule image x v f omega torque x0 quat radius rmass vfrac temperature heatflow".split()
    columns = {}
    for name in names:
        found = lmp.numpy.extract_atom(name)
        if found is not None:
            columns[name] = numpy.array(found)
    lo, hi, *_, periodic, _ = lmp.extract_box()
    box = numpy.array([lo, hi]).T
    time = lmp.extract_global("atime")
    return Frame(columns, lmp.extract_global("ntimestep"), box, tuple(bool(p) for p in periodic), time)


def _opened(path: Path) -> IO[str]:
    path = os.fspath(path)
    if str(path).endswith(".gz"):
        return gzip.open(path, "rt", encoding="utf-8", errors="replace")
    return open(path, encoding="utf-8", errors="replace")
