//! K4, solids: breaking only sets energy free; limits of steps; stress of torn families.
