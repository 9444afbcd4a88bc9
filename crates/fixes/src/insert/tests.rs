//! Counts and places by hand.
