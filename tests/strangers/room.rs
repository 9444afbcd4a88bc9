//! K5: memory that input can ask for goes through one door.
