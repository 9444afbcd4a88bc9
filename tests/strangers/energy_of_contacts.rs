//! K4, contacts: springs, dashpots and friction never make energy.
