"""Writes the small meshes that tests read; needs meshio, gmsh and numpy."""
import os, sys
import numpy as np
import meshio

out = sys.argv[1]
os.makedirs(out, exist_ok=True)
at = lambda name: os.path.join(out, name)

# A hexahedral bar of 3 x 2 x 1 cells with edges 1, the cells of the first two layers along x of material 1, others 2.
nx, ny, nz = 3, 2, 1
index = lambda i, j, k: i + (nx + 1) * (j + (ny + 1) * k)
points = np.array([[i, j, k] for k in range(nz + 1) for j in range(ny + 1) for i in range(nx + 1)], float)
hexes, wedges, tets = [], [], []
for k in range(nz):
    for j in range(ny):
        for i in range(nx):
            h = [index(i, j, k), index(i + 1, j, k), index(i + 1, j + 1, k), index(i, j + 1, k)]
            h += [index(i, j, k + 1), index(i + 1, j, k + 1), index(i + 1, j + 1, k + 1), index(i, j + 1, k + 1)]
            hexes.append(h)
material = np.array([1 if h[0] % (nx + 1) < 2 else 2 for h in hexes], np.int32)
# Each cell as six tetrahedra around its diagonal.
SIX = [(0, 1, 2, 6), (0, 2, 3, 6), (0, 3, 7, 6), (0, 7, 4, 6), (0, 4, 5, 6), (0, 5, 1, 6)]
tets = [[h[a] for a in six] for h in hexes for six in SIX]
tet_material = np.repeat(material, 6)

def write(name, cells, mat, **how):
    data = {"Material": [mat], "gmsh:physical": [mat], "gmsh:geometrical": [mat]}
    if not name.endswith(".msh"):
        data = {"Material": [mat]}
    sets = {}
    if name.endswith(".inp"):
        data = {}
    mesh = meshio.Mesh(points, cells, cell_data=data)
    if name.endswith(".inp"):
        mesh.cell_sets = {"ROCK": [np.flatnonzero(mat == 1)], "BINDER": [np.flatnonzero(mat == 2)]}
    if name.endswith(".msh"):
        mesh.field_data = {"rock": np.array([1, 3]), "binder": np.array([2, 3])}
    mesh.write(at(name), **how)

for kind, cells, mat in [("tets", [("tetra", np.array(tets))], tet_material), ("hexes", [("hexahedron", np.array(hexes))], material)]:
    write(f"{kind}.vtk", cells, mat, file_format="vtk", binary=True)
    write(f"{kind}_text.vtk", cells, mat, file_format="vtk42", binary=False)
    write(f"{kind}.vtu", cells, mat, file_format="vtu", binary=True, compression="zlib")
    write(f"{kind}_text.vtu", cells, mat, file_format="vtu", binary=False)
    write(f"{kind}_22.msh", cells, mat, file_format="gmsh22", binary=False)
    write(f"{kind}.inp", cells, mat, file_format="abaqus")
write("binary.msh", [("tetra", np.array(tets))], tet_material, file_format="gmsh22", binary=True)

import gmsh
gmsh.initialize()
gmsh.option.setNumber("General.Terminal", 0)
a = gmsh.model.occ.addBox(0, 0, 0, 2, 2, 1)
b = gmsh.model.occ.addBox(2, 0, 0, 1, 2, 1)
gmsh.model.occ.fragment([(3, a)], [(3, b)])
gmsh.model.occ.synchronize()
gmsh.model.addPhysicalGroup(3, [a], 11, name="rock")
gmsh.model.addPhysicalGroup(3, [b], 12, name="binder")
gmsh.option.setNumber("Mesh.MeshSizeMin", 1)
gmsh.model.mesh.generate(3)
gmsh.option.setNumber("Mesh.Binary", 0)
gmsh.option.setNumber("Mesh.MshFileVersion", 4.1)
gmsh.write(at("gmsh_41.msh"))
gmsh.option.setNumber("Mesh.MshFileVersion", 2.2)
gmsh.write(at("gmsh_22.msh"))
gmsh.finalize()
