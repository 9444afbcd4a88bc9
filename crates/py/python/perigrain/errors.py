"""The exceptions of perigrain."""

from __future__ import annotations

from typing import Any, Dict, List, Optional


class PerigrainError(Exception):
    """Base class of all exceptions of perigrain."""


class DeckError(PerigrainError):
    """A line is refused, or its run failed; the scene remains usable.

    ``code`` is the kind of mistake (``perigrain explain CODE`` in a terminal), ``message`` one sentence, ``line`` and
    ``column`` (from 1), ``file`` and ``word`` the position, ``help`` the remedy. ``problems`` has all
    problems; these attributes are those of the first one. As a string it is the terminal output.
    """

    code: str
    message: str
    file: Optional[str]
    line: Optional[int]
    column: Optional[int]
    word: Optional[str]
    help: str

    def __init__(self, problems: List[Dict[str, Any]], text: str) -> None:
        super().__init__(text.rstrip())
        self.problems = problems
        errors = [p for p in problems if p["severity"] == "error"] or problems
        first: Dict[str, Any] = errors[0] if errors else {}
        self.code = first.get("code", "")
        self.message = first.get("message", "")
        self.file = first.get("file")
        self.line = first.get("line")
        self.column = first.get("column")
        self.word = first.get("word")
        self.help = first.get("help", "")
        self._made_of = (problems, text)

    def __reduce__(self):  # so that it can be sent through queues between processes
        return (type(self), self._made_of)


class DataError(PerigrainError, TypeError, ValueError):
    """An array of another shape or type than required."""


class StaleError(PerigrainError):
    """A view of particles that have been added, deleted or reordered since; extract it again."""


class BusyError(PerigrainError):
    """The scene is executing a command, in another thread or around a callback."""


class ClosedError(PerigrainError):
    """The scene is closed."""


class InternalError(PerigrainError):
    """A bug in perigrain; the scene is lost, others in the process continue. Please report it."""
