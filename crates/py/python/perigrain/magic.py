"""`%load_ext perigrain`, then `%%perigrain [NAME]` above a cell that holds lines of a deck."""

from __future__ import annotations

import sys
from typing import Any

from .errors import DeckError
from .scene import Scene


def load(shell: Any) -> None:
    """Makes the magic known to IPython."""

    def perigrain(line: str, cell: str) -> Any:
        """Lines of a deck, worked off by the scene NAME (`scene`), which is made if there is none; `new` begins another."""
        words = line.split()
        new = "new" in words
        name = next((word for word in words if word != "new"), "scene")
        scene = shell.user_ns.get(name)
        if new or not isinstance(scene, Scene):
            scene = Scene(screen=True)
            shell.user_ns[name] = scene
        try:
            scene.do(cell)
        except DeckError as e:
            # The place in the cell says more than Python's own trace.
            print(e, file=sys.stderr)
            raise _Told() from None

    shell.register_magic_function(perigrain, "cell", "perigrain")


class _Told(Exception):
    """Ends a cell whose mistake has been told."""

    def _render_traceback_(self) -> Any:
        return ["the cell ends here; the scene can be used on"]
