"""`%load_ext perigrain`, then `%%perigrain [NAME]` above a cell with lines of a deck."""

from __future__ import annotations

import sys
from typing import Any

from .errors import DeckError
from .scene import Scene


def load(shell: Any) -> None:
    """Registers the magic with IPython."""

    def perigrain(line: str, cell: str) -> Any:
        """Executes lines of a deck in the scene NAME (default `scene`), which is created if missing; `new` starts another."""
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
            # The position in the cell is more useful than Python's traceback.
            print(e, file=sys.stderr)
            raise _Told() from None

    shell.register_magic_function(perigrain, "cell", "perigrain")


class _Told(Exception):
    """Ends a cell after its error has been printed."""

    def _render_traceback_(self) -> Any:
        return ["the cell ends here; the scene can be used on"]
