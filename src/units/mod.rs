//! Unit systems and the constants each defines.
