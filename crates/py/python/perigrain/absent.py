"""Methods of LAMMPS' Python class that are not available: calling one raises an error that names a replacement."""

from __future__ import annotations

from typing import Any

_LISTS = "neighbour lists are not handed out: `compute pair/local` and `property/local` list pairs, `compute coord/atom` counts them"
_PAIRS = "coefficients of pair styles are those that the deck says; they cannot be read back"

_INSTEAD = {
    "create_molecule": "`molecule` reads a template in a deck, and `create_atoms … mol` places copies of it",
    "error": "raise an exception of your own",
    "extract_pair": _PAIRS,
    "extract_pair_dimension": _PAIRS,
    "find_pair_neighlist": _LISTS,
    "find_fix_neighlist": _LISTS,
    "find_compute_neighlist": _LISTS,
    "get_neighlist": _LISTS,
    "get_neighlist_size": _LISTS,
    "get_neighlist_element_neighbors": _LISTS,
    "force_timeout": "a run ends at the next step by an exception in a function that it calls, by `fix halt` or by `timer timeout`",
    "ipython": "scenes and pictures show themselves in notebooks: `perigrain.Scene`, `Scene.picture`",
}


class Named:
    """Raises an error that names an unavailable method."""

    def __getattr__(self, name: str) -> Any:
        instead = _INSTEAD.get(name)
        if instead is None:
            raise AttributeError(f"`{type(self).__name__}` has no attribute `{name}`")
        raise AttributeError(f"`{name}` of LAMMPS' module is not in perigrain: {instead}")


class Absent(Named):
    """Methods without effect here, and refusals of others."""

    def addstep_compute(self, cid: str, nextstep: int) -> None:
        """Does nothing: computes are evaluated when they are read."""

    def addstep_compute_all(self, nextstep: int) -> None:
        """Does nothing: computes are evaluated when they are read."""

    def clearstep_compute(self) -> None:
        """Does nothing: computes are evaluated when they are read."""

    def get_gpu_device_info(self) -> str:
        """No device: an empty text."""
        return ""
