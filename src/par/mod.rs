//! Threads with the same bits for any number of them.
