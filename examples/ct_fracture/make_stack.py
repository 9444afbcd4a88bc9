"""Writes rock.nrrd, a stack as a tomograph gives it: grains of quartz in a softer matrix, pores, noise."""
import numpy as np
import nrrd

SIZE, EDGE = (32, 32, 48), 0.25  # voxels along x, y, z; edge in mm
rng = np.random.default_rng(7)
x = np.stack(np.meshgrid(*(np.arange(n) for n in SIZE), indexing="ij"), -1)
grey = np.full(SIZE, 110.0)
for _ in range(60):
    centre, radius = rng.uniform(0, SIZE), rng.uniform(3, 6)
    squash = rng.uniform(0.7, 1.3, 3)
    grey[(((x - centre) / squash) ** 2).sum(-1) < radius**2] = 200
for _ in range(70):
    centre, radius = rng.uniform(0, SIZE), rng.uniform(1, 2.5)
    grey[((x - centre) ** 2).sum(-1) < radius**2] = 30
grey += rng.normal(0, 6, SIZE)
# Steps of eight, so that the file stays small.
stack = (np.clip(grey, 0, 255) // 8 * 8).astype(np.uint8)
nrrd.write("rock.nrrd", stack, {"encoding": "gzip", "spacings": [EDGE] * 3}, compression_level=9)
for name, chosen in [("pores", stack < 70), ("matrix", (stack >= 70) & (stack < 155)), ("quartz", stack >= 155)]:
    print(f"{name}: {chosen.mean():.3f} of the volume")
