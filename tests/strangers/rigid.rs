//! K2: rigid bodies with true masses, centres and inertias.
