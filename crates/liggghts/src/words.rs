//! The words of LIGGGHTS by command and style, each with what becomes of it: recognition, `known:` lists and messages come from here.

use crate::{Translator, averages, clumps, contacts, dumps, idle, old, regions};
use perigrain_base::diag::Result;
use perigrain_lang::{Args, Command};

/// Translates a line; its command and its style are taken. `None` leaves the line as it is.
pub(crate) type Carry = fn(&mut Translator, &Command, &mut Args) -> Result<Option<Vec<Command>>>;

/// What becomes of a word.
#[derive(Clone, Copy)]
pub(crate) enum Take {
    /// Native lines.
    Lines(Carry),
    /// The line stays as it is: the native word is the same.
    Same,
    /// A note, with the reason why nothing is to be done.
    Idle(&'static str),
    /// An error: what it is, and what to take instead.
    Refused(&'static str, &'static str),
}

/// A word of LIGGGHTS.
pub(crate) struct Entry {
    pub command: &'static str,
    /// The style, with `*` for all that begin or end so; empty for a command.
    pub style: &'static str,
    /// Only LIGGGHTS has it: a deck that has it is a deck of LIGGGHTS.
    pub mark: bool,
    pub take: Take,
}

const fn entry(command: &'static str, style: &'static str, mark: bool, take: Take) -> Entry {
    Entry { command, style, mark, take }
}

const SHAPES: &str = "clumps of spheres: `molecule` and `fix rigid/small`";
/// What couples another program: a deck that does so cannot run without it.
pub(crate) const PARTNER: &str = "`fix external` and the Python module couple another program";
const FLUID: &str = "grains and solids are computed here, no fluid";

/// All of them, by command.
pub(crate) const TABLE: &[Entry] = &[
    entry("atom_style", "granular", true, Take::Lines(|_, cmd, _| Ok(Some(vec![idle::sphere(cmd)])))),
    entry("atom_style", "superquadric", true, Take::Refused("a shape that is no sphere", SHAPES)),
    entry("atom_style", "convexhull", true, Take::Refused("a shape that is no sphere", SHAPES)),
    entry("atom_style", "sph*", false, Take::Refused("a fluid of particles", FLUID)),
    entry("communicate", "", true, Take::Idle("every process has what it needs of the others")),
    entry("hard_particles", "", true, Take::Idle("LIGGGHTS' bounds of Young's modulus do not hold here")),
    entry("soft_particles", "", true, Take::Idle("LIGGGHTS' bounds of Young's modulus do not hold here")),
    entry("modify_timing", "", false, Take::Idle("the log has the time of each part; `timer` chooses more")),
    entry(
        "neigh_settings",
        "",
        false,
        Take::Idle("neighbour lists are set by `neighbor` and `neigh_modify`"),
    ),
    entry("thermo_log", "", true, Take::Idle("the log has every row of the step table")),
    entry(
        "coarsegraining",
        "",
        false,
        Take::Refused("a factor on the size of grains", "write larger diameters into the templates"),
    ),
    entry(
        "partitioner_style",
        "",
        false,
        Take::Idle("the box is divided among processes by how many grains there are"),
    ),
    entry("neigh_modify", "", false, Take::Lines(idle::neigh_modify)),
    entry("pair_style", "gran", true, Take::Lines(|t, cmd, _| t.pair_line(cmd))),
    entry("pair_style", "sph*", false, Take::Refused("a fluid of particles", FLUID)),
    entry("bond_style", "gran", false, Take::Refused("bonds of a fork of LIGGGHTS", "`bond_style bpm/beam`")),
    entry(
        "fix",
        "property/global",
        true,
        Take::Lines(|t, cmd, args| t.property(cmd, args).map(|()| Some(vec![]))),
    ),
    entry("fix", "property/atom", false, Take::Lines(|t, cmd, args| t.atom_property(cmd, args))),
    entry("fix", "particletemplate/sphere", true, Take::Lines(|t, cmd, args| t.template(cmd, args))),
    entry(
        "fix",
        "particletemplate/multisphere",
        true,
        Take::Lines(|t, cmd, args| t.clump(cmd, args).map(Some)),
    ),
    entry(
        "fix",
        "particletemplate/multiplespheres*",
        true,
        Take::Refused(
            "a template of bonded spheres",
            "`molecule` with bonds of `bond_style bpm/beam`, `mixture … mol` and `fix insert`",
        ),
    ),
    entry(
        "fix",
        "particletemplate/*",
        true,
        Take::Refused("a template of grains that are no spheres", SHAPES),
    ),
    entry(
        "fix",
        "particledistribution/discrete",
        true,
        Take::Lines(|t, cmd, args| t.distribution(cmd, args, "mass")),
    ),
    entry(
        "fix",
        "particledistribution/discrete/massbased",
        true,
        Take::Lines(|t, cmd, args| t.distribution(cmd, args, "mass")),
    ),
    entry(
        "fix",
        "particledistribution/discrete/numberbased",
        true,
        Take::Lines(|t, cmd, args| t.distribution(cmd, args, "number")),
    ),
    entry("fix", "insert/pack", true, Take::Lines(|t, cmd, args| t.insert(cmd, args, "pack"))),
    entry("fix", "insert/rate/region", true, Take::Lines(|t, cmd, args| t.insert(cmd, args, "rate"))),
    entry("fix", "insert/stream", true, Take::Lines(|t, cmd, args| t.insert(cmd, args, "stream"))),
    entry(
        "fix",
        "insert/*",
        true,
        Take::Refused("a way to insert grains", "`insert/pack`, `insert/rate/region` or `insert/stream`"),
    ),
    entry("fix", "mesh/surface", true, Take::Lines(|t, cmd, args| t.surface(cmd, args))),
    entry("fix", "mesh/surface/planar", true, Take::Lines(|t, cmd, args| t.surface(cmd, args))),
    entry("fix", "mesh/surface/stress", true, Take::Lines(|t, cmd, args| t.surface(cmd, args))),
    entry("fix", "mesh/surface/stress/servo", true, Take::Lines(|t, cmd, args| t.surface(cmd, args))),
    entry(
        "fix",
        "mesh/surface/stress/6dof*",
        true,
        Take::Refused("a surface that moves as a body", "`fix rigid` moves a body of spheres"),
    ),
    entry("fix", "move/mesh", false, Take::Lines(|t, cmd, args| t.mover(cmd, args))),
    entry("fix", "massflow/mesh", false, Take::Lines(|t, cmd, args| t.mass_flow(cmd, args))),
    entry("fix", "wall/gran", false, Take::Lines(|t, cmd, args| t.wall(cmd, args))),
    entry("fix", "pour", false, Take::Lines(|_, cmd, args| old::pour(cmd, args))),
    entry("fix", "check/timestep/gran", true, Take::Lines(|t, cmd, args| t.time_step(cmd, args).map(Some))),
    entry("fix", "multisphere", true, Take::Lines(|t, cmd, args| t.multisphere(cmd, args).map(Some))),
    entry(
        "fix",
        "multisphere*",
        true,
        Take::Refused(
            "grains of several spheres that break",
            "`fix multisphere`, or bonds of `bond_style bpm/beam`",
        ),
    ),
    entry("fix", "heat/gran", true, Take::Lines(|t, cmd, args| t.heat(cmd, args))),
    entry("fix", "heat/gran/conduction", true, Take::Lines(|t, cmd, args| t.heat(cmd, args))),
    entry(
        "fix",
        "heat/gran/*",
        true,
        Take::Refused(
            "heat that does not flow through contacts",
            "`fix heat/gran` conducts it, `set … property/atom heatSource` brings it",
        ),
    ),
    entry("fix", "couple/*", false, Take::Refused("a coupling to another program", PARTNER)),
    entry("fix", "sph/*", false, Take::Refused("a fluid of particles", FLUID)),
    entry("fix", "wall/sph", false, Take::Refused("a fluid of particles", FLUID)),
    entry("fix", "wall/region/sph", false, Take::Refused("a fluid of particles", FLUID)),
    entry("fix", "nve/sph", false, Take::Refused("a fluid of particles", FLUID)),
    entry("fix", "nve/sph/stationary", false, Take::Refused("a fluid of particles", FLUID)),
    entry("fix", "multicontact/*", false, Take::Refused("a law that is not pairwise", "`surface default`")),
    entry("compute", "erotate/superquadric", false, Take::Refused("a shape that is no sphere", SHAPES)),
    entry("fix", "nve/superquadric", false, Take::Refused("a shape that is no sphere", SHAPES)),
    entry(
        "fix",
        "magnetic",
        false,
        Take::Refused("a magnetic field", "`fix efield` acts on charges and dipoles"),
    ),
    entry(
        "fix",
        "ave/euler",
        false,
        Take::Refused("averages over cells", "`compute chunk/atom bin/3d` with `fix ave/chunk`"),
    ),
    entry(
        "fix",
        "property/atom/tracer*",
        false,
        Take::Refused("marks of grains", "`fix property/atom d_NAME` and `set region … d_NAME`"),
    ),
    entry(
        "compute",
        "erotate/multisphere",
        false,
        Take::Lines(|t, cmd, _| t.energy(cmd, "erotate/rigid").map(Some)),
    ),
    entry("compute", "ke/multisphere", false, Take::Lines(|t, cmd, _| t.energy(cmd, "ke/rigid").map(Some))),
    entry("compute", "multisphere", false, Take::Lines(|t, cmd, args| t.body_property(cmd, args).map(Some))),
    entry("compute", "rigid", false, Take::Lines(|t, cmd, args| t.body_property(cmd, args).map(Some))),
    entry(
        "fix",
        "mesh/surface/*",
        false,
        Take::Refused(
            "a surface of another kind",
            "`mesh/surface/stress` feels the grains, `mesh/surface/stress/servo` presses on them",
        ),
    ),
    entry(
        "fix",
        "buoyancy",
        false,
        Take::Refused(
            "the lift of a fluid",
            "`fix addforce` with an atom-style variable, as `mass*9.81*1000/2500`",
        ),
    ),
    entry(
        "fix",
        "check/timestep/*",
        false,
        Take::Refused("a check of the time step of other particles", "`check/timestep/gran`"),
    ),
    entry("fix", "lb/*", false, Take::Refused("a coupling to another program", PARTNER)),
    entry(
        "fix",
        "remove",
        false,
        Take::Refused(
            "grains that are taken away at a rate",
            "`delete_atoms`, or `massflow/mesh … count once delete_atoms yes`",
        ),
    ),
    entry(
        "fix",
        "efield/gran",
        false,
        Take::Refused("an electric field on grains", "`fix efield` acts on charges"),
    ),
    entry(
        "fix",
        "continuum/weighted",
        false,
        Take::Refused("averages over a field", "`compute continuum/chunk`"),
    ),
    entry(
        "fix",
        "particledistribution/*",
        false,
        Take::Refused("a distribution of another kind", "`particledistribution/discrete`"),
    ),
    entry(
        "fix",
        "template/multi*",
        false,
        Take::Refused(
            "a template of several spheres",
            "`molecule` with `fix rigid/small`, and `fix pour … mol`",
        ),
    ),
    entry(
        "fix",
        "breakparticle/*",
        false,
        Take::Refused("grains that break", "`bond_style bpm/beam` joins small grains to ones that break"),
    ),
    entry(
        "fix",
        "break/*",
        false,
        Take::Refused("grains that break", "`bond_style bpm/beam` joins small grains to ones that break"),
    ),
    entry(
        "fix",
        "topology/break",
        false,
        Take::Refused("grains that break", "`bond_style bpm/beam` joins small grains to ones that break"),
    ),
    entry(
        "fix",
        "liquidtransfer*",
        false,
        Take::Refused("liquid on grains", "`cohesion capillary` of pair_coeff has bridges of a given volume"),
    ),
    entry(
        "fix",
        "scalar_transport_equation*",
        false,
        Take::Refused("a transport equation on grains", "`fix heat/flow` conducts heat"),
    ),
    entry(
        "fix",
        "property/atom/regional*",
        false,
        Take::Refused("marks of grains", "`fix property/atom d_NAME` and `set region … d_NAME`"),
    ),
    entry("fix", "balance", false, Take::Lines(|t, cmd, _| t.idle_fix(cmd).map(Some))),
    entry("fix", "ave/spatial", false, Take::Lines(|t, cmd, args| t.bins(cmd, args))),
    entry("fix", "nve/limit", false, Take::Lines(|_, cmd, args| averages::limit(cmd, args))),
    entry(
        "compute",
        "nparticles/tracer/region",
        false,
        Take::Refused("marks of grains", "`variable n equal count(GROUP,REGION)`"),
    ),
    entry(
        "compute",
        "coord/gran",
        false,
        Take::Refused("neighbours of a grain", "`compute coord/atom`, or `compute contact/atom`"),
    ),
    entry(
        "compute",
        "contact/atom/gran",
        false,
        Take::Lines(|_, cmd, _| Ok(Some(contacts::renamed(cmd, "contact/atom")))),
    ),
    entry("compute", "pair/gran/local", false, Take::Lines(|t, cmd, args| t.contacts(cmd, args))),
    entry("compute", "property/local", false, Take::Lines(|t, cmd, _| Ok(t.local_values(cmd)))),
    entry("compute", "reduce", false, Take::Lines(|t, cmd, _| Ok(t.reduced(cmd)))),
    entry("compute", "erotate", false, Take::Lines(|_, cmd, _| Ok(Some(contacts::rotation(cmd))))),
    entry("compute", "stress/atom", false, Take::Lines(|_, cmd, _| Ok(contacts::stress(cmd)))),
    entry("compute", "wall/gran/local", false, Take::Lines(|t, cmd, args| t.wall_contacts(cmd, args))),
    entry("dump", "custom/vtk", true, Take::Lines(|_, cmd, args| dumps::custom(cmd, args).map(Some))),
    entry("dump", "custom", false, Take::Lines(|_, cmd, _| Ok(clumps::dump(cmd)))),
    entry("dump", "mesh/stl", false, Take::Lines(|t, cmd, args| t.mesh_dump(cmd, args, "mesh/stl"))),
    entry("dump", "stl", false, Take::Lines(|t, cmd, args| t.mesh_dump(cmd, args, "mesh/stl"))),
    entry("dump", "mesh/vtk", false, Take::Lines(|t, cmd, args| t.mesh_dump(cmd, args, "mesh/vtk"))),
    entry("dump", "mesh/gran/VTK", true, Take::Lines(|t, cmd, args| t.mesh_dump(cmd, args, "mesh/vtk"))),
    entry("dump", "decomposition/vtk", false, Take::Lines(|t, cmd, _| t.idle_dump(cmd).map(Some))),
    entry(
        "dump",
        "local/gran/vtk",
        false,
        Take::Refused("a picture of contacts", "`dump local` with `compute pair/local`"),
    ),
    entry("dump", "image/gran", false, Take::Refused("a picture", "`dump image`")),
    entry(
        "dump",
        "euler/vtk",
        false,
        Take::Refused("averages over cells", "`compute chunk/atom bin/3d` with `fix ave/chunk`"),
    ),
    entry(
        "dump",
        "*/vtm",
        false,
        Take::Refused("several kinds of data in one file", "`custom/vtk` and `mesh/vtk` write one file each"),
    ),
    entry(
        "dump",
        "atom/vtk",
        false,
        Take::Refused("a dump without attributes", "`custom/vtk` with the attributes"),
    ),
    entry("dump_modify", "", false, Take::Lines(|_, cmd, _| Ok(dumps::modified(cmd)))),
    entry("region", "mesh/tet", false, Take::Lines(|t, cmd, args| t.tetrahedra(cmd, args).map(Some))),
    entry("region", "wedge", false, Take::Lines(|_, cmd, args| regions::wedge(cmd, args).map(Some))),
    entry("set", "", false, Take::Lines(|t, cmd, _| t.set(cmd))),
    entry("run", "", false, Take::Lines(|t, cmd, _| Ok(t.first_whole(cmd, 0)))),
    entry("thermo", "", false, Take::Lines(|t, cmd, _| Ok(t.first_whole(cmd, 0)))),
    entry("unfix", "", false, Take::Lines(|t, cmd, _| Ok(t.unfix(cmd)))),
    entry("fix_modify", "", false, Take::Lines(|t, cmd, _| t.switched(cmd).map(|()| t.fix_modify(cmd)))),
    entry("create_box", "", false, Take::Lines(|t, cmd, _| Ok(t.create_box(cmd)))),
    entry("pair_coeff", "", false, Take::Lines(|t, cmd, _| Ok(t.pair_coeff(cmd)))),
    entry("fix", "wall/mesh", false, Take::Same),
];
