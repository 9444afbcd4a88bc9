"""`lammps.numpy`: methods with numpy arrays as arguments and results."""

from __future__ import annotations

from typing import Any, Optional

import numpy

from . import constants as C
from .absent import Named
from .arrays import array_of
from .errors import DataError
from .views import view


class numpy_wrapper(Named):
    """Columns of particles as views of the scene's memory; everything else as copies."""

    def __init__(self, lmp: Any) -> None:
        self.lmp = lmp

    def extract_atom(
        self, name: str, dtype: Optional[int] = None, nelem: Optional[int] = None, dim: Optional[int] = None
    ) -> Any:
        """A column of particles in storage order, `(n,)` or `(n, 3)`; `None` if the scene has none.

        It is a view of the scene's memory: changes take effect at the next command. `id` is read-only.
        When particles are added, deleted or reordered the view becomes stale and raises `perigrain.StaleError`.
        """
        memory = self.lmp._scene.memory(name)
        if memory is None:
            masses = self.lmp._scene.type_masses() if name == "mass" else None
            return None if masses is None else _reals(masses, 1)
        looks = view(memory)
        return looks if nelem is None else looks[:nelem]

    def extract_compute(self, cid: str, cstyle: int, ctype: int) -> Any:
        """Current values of a compute, as a copy."""
        return _shaped(self.lmp._compute(cid, cstyle, ctype), ctype)

    def extract_fix(self, fid: str, fstyle: int, ftype: int, nrow: int = 0, ncol: int = 0) -> Any:
        """Values of a fix: one of its global numbers, else a copy of all."""
        if fstyle == C.LMP_STYLE_GLOBAL:
            return self.lmp.extract_fix(fid, fstyle, ftype, nrow, ncol)
        return _shaped(self.lmp._fix(fid, fstyle, ftype), ftype)

    def extract_variable(self, name: str, group: Optional[str] = None, vartype: Optional[int] = None) -> Any:
        """The value of a variable: a number, a text, or an array."""
        found = self.lmp.extract_variable(name, group, vartype)
        return numpy.array(found) if hasattr(found, "_length_") else found

    def fix_external_get_force(self, fix_id: str) -> Any:
        """The forces that a fix external adds, `(n, 3)`: a view of the scene's memory, as by `extract_atom`."""
        return view(self.lmp._external_forces(fix_id))

    def fix_external_set_energy_peratom(self, fix_id: str, eng: Any) -> None:
        """Sets the energy of each particle, like the method of the scene."""
        self.lmp.fix_external_set_energy_peratom(fix_id, eng)

    def fix_external_set_virial_peratom(self, fix_id: str, virial: Any) -> None:
        """Sets the virial of each particle, like the method of the scene."""
        self.lmp.fix_external_set_virial_peratom(fix_id, virial)

    def gather_bonds(self) -> Any:
        """Type and two ids of each bond."""
        _, flat = self.lmp.gather_bonds()
        return numpy.array(flat, dtype=numpy.int32).reshape(-1, 3)

    def gather_angles(self) -> Any:
        """Always empty."""
        return numpy.zeros((0, 4), dtype=numpy.int32)

    def gather_dihedrals(self) -> Any:
        """Always empty."""
        return numpy.zeros((0, 5), dtype=numpy.int32)

    gather_impropers = gather_dihedrals

    def darray(self, raw_ptr: Any, nelem: int, dim: int = 1) -> Any:
        """A copy of the numbers at a pointer returned by `extract_atom`, `extract_compute` …."""
        return self._copied(raw_ptr, nelem, dim, numpy.float64)

    def iarray(self, c_int_type: Any, raw_ptr: Any, nelem: int, dim: int = 1) -> Any:
        """A copy of the integers at a pointer."""
        return self._copied(raw_ptr, nelem, dim, numpy.dtype(c_int_type))

    @staticmethod
    def _copied(raw_ptr: Any, nelem: int, dim: int, dtype: Any) -> Any:
        if raw_ptr is None:
            return None
        if dim > 1:
            return numpy.array([list(raw_ptr[i]) for i in range(nelem)], dtype=dtype).reshape(nelem, dim)
        return numpy.array(raw_ptr[:nelem], dtype=dtype)


def _reals(data: bytes, cols: int) -> Any:
    flat = numpy.frombuffer(bytearray(data), dtype=numpy.float64)
    return flat if cols == 1 else flat.reshape(-1, cols)


def _shaped(found: Any, type_: int) -> Any:
    if not isinstance(found, tuple):
        return found
    data, cols = found
    flat = _reals(data, 1)
    return flat.reshape(-1, cols) if type_ == C.LMP_TYPE_ARRAY and cols > 0 else flat
