//! K6: words and styles of LAMMPS that were refused.
