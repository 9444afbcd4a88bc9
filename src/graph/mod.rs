//! Commands as a graph of declarations, acts and runs.
