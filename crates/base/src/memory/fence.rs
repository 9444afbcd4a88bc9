//! The program's allocator: when memory is exhausted, or exceeds `-limit memory`, it ends the program with a
//! message instead of an abort.

use crate::diag::{Code, Diagnostic, FileId, Source, Span};
use crate::gate;
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::process::exit;
use std::sync::atomic::{AtomicBool, AtomicIsize, AtomicU64, Ordering};
use std::sync::{Arc, OnceLock, RwLock};

/// Allocations of at least this size are compared with the machine's free memory [byte].
const LARGE: usize = 64 << 20;
/// With a limit, allocations of at least this size are compared with the memory of the process [byte].
const NOTABLE: usize = 1 << 20;
/// Fraction of a limit that is reserved for the allocator's own overhead.
const MARGIN: f64 = 0.05;

/// Bytes that may be allocated, counted from when the limit was set.
static MOST: AtomicIsize = AtomicIsize::new(isize::MAX);
/// Bytes allocated, counted from when the limit was set.
static HELD: AtomicIsize = AtomicIsize::new(0);
/// Set while the program is being ended.
static ENDING: AtomicBool = AtomicBool::new(false);
/// Prints the final message.
static SPEAKER: OnceLock<Speaker> = OnceLock::new();
/// The text of the deck that is being read.
static TEXT: RwLock<Option<Arc<Source>>> = RwLock::new(None);
/// The byte range of the line being executed: first, and one past the last.
static LINE: AtomicU64 = AtomicU64::new(0);

/// Prints a message.
type Speaker = Box<dyn Fn(Diagnostic) + Send + Sync>;

thread_local! {
    /// Set on the thread that prints the final message: it gets memory despite the limit.
    static SPEAKING: Cell<bool> = const { Cell::new(false) };
}

/// The system's allocator with checks. Without a limit an allocation costs one additional load.
pub struct Fence;

// SAFETY: all memory comes from the system, with the layouts requested; a refused request never returns to
// the caller.
unsafe impl GlobalAlloc for Fence {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        admit(layout.size());
        // SAFETY: the caller's guarantee.
        given(unsafe { System.alloc(layout) }, layout.size())
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        admit(layout.size());
        // SAFETY: the caller's guarantee.
        given(unsafe { System.alloc_zeroed(layout) }, layout.size())
    }

    unsafe fn dealloc(&self, piece: *mut u8, layout: Layout) {
        back(layout.size());
        // SAFETY: the caller's guarantee.
        unsafe { System.dealloc(piece, layout) }
    }

    unsafe fn realloc(&self, piece: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        match size.checked_sub(layout.size()) {
            Some(more) => admit(more),
            None => back(layout.size() - size),
        }
        // SAFETY: the caller's guarantee.
        given(unsafe { System.realloc(piece, layout, size) }, size)
    }
}

/// Admits an allocation, or ends the program.
#[inline]
fn admit(size: usize) {
    let most = MOST.load(Ordering::Relaxed);
    if most != isize::MAX || size >= LARGE {
        look(size, most);
    }
}

#[cold]
fn look(size: usize, most: isize) {
    if most == isize::MAX {
        if super::free::bytes().is_some_and(|free| size as f64 > free) {
            refuse(size);
        }
        return;
    }
    let size_too = isize::try_from(size).unwrap_or(isize::MAX);
    let held = HELD.fetch_add(size_too, Ordering::Relaxed).saturating_add(size_too);
    if held > most || (size >= NOTABLE && gate::memory_of_limit().is_some_and(|left| size as f64 > left)) {
        refuse(size);
    }
}

/// Records a deallocation.
#[inline]
fn back(size: usize) {
    if MOST.load(Ordering::Relaxed) != isize::MAX {
        HELD.fetch_sub(size as isize, Ordering::Relaxed);
    }
}

/// The pointer from the system; if it is null, the program ends.
#[inline]
fn given(piece: *mut u8, size: usize) -> *mut u8 {
    if piece.is_null() {
        refuse(size);
    }
    piece
}

/// Ends the program with a message, unless this thread is printing it.
#[cold]
fn refuse(size: usize) {
    if SPEAKING.get() {
        return;
    }
    if ENDING.swap(true, Ordering::SeqCst) {
        loop {
            std::thread::park();
        }
    }
    SPEAKING.set(true);
    // A panic while the message is printed must not unwind out of the allocator.
    let _ = catch_unwind(AssertUnwindSafe(|| {
        let problem = placed(message(size as f64));
        match SPEAKER.get() {
            Some(speaker) => speaker(problem),
            None => eprintln!("error[{}]: {}", problem.code, problem.message),
        }
    }));
    exit(1);
}

fn message(bytes: f64) -> Diagnostic {
    let asked = super::size(bytes);
    match gate::limits() {
        Some(limits) => {
            let text = format!(
                "-safe: {asked} more would be too many megabytes of memory, {} are allowed",
                limits.memory
            );
            Diagnostic::error(Code::NOT_ALLOWED, None, text).help("`-limit memory MB` allows more")
        }
        None => {
            let free =
                super::room().map_or(String::new(), |free| format!("; {} are free", super::size(free)));
            Diagnostic::error(Code::TOO_LARGE, None, format!("{asked} of memory more are needed here{free}"))
        }
    }
}

/// With the line that runs.
fn placed(mut problem: Diagnostic) -> Diagnostic {
    if let Ok(text) = TEXT.try_read()
        && let Some(text) = &*text
    {
        let line = LINE.load(Ordering::Relaxed);
        problem.span = Some(Span { file: FileId::BROUGHT, start: (line >> 32) as u32, end: line as u32 });
        problem.text = Some(text.clone());
    }
    problem
}

/// Sets the text of the following lines.
pub fn reads(text: Arc<Source>) {
    if let Ok(mut now) = TEXT.write() {
        *now = Some(text);
    }
}

/// Sets the line of the text that is being executed.
#[inline]
pub fn at(line: Span) {
    LINE.store(u64::from(line.start) << 32 | u64::from(line.end), Ordering::Relaxed);
}

/// Sets the function that prints the message with which the allocator ends the program; only the first one
/// counts.
pub fn speaks(speaker: impl Fn(Diagnostic) + Send + Sync + 'static) {
    let _ = SPEAKER.set(Box::new(speaker));
}

/// Limits the total memory of the program from now on.
pub(crate) fn limit(bytes: f64) {
    let left = bytes * (1.0 - MARGIN) - super::resident().unwrap_or(0.0);
    HELD.store(0, Ordering::Relaxed);
    MOST.store(left.max(0.0) as isize, Ordering::Relaxed);
}

/// Bytes left by the limit according to the allocator's count.
pub(crate) fn limited() -> Option<f64> {
    let most = MOST.load(Ordering::Relaxed);
    (most != isize::MAX).then(|| (most.saturating_sub(HELD.load(Ordering::Relaxed))).max(0) as f64)
}
