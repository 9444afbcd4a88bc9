//! The step as data: ops with stages, reads, writes and times.
