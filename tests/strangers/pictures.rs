//! K7: what pictures and reports show.
