//! The MPI library: search, loading, and its functions.

use super::abi::{Abi, Constants};
use super::{Handle, c_char, c_int, c_void};
use crate::Error;
use crate::launcher::CHOICE;
use std::ffi::{CStr, CString};

/// File names of the standard interface; then Open MPI's; then MPICH's, which others use too.
const STANDARD: [&str; 2] = ["libmpi_abi.so.1", "libmpi_abi.so.0"];
const OPEN: [&str; 1] = ["libmpi.so.40"];
const MPICH: [&str; 2] = ["libmpich.so.12", "libmpi.so.12"];

/// A loaded library.
pub(super) struct Library {
    pub f: Functions,
    pub constants: Constants,
}

macro_rules! functions {
    ($($name:ident: fn($($argument:ty),*)),* $(,)?) => {
        /// MPI's functions by their names in the standard.
        #[allow(non_snake_case)]
        pub(super) struct Functions {
            $(pub $name: unsafe extern "C" fn($($argument),*) -> c_int),*
        }

        impl Functions {
            /// Looks up all functions.
            ///
            /// # Errors
            /// The name of the first missing function.
            fn of(library: &Handle) -> Result<Self, &'static str> {
                Ok(Self {
                    $($name: {
                        let address = symbol(*library, stringify!($name));
                        if address == 0 {
                            return Err(stringify!($name));
                        }
                        // SAFETY: the standard gives the function of this name these arguments; handles are
                        // at most as wide as addresses.
                        unsafe { std::mem::transmute::<usize, unsafe extern "C" fn($($argument),*) -> c_int>(address) }
                    }),*
                })
            }
        }
    };
}

functions! {
    MPI_Init_thread: fn(*mut c_int, *mut *mut *mut c_char, c_int, *mut c_int),
    MPI_Finalize: fn(),
    MPI_Get_library_version: fn(*mut c_char, *mut c_int),
    MPI_Comm_rank: fn(Handle, *mut c_int),
    MPI_Comm_size: fn(Handle, *mut c_int),
    MPI_Comm_dup: fn(Handle, *mut Handle),
    MPI_Abort: fn(Handle, c_int),
    MPI_Isend: fn(*mut c_void, c_int, Handle, c_int, c_int, Handle, *mut c_void),
    MPI_Irecv: fn(*mut c_void, c_int, Handle, c_int, c_int, Handle, *mut c_void),
    MPI_Waitall: fn(c_int, *mut c_void, *mut c_void),
    MPI_Test: fn(*mut c_void, *mut c_int, *mut c_void),
    MPI_Ibarrier: fn(Handle, *mut c_void),
    MPI_Allreduce: fn(*const c_void, *mut c_void, c_int, Handle, Handle, Handle),
    MPI_Bcast: fn(*mut c_void, c_int, Handle, c_int, Handle),
    MPI_Allgatherv: fn(*const c_void, c_int, Handle, *mut c_void, *const c_int, *const c_int, Handle, Handle),
}

/// The address of a name in a library, 0 if it has none.
fn symbol(library: Handle, name: &str) -> Handle {
    let Ok(name) = CString::new(name) else { return 0 };
    // SAFETY: the library is open and stays open.
    unsafe { libc::dlsym(library as *mut c_void, name.as_ptr()) as Handle }
}

/// The names to try, in order: the configured one, else the standard interface and then the launcher's kind.
fn names(chosen: Option<String>, open_first: bool) -> Vec<String> {
    if let Some(name) = chosen.filter(|name| !name.is_empty()) {
        return vec![name];
    }
    let own: Vec<&str> = if open_first {
        OPEN.into_iter().chain(MPICH).collect()
    } else {
        MPICH.into_iter().chain(OPEN).collect()
    };
    // Current Open MPI has no standard interface: a file of this name belongs to another library than its
    // launcher.
    let all: Vec<&str> = if open_first {
        own.into_iter().chain(STANDARD).collect()
    } else {
        STANDARD.into_iter().chain(own).collect()
    };
    all.into_iter().map(String::from).collect()
}

/// Finds a library and its functions.
///
/// # Errors
/// None of the names can be loaded, or the loaded file is not an MPI library.
pub(super) fn find() -> Result<Library, Error> {
    let open = std::env::var_os("OMPI_COMM_WORLD_SIZE").is_some();
    let mut why = vec![];
    for name in names(std::env::var(CHOICE).ok(), open) {
        let Ok(file) = CString::new(name.clone()) else { continue };
        // Open MPI's own plugins look up its symbols, which therefore must be global.
        // SAFETY: the library's own initialization runs.
        let library = unsafe { libc::dlopen(file.as_ptr(), libc::RTLD_NOW | libc::RTLD_GLOBAL) } as Handle;
        if library == 0 {
            why.push(trouble());
            continue;
        }
        let f = Functions::of(&library).map_err(|lacking| Error::NoMpi { file: name.clone(), lacking })?;
        let address = |name: &str| symbol(library, name);
        let abi = if name.contains("_abi") && address("MPI_Abi_get_version") != 0 {
            Abi::Standard
        } else if address("ompi_mpi_comm_world") != 0 {
            Abi::Open
        } else {
            Abi::Mpich
        };
        return Ok(Library { f, constants: Constants::of(abi, address) });
    }
    Err(Error::NoLibrary(why))
}

/// The reason why a library could not be loaded.
fn trouble() -> String {
    // SAFETY: the text is valid until this thread calls the loader again.
    unsafe {
        let text = libc::dlerror();
        if text.is_null() {
            "unknown trouble".into()
        } else {
            CStr::from_ptr(text).to_string_lossy().into_owned()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_launchers_own_library_comes_before_others() {
        let first = |chosen: Option<&str>, open| names(chosen.map(String::from), open)[0].clone();
        assert_eq!(first(None, true), "libmpi.so.40");
        assert_eq!(first(None, false), "libmpi_abi.so.1");
        assert_eq!(names(Some("/opt/x/libmpi.so".into()), true), ["/opt/x/libmpi.so"]);
        assert_eq!(names(Some(String::new()), false).len(), 5);
    }

    #[test]
    fn what_is_no_mpi_library_is_named() {
        // The C library exists, and has no MPI functions.
        let library = unsafe { libc::dlopen(c"libc.so.6".as_ptr(), libc::RTLD_NOW) } as Handle;
        assert!(library != 0 && Functions::of(&library).is_err_and(|lacking| lacking == "MPI_Init_thread"));
    }
}
