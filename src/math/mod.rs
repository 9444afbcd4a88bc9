//! Small vectors and matrices, decompositions, random numbers.
