//! The `perigrain` program: maps the command line's result to an exit code.

fn main() -> std::process::ExitCode {
    give_large_memory_back();
    perigrain::cli::main()
}

/// Large pieces of memory always go back to the system when they are no longer needed. Left alone, the C library learns to keep
/// pieces of up to 32 MiB, and lists of contacts, which come and go, leave holes: a hopper of 1.45 million spheres then
/// needs 995 MB instead of 744.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
fn give_large_memory_back() {
    const LARGE: libc::c_int = 1 << 20;
    // SAFETY: sets a number of the allocator, before there are other threads.
    unsafe { libc::mallopt(libc::M_MMAP_THRESHOLD, LARGE) };
}

#[cfg(not(all(target_os = "linux", target_env = "gnu")))]
fn give_large_memory_back() {}
