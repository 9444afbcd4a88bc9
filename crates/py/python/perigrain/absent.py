"""Methods of LAMMPS' Python class that are not here: who asks for one is told what stands in its place."""

from __future__ import annotations

from typing import Any

_LISTS = "neighbour lists are not handed out: `compute pair/local` and `property/local` tell pairs, `compute coord/atom` how many there are"
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
    """Refuses methods that are not here by name."""

    def __getattr__(self, name: str) -> Any:
        instead = _INSTEAD.get(name)
        if instead is None:
            raise AttributeError(f"`{type(self).__name__}` has no attribute `{name}`")
        raise AttributeError(f"`{name}` of LAMMPS' module is not in perigrain: {instead}")


class Absent(Named):
    """Methods that have nothing to do here, and refusals of others."""

    def addstep_compute(self, cid: str, nextstep: int) -> None:
        """Does nothing: computes need not be told when they are read next."""

    def addstep_compute_all(self, nextstep: int) -> None:
        """Does nothing: computes need not be told when they are read next."""

    def clearstep_compute(self) -> None:
        """Does nothing: computes need not be told when they are read next."""

    def get_gpu_device_info(self) -> str:
        """There is no device: an empty text."""
        return ""
