"""Writes the small images that tests read; needs numpy, pynrrd, tifffile and pillow."""
import os, sys, zlib
import numpy as np
import nrrd
import tifffile
from PIL import Image

out = sys.argv[1]
os.makedirs(out, exist_ok=True)
at = lambda name: os.path.join(out, name)
# Grey values z, y, x: a ramp along x with a bright ball in it; 12 x 10 x 8 voxels.
z, y, x = np.mgrid[0:8, 0:10, 0:12]
grey = (10 * x).astype(np.uint8)
grey[(x - 6) ** 2 + (y - 5) ** 2 + (z - 4) ** 2 <= 9] = 200
print("below 40:", int((grey < 40).sum()), "40 to 120:", int(((grey >= 40) & (grey <= 120)).sum()), "200:", int((grey == 200).sum()))
volume = grey.transpose(2, 1, 0)
header = {"spacings": [0.5, 0.5, 0.5]}
nrrd.write(at("raw8.nrrd"), volume, {"encoding": "raw", **header})
nrrd.write(at("gzip8.nrrd"), volume, {"encoding": "gzip", **header})
nrrd.write(at("big16.nrrd"), volume.astype(">u2"), {"encoding": "gzip", "endian": "big", "space": "left-posterior-superior",
           "space directions": np.diag([0.5] * 3), "space origin": [0.25] * 3})
nrrd.write(at("float.nhdr"), volume.astype(np.float32), {"encoding": "gzip", **header})
nrrd.write(at("nospacing.nrrd"), volume, {"encoding": "gzip"})
for k in range(8):
    Image.fromarray(grey[k]).save(at(f"ct_{k + 5}.png"))
Image.fromarray(grey[0].astype(np.uint16) * 256).save(at("deep.png"))
Image.fromarray(grey[0] > 100).save(at("bits.png"))
Image.fromarray(np.stack([grey[0]] * 3, -1)).save(at("colour.png"))
tifffile.imwrite(at("pages.tif"), grey, photometric="minisblack", metadata=None)
tifffile.imwrite(at("big.tiff"), grey.astype(">f4"), byteorder=">", photometric="minisblack", metadata=None)
tifffile.imwrite(at("packed.tif"), grey[0], compression="zlib", photometric="minisblack", metadata=None)
