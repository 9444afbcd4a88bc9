//! K7: Python, editors, help, packings.
