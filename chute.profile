# Chunk-averaged data for fix profile and group flow
# Timestep Number-of-chunks Total-count
# Chunk Coord1 Ncount density/number vx temp
