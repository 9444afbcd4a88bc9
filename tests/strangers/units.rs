//! K3: no bare number that has a unit; mistakes of scale are named before the run.
