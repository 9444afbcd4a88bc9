//! The words of LIGGGHTS by command and style, each with what becomes of it: recognition, `known:` lists and messages come from here.

use crate::{Translator, contacts, dumps, idle, old, properties};
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
    /// The style, with `*` at its end for all that begin so; empty for a command.
    pub style: &'static str,
    /// Only LIGGGHTS has it: a deck that has it is a deck of LIGGGHTS.
    pub mark: bool,
    pub take: Take,
}

const fn entry(command: &'static str, style: &'static str, mark: bool, take: Take) -> Entry {
    Entry { command, style, mark, take }
}

const SHAPES: &str = "clumps of spheres: `molecule` and `fix rigid/small`";
const PARTNER: &str = "`fix external` and the Python module couple another program";
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
    entry("thermo_log", "", false, Take::Idle("the log has every row of the step table")),
    entry(
        "coarsegraining",
        "",
        false,
        Take::Refused("a factor on the size of grains", "write larger diameters into the templates"),
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
    entry(
        "fix",
        "property/atom",
        false,
        Take::Lines(|_, cmd, args| Ok(properties::atom_property(cmd, args)?.map(|l| vec![l]))),
    ),
    entry(
        "fix",
        "particletemplate/sphere",
        true,
        Take::Lines(|t, cmd, args| t.template(cmd, args).map(|()| Some(vec![]))),
    ),
    entry(
        "fix",
        "particletemplate/multisphere",
        true,
        Take::Refused(
            "a template of several spheres",
            "`molecule` with `fix rigid/small`, and `fix pour … mol`",
        ),
    ),
    entry(
        "fix",
        "particletemplate/multiplespheres*",
        true,
        Take::Refused("a template of bonded spheres", "`molecule` with bonds, and `fix pour … mol`"),
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
    entry(
        "fix",
        "multisphere*",
        true,
        Take::Refused("grains of several spheres", "`molecule` and `fix rigid/small`"),
    ),
    entry(
        "fix",
        "heat/gran*",
        true,
        Take::Refused(
            "conduction of heat between grains",
            "native lines: `fix property/atom temperature heatflow`, `fix heat/flow`, `heat` of pair_coeff",
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
        Take::Refused("grains of several spheres", "`molecule` and `fix rigid/small`"),
    ),
    entry("compute", "pair/gran/local", false, Take::Lines(|t, cmd, args| t.contacts(cmd, args))),
    entry("compute", "property/local", false, Take::Lines(|t, cmd, _| Ok(t.local_values(cmd)))),
    entry("compute", "reduce", false, Take::Lines(|t, cmd, _| Ok(t.reduced(cmd)))),
    entry("compute", "erotate", false, Take::Lines(|_, cmd, _| Ok(Some(contacts::rotation(cmd))))),
    entry("compute", "stress/atom", false, Take::Lines(|_, cmd, _| Ok(contacts::stress(cmd)))),
    entry(
        "compute",
        "wall/gran/local",
        false,
        Take::Refused("a table of contacts", "`contacts` behind `fix wall/mesh`, and `dump local`"),
    ),
    entry("dump", "custom/vtk", true, Take::Lines(|_, cmd, args| dumps::custom(cmd, args).map(Some))),
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
    entry("dump_modify", "", false, Take::Lines(|_, cmd, _| Ok(dumps::modified(cmd)))),
    entry(
        "region",
        "mesh/tet",
        false,
        Take::Refused("a region of tetrahedra", "`region mesh` with the closed surface as STL"),
    ),
    entry(
        "region",
        "wedge",
        false,
        Take::Refused("a wedge", "`region intersect` of a cylinder and prisms or blocks"),
    ),
    entry("set", "", false, Take::Lines(|t, cmd, _| t.set(cmd))),
    entry("run", "", false, Take::Lines(|t, cmd, _| Ok(t.first_whole(cmd, 0)))),
    entry("thermo", "", false, Take::Lines(|t, cmd, _| Ok(t.first_whole(cmd, 0)))),
    entry("unfix", "", false, Take::Lines(|t, cmd, _| Ok(t.unfix(cmd)))),
    entry("fix_modify", "", false, Take::Lines(|t, cmd, _| Ok(t.fix_modify(cmd)))),
    entry("create_box", "", false, Take::Lines(|t, cmd, _| Ok(t.create_box(cmd)))),
    entry("pair_coeff", "", false, Take::Lines(|t, cmd, _| Ok(t.pair_coeff(cmd)))),
    entry("fix", "wall/mesh", false, Take::Same),
];

/// At which word behind the command its style stands.
pub(crate) fn style_at(command: &str) -> usize {
    match command {
        "fix" | "compute" | "dump" => 2,
        "region" => 1,
        _ => 0,
    }
}

/// The word of LIGGGHTS that a line begins with.
pub(crate) fn find(cmd: &Command) -> Option<&'static Entry> {
    let command = cmd.name.text.as_str();
    let style = cmd.args.get(style_at(command)).map_or("", |w| w.text.as_str());
    let fits = |e: &&Entry| {
        e.command == command
            && match e.style.strip_suffix('*') {
                Some(start) => style.starts_with(start),
                None => e.style.is_empty() || e.style == style,
            }
    };
    TABLE.iter().find(fits)
}

/// The styles that LIGGGHTS has of a kind and that are read here.
pub fn known(command: &str) -> impl Iterator<Item = &'static str> {
    let of = command.to_string();
    let read = move |e: &&Entry| {
        e.command == of
            && !e.style.is_empty()
            && !matches!(e.take, Take::Refused(..))
            && !e.style.ends_with('*')
    };
    TABLE.iter().filter(read).map(|e| e.style)
}
