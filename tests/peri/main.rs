//! Peridynamic scenes of the program: lattices against lists, weights of bonds.

mod bond_weights;
mod scatter;
