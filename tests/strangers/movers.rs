//! K1: whatever moves or turns particles as a whole turns everything that has a direction.
