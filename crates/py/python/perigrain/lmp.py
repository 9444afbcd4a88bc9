"""The class `lammps`: perigrain with the names, arguments and results of LAMMPS' Python module."""

from __future__ import annotations

import os
import platform
from ctypes import POINTER, c_double, c_int, cast
from typing import Any, Dict, List, Optional, Sequence, Tuple, Union

from . import _core
from . import constants as C
from .absent import Absent
from .arrays import array_of, as_bytes, pointer_to
from .errors import DataError
from .external import External
from .views import pointer

# The LAMMPS version of the deck language.
VERSION = 20250722

# LAMMPS packages with styles available here.
PACKAGES = ["BPM", "GRANULAR", "PERI", "RIGID"]

# LAMMPS' codes of the columns that every scene may have.
_DATATYPES = {
    **dict.fromkeys(["id", "type", "mask", "image", "molecule"], C.LAMMPS_INT),
    **dict.fromkeys(["x", "v", "f", "omega", "torque", "x0", "quat"], C.LAMMPS_DOUBLE_2D),
    **dict.fromkeys(["radius", "rmass", "mass", "vfrac", "temperature", "heatflow"], C.LAMMPS_DOUBLE),
}


class _Commands:
    """`lmp.cmd.units("si")` for `lmp.command("units si")`."""

    def __init__(self, lmp: "lammps") -> None:
        self._lmp = lmp

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)

        def say(*words: Any) -> None:
            self._lmp.command(" ".join([name, *map(str, words)]))

        return say


class lammps(External, Absent):
    """A scene, with the methods of LAMMPS' Python class.

    ``cmdargs`` are the words of a command line (`-log`, `-screen`, `-var`, `-echo`, `-threads` …); screen output
    goes to ``sys.stdout``. Several scenes may exist at the same time. Errors are ``perigrain.DeckError`` with
    line, column and remedy, after which the scene remains usable. ``ptr`` is the argument of a function of ``fix python/invoke``:
    the scene of the current run.
    """

    def __init__(
        self, name: str = "", cmdargs: Optional[Sequence[str]] = None, ptr: Any = None, comm: Any = None
    ) -> None:
        if ptr is not None and not isinstance(ptr, _core.Scene):
            raise DataError("`ptr` is what a function of `fix python/invoke` is given; elsewhere leave it out")
        if comm is not None and getattr(comm, "Get_size", lambda: 1)() > 1:
            raise DataError("perigrain is one process with threads: start it with one MPI process, without `comm`")
        self._scene = ptr if ptr is not None else _core.Scene([str(word) for word in cmdargs or []])
        self._numpy: Any = None
        self._outsides = {}
        self.opened = 1
        self.lmp = True

    def __enter__(self) -> "lammps":
        return self

    def __exit__(self, *_: Any) -> None:
        self.close()

    # -- lines of a deck

    def command(self, cmd: str) -> None:
        """Executes one line."""
        self._ended(self._scene.command(_text(cmd), "command"))

    def commands_list(self, cmdlist: Sequence[str]) -> None:
        """Executes lines; one that ends in `&` continues in the next."""
        self._ended(self._scene.command("\n".join(_text(line).rstrip("\n") for line in cmdlist), "commands_list"))

    def commands_string(self, multicmd: str) -> None:
        """Executes a text of several lines."""
        self._ended(self._scene.command(_text(multicmd), "commands_string"))

    def file(self, path: Union[str, "os.PathLike[str]"]) -> None:
        """Executes a deck from a file."""
        self._ended(self._scene.file(os.fspath(path)))

    @property
    def cmd(self) -> _Commands:
        """`lmp.cmd.units("si")` is `lmp.command("units si")`."""
        return _Commands(self)

    @staticmethod
    def _ended(status: Optional[int]) -> None:
        if status is not None:
            # `quit` ends the program, as in LAMMPS; here it can be caught.
            raise SystemExit(status)

    # -- the scene as a whole

    def close(self) -> None:
        """Closes the scene; views of its memory become stale."""
        self._scene.close()
        self.opened = 0
        self.lmp = None  # type: ignore[assignment]

    def finalize(self) -> None:
        """Closes the scene."""
        self.close()

    def version(self) -> int:
        """The LAMMPS version of the deck language, as a date; perigrain's own version is `perigrain.__version__`."""
        return VERSION

    def get_os_info(self) -> str:
        """A description of the platform."""
        return f"{platform.system()} {platform.release()} on {platform.machine()}"

    def get_natoms(self) -> int:
        """The number of particles."""
        return self._scene.count()

    def extract_box(self) -> Any:
        """`[boxlo, boxhi, xy, yz, xz, periodicity, box_change]` as in LAMMPS."""
        found = self._scene.domain()
        if found is None:
            raise DataError("there is no box: `create_box` comes first")
        lo, hi, (xy, xz, yz), periodic = found
        return list(lo), list(hi), xy, yz, xz, [int(p) for p in periodic], 0

    def reset_box(self, boxlo: Sequence[float], boxhi: Sequence[float], xy: float, yz: float, xz: float) -> None:
        """Changes the bounds of an empty box, and the tilts of a triclinic one."""
        self._scene.reset_box(_three(boxlo, "boxlo"), _three(boxhi, "boxhi"), _three([xy, xz, yz], "the tilts"))

    def get_thermo(self, name: str) -> float:
        """The current value of a thermo keyword, of `c_ID`, `f_ID`, `v_NAME`, or of a formula of these."""
        return self._scene.number(_text(name))

    def eval(self, expr: str) -> float:
        """The value of a formula, as in an equal-style variable."""
        return self._scene.number(_text(expr))

    def expand(self, line: str) -> str:
        """A text with `$x`, `${name}` and `$(formula)` substituted."""
        return self._scene.expand(_text(line))

    def last_thermo(self) -> Optional[Dict[str, Union[int, float]]]:
        """The last row of thermo output by its headings; `None` before the first."""
        row = self._scene.last_row()
        return None if row is None else dict(row[1])

    @property
    def last_thermo_step(self) -> int:
        """The step of the last row of thermo output; -1 before the first."""
        row = self._scene.last_row()
        return -1 if row is None else row[0]

    @property
    def is_running(self) -> bool:
        """Whether a command is executing, for callbacks and other threads."""
        return self._scene.at_work

    def extract_setting(self, name: str) -> int:
        """A setting, as in the formula `extract_setting(name)`; -1 if it does not exist."""
        try:
            return int(self._scene.number(f"extract_setting({_text(name)})"))
        except Exception:
            if self._scene.ended is not None:
                raise
            return -1

    def extract_global_datatype(self, name: str) -> int:
        """LAMMPS' type code of a global number."""
        found = self._scene.global_(_text(name))
        return C.LAMMPS_NONE if found is None else found[0]

    def extract_global(self, name: str, dtype: Optional[int] = None) -> Any:
        """A global number (`dt`, `ntimestep`, `boxlo`, `units` …), several as a list; `None` if it does not exist."""
        found = self._scene.global_(_text(name))
        return None if found is None else found[1]

    # -- particles

    def extract_atom_datatype(self, name: str) -> int:
        """LAMMPS' type code of a column of particles."""
        name = _text(name)
        if name[:2] in ("i_", "d_"):
            return C.LAMMPS_INT if name[0] == "i" else C.LAMMPS_DOUBLE
        return _DATATYPES.get(name, C.LAMMPS_NONE)

    def extract_atom_size(self, name: str, dtype: int) -> int:
        """Rows (LMP_SIZE_ROWS) or columns (LMP_SIZE_COLS) of a column of particles."""
        memory = self._scene.memory(_text(name))
        if memory is None:
            return -1
        return memory.width if dtype == C.LMP_SIZE_COLS else memory.rows

    def extract_atom(self, name: str, dtype: Optional[int] = None) -> Any:
        """A pointer into a column of particles, `p[i]` or `p[i][j]`, in storage order; `None` if it does not exist.

        Changes take effect at the next command. After particles have been added, deleted or reordered it
        reads NaN (for integers the smallest one).
        """
        memory = self._scene.memory(_text(name))
        if memory is not None:
            return pointer(memory)
        masses = self._scene.type_masses() if name == "mass" else None
        return None if masses is None else cast(array_of(masses, False), POINTER(c_double))

    def map_atom(self, atomid: int) -> int:
        """The index of the particle with an id; -1 if it does not exist."""
        place = self._scene.place(int(atomid))
        return -1 if place is None else place

    def encode_image_flags(self, ix: int, iy: int, iz: int) -> int:
        """Packs three image counts into one number."""
        return ((ix + 512) & 1023) | (((iy + 512) & 1023) << 10) | (((iz + 512) & 1023) << 20)

    def decode_image_flags(self, image: int) -> List[int]:
        """Unpacks the three image counts."""
        return [((image >> shift) & 1023) - 512 for shift in (0, 10, 20)]

    def create_atoms(
        self,
        n: int,
        atomid: Optional[Sequence[int]],
        atype: Sequence[int],
        x: Sequence[float],
        v: Optional[Sequence[float]] = None,
        image: Optional[Sequence[int]] = None,
        shrinkexceed: bool = False,
    ) -> int:
        """Creates particles at `x` (three numbers each); those outside the box are skipped. Returns the number created."""
        for given, width, what in ((atomid, 1, "atomid"), (atype, 1, "atype"), (x, 3, "x"), (v, 3, "v"), (image, 1, "image")):
            if given is not None and _length(given) != n * width:
                raise DataError(f"`{what}` of {n} particles are {n * width} numbers, not {_length(given)}")
        return self._scene.create(
            _whole_list(atomid, "atomid"),
            _whole_list(atype, "atype") or [],
            _real_list(x, "x") or [],
            _real_list(v, "v"),
            _whole_list(image, "image"),
            bool(shrinkexceed),
        )

    # -- values of computes, fixes and variables: copies, evaluated on request

    def _compute(self, cid: str, cstyle: int, ctype: int) -> Any:
        return _offered("compute", _text(cid), self._scene.compute(_text(cid)), cstyle, ctype)

    def _fix(self, fid: str, fstyle: int, ftype: int) -> Any:
        return _offered("fix", _text(fid), self._scene.fix(_text(fid)), fstyle, ftype)

    def extract_compute(self, cid: str, cstyle: int, ctype: int) -> Any:
        """Current values of a compute: a number, or a pointer to a copy."""
        found = self._compute(cid, cstyle, ctype)
        return pointer_to(*found) if isinstance(found, tuple) else found

    def extract_fix(self, fid: str, fstyle: int, ftype: int, nrow: int = 0, ncol: int = 0) -> Any:
        """Values of a fix: one of its global numbers (row and column from 0), or a pointer to a copy."""
        found = self._fix(fid, fstyle, ftype)
        if not isinstance(found, tuple):
            return found
        if fstyle != C.LMP_STYLE_GLOBAL:
            return pointer_to(*found)
        data, cols = found
        numbers = array_of(data, False)
        at = nrow if ftype == C.LMP_TYPE_VECTOR else nrow * cols + ncol
        if nrow < 0 or ncol < 0 or at >= len(numbers) or (ftype == C.LMP_TYPE_ARRAY and ncol >= cols):
            raise DataError(f"fix `{fid}` has no element {nrow}" + (f", {ncol}" if ftype == C.LMP_TYPE_ARRAY else ""))
        return numbers[at]

    def extract_variable(self, name: str, group: Optional[str] = None, vartype: Optional[int] = None) -> Any:
        """The value of a variable: a number, a text, or an array of `ctypes`; `None` if it does not exist.

        Per-atom arrays are 0 outside `group`.
        """
        found = self._scene.variable(_text(name))
        if found is None:
            return None
        kind, value = found
        wanted = {C.LMP_VAR_EQUAL: "number", C.LMP_VAR_ATOM: "particles", C.LMP_VAR_VECTOR: "vector", C.LMP_VAR_STRING: "text"}
        if vartype is not None and wanted.get(vartype) != kind:
            raise DataError(f"variable `{name}` gives {_KINDS[kind]}, not {_KINDS.get(wanted.get(vartype, ''), 'that')}")
        if kind in ("number", "text"):
            return value
        out = array_of(value, False)
        if kind == "particles" and group is not None and group != "all":
            inside = array_of(self._scene.members(_text(group)), True)
            for i, yes in enumerate(inside):
                if not yes:
                    out[i] = 0.0
        return out

    def set_variable(self, name: str, value: Any) -> int:
        """Sets a variable of style string; 0, or -1 if it does not exist."""
        return self.set_string_variable(name, value)

    def set_string_variable(self, name: str, value: Any) -> int:
        """Sets a variable of style string; 0, or -1 if it does not exist."""
        return self._set(self._scene.set_text, name, str(value))

    def set_internal_variable(self, name: str, value: float) -> int:
        """Sets a variable of style internal; 0, or -1 if it does not exist."""
        return self._set(self._scene.set_number, name, float(value))

    def _set(self, how: Any, name: str, value: Any) -> int:
        try:
            how(_text(name), value)
        except Exception:
            if self._scene.ended is not None:
                raise
            return -1
        return 0

    # -- numbers of all particles, by their ids

    def _gather(self, name: str, dtype: int, count: int, order: Any) -> Any:
        if dtype not in (0, 1):
            raise DataError(f"the type of `{name}` is 0 (whole numbers) or 1 (any), not {dtype!r}")
        data, whole, width = self._scene.gather(_text(name), name == "image" and count == 3, order)
        if whole != (dtype == 0):
            raise DataError(f"`{name}` holds {'whole numbers: type 0' if whole else 'numbers with fractions: type 1'}")
        if count != width:
            raise DataError(f"`{name}` has {width} numbers per particle, not {count}")
        return array_of(data, whole)

    def _scatter(self, name: str, dtype: int, count: int, order: Any, data: Any, n: int) -> None:
        if dtype not in (0, 1):
            raise DataError(f"the type of `{name}` is 0 (whole numbers) or 1 (any), not {dtype!r}")
        raw = as_bytes(data, dtype == 0, name)
        have, want = len(raw) // (4 if dtype == 0 else 8), n * count
        if have != want:
            raise DataError(f"`{name}` of {n} particles with {count} each are {want} numbers, not {have}")
        self._scene.scatter(_text(name), order, raw, dtype == 0)

    def gather_atoms(self, name: str, dtype: int, count: int) -> Any:
        """`count` numbers of each particle in id order, as an array of `ctypes` (type 0: integers, 1: doubles)."""
        return self._gather(name, dtype, count, "ids")

    def gather_atoms_concat(self, name: str, dtype: int, count: int) -> Any:
        """The same in storage order."""
        return self._gather(name, dtype, count, "places")

    def gather_atoms_subset(self, name: str, dtype: int, count: int, ndata: int, ids: Sequence[int]) -> Any:
        """The same for the particles with these ids."""
        return self._gather(name, dtype, count, _chosen(ids, ndata))

    def scatter_atoms(self, name: str, dtype: int, count: int, data: Any) -> None:
        """Writes `count` numbers of each particle, in id order."""
        self._scatter(name, dtype, count, "ids", data, self.get_natoms())

    def scatter_atoms_subset(self, name: str, dtype: int, count: int, ndata: int, ids: Sequence[int], data: Any) -> None:
        """The same for the particles with these ids."""
        self._scatter(name, dtype, count, _chosen(ids, ndata), data, ndata)

    def gather(self, name: str, dtype: int, count: int) -> Any:
        """Like `gather_atoms`, also for computes (`c_ID`), fixes (`f_ID`) and properties (`d_NAME` …)."""
        return self._gather(name, dtype, count, "ids")

    def gather_concat(self, name: str, dtype: int, count: int) -> Any:
        """The same in storage order."""
        return self._gather(name, dtype, count, "places")

    def gather_subset(self, name: str, dtype: int, count: int, ndata: int, ids: Sequence[int]) -> Any:
        """The same for the particles with these ids."""
        return self._gather(name, dtype, count, _chosen(ids, ndata))

    def scatter(self, name: str, dtype: int, count: int, data: Any) -> None:
        """Like `scatter_atoms`."""
        self._scatter(name, dtype, count, "ids", data, self.get_natoms())

    def scatter_subset(self, name: str, dtype: int, count: int, ndata: int, ids: Sequence[int], data: Any) -> None:
        """Like `scatter_atoms_subset`."""
        self._scatter(name, dtype, count, _chosen(ids, ndata), data, ndata)

    def gather_bonds(self) -> Tuple[int, Any]:
        """The number of bonds, and type and two ids of each."""
        bonds = self._scene.bonds()
        flat = [k for bond in bonds for k in bond]
        return len(bonds), (c_int * len(flat))(*flat)

    def gather_angles(self) -> Tuple[int, Any]:
        """Always empty."""
        return 0, (c_int * 0)()

    gather_dihedrals = gather_angles
    gather_impropers = gather_angles

    # -- queries

    def available_styles(self, category: str) -> List[str]:
        """The styles of a category (`pair`, `fix`, `compute`, `dump`, `region`, `command` …)."""
        return list(_core.styles(_text(category)) or [])

    def has_style(self, category: str, name: str) -> bool:
        """Whether a style exists."""
        return _text(name) in self.available_styles(category)

    def available_ids(self, category: str) -> List[str]:
        """The ids of a category (`compute`, `dump`, `fix`, `group`, `molecule`, `region`, `variable`)."""
        return list(self._scene.ids(_text(category)) or [])

    def has_id(self, category: str, name: str) -> bool:
        """Whether an id exists."""
        return _text(name) in self.available_ids(category)

    def available_plugins(self, category: Optional[str] = None) -> List[Any]:
        """Always empty."""
        return []

    def has_package(self, name: str) -> bool:
        """Whether styles of a LAMMPS package are available."""
        return name in PACKAGES

    @property
    def installed_packages(self) -> List[str]:
        """LAMMPS packages with styles available here."""
        return list(PACKAGES)

    has_exceptions = True
    has_gzip_support = True
    has_png_support = True
    has_jpeg_support = True
    has_mpi_support = False
    has_ffmpeg_support = False
    has_curl_support = False
    has_gpu_device = False
    accelerator_config: Dict[str, Any] = {}

    def set_show_error(self, flag: bool) -> bool:
        """Without effect: errors are exceptions and are not printed."""
        return False

    def flush_buffers(self) -> None:
        """Flushes all output."""
        self._scene.flush()

    def get_mpi_comm(self) -> None:
        """Always `None`: perigrain is one process with threads."""
        return None

    @property
    def numpy(self) -> Any:
        """Methods with numpy arrays."""
        if self._numpy is None:
            from .np import numpy_wrapper

            self._numpy = numpy_wrapper(self)
        return self._numpy


_KINDS = {"number": "a number", "vector": "a vector", "particles": "a number per particle", "text": "a text"}

_STYLES = {C.LMP_STYLE_GLOBAL: "global", C.LMP_STYLE_ATOM: "per-particle", C.LMP_STYLE_LOCAL: "local"}
_TYPES = {C.LMP_TYPE_SCALAR: "number", C.LMP_TYPE_VECTOR: "vector", C.LMP_TYPE_ARRAY: "array"}


def _offered(kind: str, id_: str, found: Tuple[Any, ...], style: int, type_: int) -> Any:
    """Selects from the results of a compute or fix: a number, or bytes with columns (1 for vectors)."""
    scalar, vector, array, atom, local = found
    rows = {C.LMP_STYLE_GLOBAL: array, C.LMP_STYLE_ATOM: atom, C.LMP_STYLE_LOCAL: local}
    if style not in rows:
        raise DataError(f"the style of values is 0 (global), 1 (per particle) or 2 (local), not {style!r}")
    table = rows[style]
    if type_ == C.LMP_SIZE_COLS:
        return 0 if table is None or table[1] == 1 and style != C.LMP_STYLE_GLOBAL else table[1]
    if type_ == C.LMP_SIZE_ROWS and table is not None:
        return len(table[0]) // (8 * max(table[1], 1))
    if style == C.LMP_STYLE_GLOBAL:
        if type_ == C.LMP_TYPE_SCALAR and scalar is not None:
            return scalar
        if type_ == C.LMP_TYPE_VECTOR and vector is not None:
            return vector, 1
        if type_ == C.LMP_SIZE_VECTOR and vector is not None:
            return len(vector) // 8
        if type_ == C.LMP_TYPE_ARRAY and table is not None:
            return table
    elif table is not None:
        data, cols = table
        if type_ == C.LMP_TYPE_VECTOR and cols == 1:
            return data, 1
        if type_ == C.LMP_TYPE_ARRAY and cols > 1:
            return data, cols
        if type_ == C.LMP_SIZE_VECTOR and cols == 1:
            return len(data) // 8
    raise DataError(f"{kind} `{id_}` has no {_STYLES[style]} {_TYPES.get(type_, 'values of this kind')}")


def _text(given: Any) -> str:
    if isinstance(given, bytes):
        return given.decode()
    if not isinstance(given, str):
        raise DataError(f"a text is needed, not {type(given).__name__}")
    return given


def _length(given: Any) -> int:
    size = getattr(given, "size", None)
    return size if isinstance(size, int) else len(given)


def _three(given: Sequence[float], what: str) -> List[float]:
    numbers = [float(a) for a in given]
    if len(numbers) != 3:
        raise DataError(f"`{what}` are three numbers, not {len(numbers)}")
    return numbers


def _whole_list(given: Any, what: str) -> Optional[List[int]]:
    return None if given is None else list(array_of(as_bytes(given, True, what), True))


def _real_list(given: Any, what: str) -> Optional[List[float]]:
    return None if given is None else list(array_of(as_bytes(given, False, what), False))


def _chosen(ids: Any, n: int) -> List[int]:
    chosen = _whole_list(ids, "ids") or []
    if len(chosen) < n:
        raise DataError(f"`ids` are {n} numbers, not {len(chosen)}")
    return chosen[:n]
