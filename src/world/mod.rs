//! The state of a scene: everything that outlives a step, and nothing that decides.
