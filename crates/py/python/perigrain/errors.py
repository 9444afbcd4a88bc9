"""What can go wrong, by name."""

from __future__ import annotations

from typing import Any, Dict, List, Optional


class PerigrainError(Exception):
    """Everything that perigrain raises by itself."""


class DeckError(PerigrainError):
    """A line is refused, or its run failed; the scene can be used on.

    ``code`` is the kind of mistake (``perigrain explain CODE`` in a terminal), ``message`` one sentence, ``line`` and
    ``column`` (from 1), ``file`` and ``word`` where it stands, ``help`` what to write instead. ``problems`` has all
    problems, of which these are the first one's. As a text it is what the terminal would show.
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

    def __reduce__(self):  # so that it comes through queues between processes
        return (type(self), self._made_of)


class DataError(PerigrainError, TypeError, ValueError):
    """An array of another shape or type than what is asked for."""


class StaleError(PerigrainError):
    """An array looks at particles that have come, gone or changed places since; extract it anew."""


class BusyError(PerigrainError):
    """The scene is in the middle of a command, from another thread or around a callback."""


class ClosedError(PerigrainError):
    """There is no scene any more."""


class InternalError(PerigrainError):
    """A fault of perigrain itself; the scene is gone, others in the process go on. Please report it."""
