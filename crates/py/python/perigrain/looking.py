"""Checks decks without running them: their problems, and the steps of their runs."""

from __future__ import annotations

import html
from dataclasses import dataclass
from typing import Any, Dict, List, Optional, Sequence, Union

from . import _core

Value = Union[str, int, float, Sequence[Union[str, int, float]]]


@dataclass(frozen=True)
class Problem:
    """One problem of a deck: severity (`error`, `warning`, `note`), code, message, position, remedy."""

    severity: str
    code: str
    message: str
    file: Optional[str]
    line: Optional[int]
    column: Optional[int]
    word: Optional[str]
    help: str


class Report(List[Problem]):
    """All problems of a deck, in line order; as a string the output of `perigrain check`."""

    def __init__(self, problems: Sequence[Problem], text: str) -> None:
        super().__init__(problems)
        self.text = text

    @property
    def ok(self) -> bool:
        """Whether the deck would run: it may have warnings."""
        return not any(problem.severity == "error" for problem in self)

    def __str__(self) -> str:
        return self.text.rstrip() or "no problems found"

    __repr__ = __str__

    def _repr_html_(self) -> str:
        return f"<pre>{html.escape(str(self))}</pre>"


class Text(str):
    """A text that notebooks display verbatim."""

    def _repr_html_(self) -> str:
        return f"<pre>{html.escape(self)}</pre>"


def _index(given: Optional[Dict[str, Value]]) -> List[Any]:
    """Index variables, as on a command line."""
    out = []
    for name, value in (given or {}).items():
        several = value if isinstance(value, (list, tuple)) else [value]
        out.append((name, [str(v) for v in several]))
    return out


def check(text: str, *, name: str = "deck", folder: str = "", variables: Optional[Dict[str, Value]] = None) -> Report:
    """All problems of a deck at once; nothing is computed and no file is written.

    Files named in the deck are looked up in `folder`; `variables` are those of a command line.
    """
    problems, shown = _core.check(text, name, folder, _index(variables))
    return Report([Problem(**p) for p in problems], shown)


def plan(text: str, *, name: str = "deck", folder: str = "", variables: Optional[Dict[str, Value]] = None) -> Text:
    """The operations of each run of a deck in order, and those omitted with the reason; no steps are run."""
    return Text(_core.plan(text, name, folder, _index(variables)))
