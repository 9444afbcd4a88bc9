//! Small meshes in each format, and what is wrong in others.

use super::*;

fn of(name: &str, text: &str) -> Result<Mesh> {
    let file = File { name: name.to_string(), bytes: text.as_bytes().to_vec(), at: Span::default() };
    read(&file, name)
}

/// The bytes that a refusal underlines, and its message.
fn refused(name: &str, text: &str) -> (String, String) {
    let d = of(name, text).expect_err(text).0.remove(0);
    let s = d.span.unwrap_or_default();
    (text.get(s.start as usize..s.end as usize).unwrap_or("").trim().to_string(), d.message)
}

const GMSH2: &str = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n3 7 \"rock\"\n$EndPhysicalNames\n$Nodes\n5\n\
                     1 0 0 0\n2 1 0 0\n3 0 1 0\n40 0 0 1\n5 1 1 1\n$EndNodes\n$Elements\n4\n1 15 2 0 1 1\n2 2 2 3 1 1 2 3\n\
                     3 4 2 7 1 1 2 3 40\n4 4 2 8 1 2 3 40 5\n$EndElements\n";

const GMSH4: &str = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n3 7 \"rock\"\n$EndPhysicalNames\n$Entities\n1 0 0 2\n\
                     9 0 0 0 0\n1 0 0 0 1 1 1 1 7 0\n2 0 0 0 1 1 1 1 8 0\n$EndEntities\n$Nodes\n1 5 1 40\n3 1 0 5\n1\n2\n3\n40\n5\n\
                     0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 1 1\n$EndNodes\n$Elements\n3 3 1 4\n0 9 15 1\n1 1\n3 1 4 1\n3 1 2 3 40\n\
                     3 2 4 1\n4 2 3 40 5\n$EndElements\n";

const ABAQUS: &str = "*HEADING\n two tets\n** a comment\n*Node, nset=all\n1, 0., 0., 0.\n2, 1., 0., 0.\n3, 0., 1., 0.\n40, 0., 0., 1.\n\
                      5, 1., 1., 1.\n*ELEMENT, TYPE=C3D4, ELSET=Rock\n3, 1, 2, 3,\n40\n4, 2, 3, 40, 5\n*Elset, elset=second, generate\n\
                      4, 8, 2\n*ELSET, ELSET=both\nsecond, 3\n*MATERIAL, NAME=x\n*DENSITY\n2000.,\n";

const VTK: &str = "# vtk DataFile Version 3.0\ntets\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 5 double\n0 0 0 1 0 0 0 1 0 0 0 1\n1 1 1\n\
                   CELLS 3 12\n1 0\n4 0 1 2 3\n4 1 2 3 4\nCELL_TYPES 3\n1 10 10\nCELL_DATA 3\nSCALARS Material int 1\nLOOKUP_TABLE default\n\
                   0 7 8\nVECTORS n float\n0 0 0 0 0 0 0 0 0\nPOINT_DATA 5\nSCALARS t float\nLOOKUP_TABLE default\n0 0 0 0 0\n";

fn two_tetrahedra(mesh: &Mesh) {
    assert_eq!((mesh.count(), mesh.points.len()), (2, 5));
    let at = |k: usize| mesh.corners(k).iter().map(|p| mesh.points[*p as usize]).collect::<Vec<_>>();
    let (v, _) = cell::measure(Shape::Tetrahedron, &at(0)).unwrap();
    let (w, x) = cell::measure(Shape::Tetrahedron, &at(1)).unwrap();
    // Calculated by hand: a sixth of the unit cube, and a third of it whose corners are the three on the axes and (1, 1, 1).
    assert!((v - 1.0 / 6.0).abs() < 1e-15 && (w - 1.0 / 3.0).abs() < 1e-15 && x == [0.5; 3]);
}

#[test]
fn each_format_gives_the_same_cells() {
    for (name, text) in [("a.vtk", VTK), ("a.inp", ABAQUS), ("b.MSH", GMSH4)] {
        two_tetrahedra(&of(name, text).unwrap());
    }
    let mesh = of("a.msh", GMSH2).unwrap();
    assert_eq!(mesh.shapes, [Shape::Triangle, Shape::Tetrahedron, Shape::Tetrahedron]);
    assert_eq!((mesh.skipped["points"], &mesh.numbers[..]), (1, &[2, 3, 4][..]));
    let set = |m: &Mesh, name: &str, number| {
        m.sets.iter().find(|s| s.name == name && s.number == number).unwrap().cells.clone()
    };
    assert_eq!((set(&mesh, "rock", Some(7)), set(&mesh, "", Some(8))), (vec![1], vec![2]));
    let mesh = of("a.msh", GMSH4).unwrap();
    assert_eq!((set(&mesh, "rock", Some(7)), set(&mesh, "", Some(8))), (vec![0], vec![1]));
    let mesh = of("a.inp", ABAQUS).unwrap();
    assert_eq!(set(&mesh, "ROCK", None), [0, 1]);
    assert_eq!((set(&mesh, "SECOND", None), set(&mesh, "BOTH", None)), (vec![1], vec![1, 0]));
    let mesh = of("a.vtk", VTK).unwrap();
    assert_eq!(mesh.arrays, [("Material".to_string(), vec![7.0, 8.0])]);
}

#[test]
fn mistakes_are_shown_where_they_are() {
    let cases: &[(&str, &str, &str, &str, &str, &str)] = &[
        ("a.msh", GMSH2, "2.2 0 8", "3.0 0 8", "3.0 0 8", "version 3.0"),
        ("a.msh", GMSH2, "$MeshFormat\n", "mesh\n", "", "must begin with $MeshFormat"),
        ("a.msh", GMSH2, "3 0 1 0\n", "3 0 one 0\n", "one", "y must be a number"),
        ("a.msh", GMSH2, "3 0 1 0\n", "2 0 1 0\n", "$Nodes", "two nodes 2"),
        ("a.msh", GMSH2, "3 0 1 0\n", "", "$EndNodes", "number of the node"),
        ("a.msh", GMSH2, "1 2 3 40\n", "1 2 3 41\n", "41", "there is no node 41"),
        ("a.msh", GMSH2, "3 4 2 7 1 1", "3 99 2 7 1 1", "3 99 2 7 1 1 2 3 40", "kind 99"),
        ("a.msh", GMSH2, "1 2 3 40\n", "1 2 3\n", "3 4 2 7 1 1 2 3", "has 4 nodes, not 3"),
        ("a.msh", GMSH2, "$EndElements\n", "", "", "ends within the section $Elements"),
        (
            "a.msh",
            GMSH2,
            "$Elements\n4",
            "$Elements\n3",
            "4 4 2 8 1 2 3 40 5",
            "$EndElements must stand here",
        ),
        ("a.msh", GMSH4, "3 3 1 4", "3 4 1 4", "3 4 1 4", "there are 3 elements"),
        ("a.msh", GMSH4, "1 1 7 0", "1 5 7 0", "1 0 0 0 1 1 1 5 7 0", "has 5 physical groups"),
        ("a.inp", ABAQUS, "TYPE=C3D4", "TYPE=CAX4", "*ELEMENT, TYPE=CAX4, ELSET=Rock", "element type `CAX4`"),
        ("a.inp", ABAQUS, "TYPE=C3D4", "TIPE=C3D4", "*ELEMENT, TIPE=C3D4, ELSET=Rock", "needs a TYPE"),
        ("a.inp", ABAQUS, "4, 2, 3, 40, 5", "4, 2, 3, 40", "4, 2, 3, 40", "has 4 nodes, not 3"),
        ("a.inp", ABAQUS, "4, 8, 2", "4, 8, 0", "4, 8, 0", "step must be above 0"),
        ("a.inp", ABAQUS, "*MATERIAL, NAME=x", "*NGEN", "*NGEN", "*NGEN"),
        ("a.inp", ABAQUS, "second, 3", "third, 3", "third", "no element set `THIRD`"),
        ("a.vtk", VTK, "UNSTRUCTURED_GRID", "POLYDATA", "POLYDATA", "data set POLYDATA"),
        ("a.vtk", VTK, "1 1 1\nCELLS", "1 1 x\nCELLS", "x", "a number of POINTS"),
        ("a.vtk", VTK, "4 1 2 3 4\n", "4 1 2 3 5\n", "4 1 2 3 5", "cell 2 has point 5"),
        ("a.vtk", VTK, "1 10 10\n", "1 10 42\n", "4 1 2 3 4", "kind 42"),
        ("a.vtk", VTK, "1 10 10\n", "1 10 12\n", "4 1 2 3 4", "with 8 points, not 4"),
        ("a.vtk", VTK, "CELLS 3 12", "CELLS 3 13", "CELL_TYPES", "a number of CELLS"),
        ("a.vtk", VTK, "POINTS 5", "POINTS 5000000", "5000000", "too short"),
    ];
    for (name, text, from, to, word, printed) in cases {
        assert!(text.contains(from), "{from}");
        let (blamed, message) = refused(name, &text.replacen(from, to, 1));
        assert!(message.contains(printed), "{from} -> {to}: {message}");
        assert!(word.is_empty() || blamed == *word, "{from} -> {to}: {blamed:?} {message}");
    }
    assert!(refused("a.obj", "").1.contains("its name must end in"));
}

#[test]
fn cells_made_twice_are_found() {
    let mut mesh = of("a.vtk", VTK).unwrap();
    assert_eq!(mesh.twice(), None);
    mesh.add(Element::Cell(Shape::Tetrahedron, 4), &[3, 1, 4, 2], 9, Span::default()).unwrap();
    assert_eq!(mesh.twice(), Some((2, 1)));
}
