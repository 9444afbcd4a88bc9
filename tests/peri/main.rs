//! Peridynamic scenes of the program: lattices against lists, weights of bonds, criteria of breaking.

mod bond_weights;
mod breaking;
mod cauchy;
mod scatter;
