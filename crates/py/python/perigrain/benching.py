"""Runs decks over ranges of their parameters: wall time against error."""

from __future__ import annotations

import csv
import os
import subprocess
import sys
import tempfile
from typing import Any, Dict, List, Optional, Sequence, Union

from .errors import PerigrainError
from .looking import Value, _index
from .reading import Table


class BenchError(PerigrainError):
    """A bench that failed or is incomplete."""


def bench(
    deck: str,
    knobs: Dict[str, Sequence[Any]],
    measure: Union[str, Sequence[str]],
    *,
    against: Union[None, str, Sequence[str]] = None,
    norm: Optional[str] = None,
    repeat: int = 1,
    variables: Optional[Dict[str, Value]] = None,
    folder: Union[None, str, "os.PathLike[str]"] = None,
) -> Table:
    """Runs a deck once for each combination of its knobs and compares each with a reference: `perigrain bench`.

    >>> table = bench(text, {"dt": [4e-6, 2e-6, 1e-6]}, measure=["ke", "v_x"])
    >>> table["seconds"], table["ke_error"], table["ke_order_dt"]

    Knobs are index variables of the deck (`variable dt index 1e-6`), and `threads`. Measures are thermo keywords, `c_ID`, `f_ID`,
    `v_NAME` or formulas, compared with the finest run, or with the closed forms in `against`, one for each. Each run is a separate process.
    Runs, logs, pictures and the table are kept in `folder` and reused: the same call continues with missing runs.
    Columns hold numbers, NaN for missing ones; text columns (`problem`, names of norms) are lists of strings.
    """
    several = [measure] if isinstance(measure, str) else list(measure)
    forms = [against] if isinstance(against, str) else list(against or [])
    with tempfile.TemporaryDirectory() as own:
        home = os.path.abspath(folder if folder is not None else own)
        os.makedirs(home, exist_ok=True)
        path = os.path.join(home, "in.deck")
        with open(path, "w", encoding="utf-8") as file:
            file.write(deck)
        out = os.path.join(home, "bench")
        words = ["bench", "-in", path, "-screen", "none", "-out", out, "-repeat", str(int(repeat))]
        for name, values in knobs.items():
            texts = [str(value) for value in values]
            words += ["-threads", *texts] if name == "threads" else ["-each", name, *texts]
        for name, values in _index(variables):
            words += ["-var", name, *values]
        words += ["-measure", *several]
        words += ["-against", "form", *forms] if forms else []
        words += ["-norm", norm] if norm is not None else []
        ended = subprocess.run(
            [sys.executable, "-m", "perigrain", *words], env=_environment(), capture_output=True, text=True, check=False
        )
        table = os.path.join(out, "bench.csv")
        if not os.path.isfile(table) or ended.returncode != 0:
            raise BenchError((ended.stderr or ended.stdout).strip() or f"the bench ended with {ended.returncode}")
        with open(table, encoding="utf-8", newline="") as file:
            return _columns(list(csv.reader(file)))


def _environment() -> Dict[str, str]:
    """An environment in which a process finds this package."""
    home = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
    path = os.pathsep.join(filter(None, [home, os.environ.get("PYTHONPATH")]))
    return {**os.environ, "PYTHONPATH": path}


def _columns(rows: List[List[str]]) -> Table:
    import numpy

    head, body = rows[0], rows[1:]
    columns: Dict[str, Any] = {}
    for k, name in enumerate(head):
        cells = [row[k] for row in body]
        try:
            columns[name] = numpy.array([float(cell) if cell else numpy.nan for cell in cells])
        except ValueError:
            columns[name] = cells
    return Table(columns)
