//! K6 and K8: surfaces of triangles as strangers have them, and what walls of meshes cost.
