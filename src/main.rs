//! The `perigrain` program: maps the command line's result to an exit code.

/// Ends the program with a message where memory is not there, or beyond `-limit memory`.
#[global_allocator]
static FENCE: perigrain_base::memory::Fence = perigrain_base::memory::Fence;

fn main() -> std::process::ExitCode {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    memory::settle();
    perigrain::cli::main()
}

/// Settings of the C library's allocator, made before there are other threads.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
mod memory {
    /// Blocks of this size and more are allocated and freed one by one [byte].
    const LARGE: usize = 1 << 20;
    /// Room for smaller ones in huge pages; it is taken up as it is used [byte].
    const ROOM: usize = 128 << 20;
    /// A huge page [byte].
    const HUGE: usize = 2 << 20;

    /// Large blocks of memory always go back to the system when they are no longer needed. By default the C library keeps blocks
    /// of up to 32 MiB after a while, and lists of contacts, which come and go, leave holes: a hopper of 1.45 million spheres
    /// then needs 995 MB instead of 744.
    ///
    /// Smaller ones lie in huge pages where the system has some: the columns of 32,000 grains are a thousand small pages, more
    /// than a processor can look up at once (a chute takes 11 % less time, a bed 4 %, one of 128,000 15 %).
    ///
    /// All threads share them: blocks of a thread's own arena would lie elsewhere (two threads: the chute takes 11 to 15 % less
    /// time). Loops allocate little, so no thread waits for the allocator.
    pub fn settle() {
        // SAFETY: sets a number of the allocator.
        unsafe { libc::mallopt(libc::M_ARENA_MAX, 1) };
        // SAFETY: sets a number of the allocator.
        let large = |size: usize| unsafe { libc::mallopt(libc::M_MMAP_THRESHOLD, size as libc::c_int) };
        // A piece of the heap, which comes to its free ones; what stands behind it keeps it from going back.
        large(2 * ROOM);
        // SAFETY: memory is allocated, not read, and freed; the advice changes nothing but time: on some systems there are no
        // huge pages, which is no failure.
        unsafe {
            let room = libc::malloc(ROOM);
            let behind = std::hint::black_box(libc::malloc(1));
            if room.is_null() || behind.is_null() {
                return;
            }
            let skipped = room.align_offset(HUGE);
            libc::madvise(room.byte_add(skipped), ROOM - skipped, libc::MADV_HUGEPAGE);
            libc::free(room);
        }
        large(LARGE);
    }
}
