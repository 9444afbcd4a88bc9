"""`fix external`: forces from a Python function."""

from __future__ import annotations

from typing import Any, Callable, Dict, Optional, Sequence

from .errors import DataError
from .views import pointer


def _columns(given: Any, width: int, what: str) -> bytes:
    """Numbers as bytes, a fixed count per particle."""
    import numpy

    try:
        numbers = numpy.ascontiguousarray(given, dtype=numpy.float64)
    except (TypeError, ValueError) as e:
        raise DataError(f"{what} of particles are numbers, as many for each: {e}") from None
    wanted = (width,) if width > 1 else ()
    if numbers.ndim != 1 + len(wanted) or numbers.shape[1:] != wanted:
        shape = "(n,)" if width == 1 else f"(n, {width})"
        raise DataError(f"{what} of particles have the shape {shape}, not {numbers.shape}")
    return numbers.tobytes()


class External:
    """The methods of a scene for fixes external."""

    _scene: Any
    _outsides: Dict[str, Any]

    def set_fix_external_callback(self, fix_id: str, callback: Callable[..., Any], caller: Any = None) -> None:
        """Sets the function that computes the forces of a `fix external pf/callback`.

        It is called as `callback(caller, step, n, ids, x, f)`, with numpy arrays `(n,)`, `(n, 3)`, `(n, 3)`, and writes into `f`.
        All three are copies for this call: `x` is read-only, and since the scene is executing, only its methods
        that begin with `fix_external_set_` may be called. An exception ends the run in that step and is raised by the command that ran.
        """
        if not callable(callback):
            raise DataError(f"a function is needed, not {type(callback).__name__}")
        import numpy

        def called(step: int, ids: bytes, x: bytes, f: bytearray) -> None:
            tags = numpy.frombuffer(ids, dtype=numpy.int32)
            places = numpy.frombuffer(x, dtype=numpy.float64).reshape(-1, 3)
            forces = numpy.frombuffer(f, dtype=numpy.float64).reshape(-1, 3)
            callback(caller, step, len(tags), tags, places, forces)

        self._outside(fix_id).call(called)

    def fix_external_get_force(self, fix_id: str) -> Any:
        """A pointer `p[i][j]` into the forces that a fix external adds, in storage order."""
        return pointer(self._external_forces(fix_id))

    def fix_external_set_energy_global(self, fix_id: str, eng: float) -> None:
        """Sets the potential energy of the forces, the scalar of the fix."""
        self._outside(fix_id).energy(float(eng))

    def fix_external_set_virial_global(self, fix_id: str, virial: Sequence[float]) -> None:
        """Sets the virial of the forces: xx, yy, zz, xy, xz, yz."""
        six = [float(a) for a in virial]
        if len(six) != 6:
            raise DataError(f"a virial is six numbers, not {len(six)}")
        self._outside(fix_id).virial(six)

    def fix_external_set_vector_length(self, fix_id: str, length: int) -> None:
        """Sets the length of the fix's vector; not allowed within a run."""
        self._outside(fix_id)
        self.command(f"fix_modify {fix_id} vector {int(length)}")  # type: ignore[attr-defined]

    def fix_external_set_vector(self, fix_id: str, idx: int, val: float) -> None:
        """Sets one of these values, counted from 1; the fix offers it from its next step on."""
        if not self._scene.at_work:
            self._scene.has_value(fix_id, max(int(idx), 0))
        self._outside(fix_id).value(max(int(idx), 0), float(val))

    def fix_external_set_energy_peratom(self, fix_id: str, eng: Any) -> None:
        """Sets the energy of each particle for `compute pe/atom`, in storage order; it is not part of any sum."""
        self._external_each(fix_id, _columns(eng, 1, "energies"), None)

    def fix_external_set_virial_peratom(self, fix_id: str, virial: Any) -> None:
        """Sets the virial of each particle for `compute stress/atom`: six numbers each, xx, yy, zz, xy, xz, yz."""
        self._external_each(fix_id, None, _columns(virial, 6, "virials"))

    def _external_each(self, fix_id: str, energy: Optional[bytes], virial: Optional[bytes]) -> None:
        outside = self._outside(fix_id)
        if self._scene.at_work:
            outside.each(energy, virial)
        else:
            self._scene.external_each(fix_id, energy, virial)

    def _external_forces(self, fix_id: str) -> Any:
        self._outside(fix_id)
        memory = self._scene.memory(f"external:{fix_id}")
        if memory is None:
            raise DataError(f"there are no forces of fix `{fix_id}` yet: no box has been made")
        return memory

    def _outside(self, fix_id: str) -> Any:
        # Within a callback the scene is busy; the link to the fix is known then.
        known: Optional[Any] = self._outsides.get(fix_id)
        if known is not None and self._scene.at_work:
            return known
        self._outsides[fix_id] = self._scene.outside(fix_id)
        return self._outsides[fix_id]
