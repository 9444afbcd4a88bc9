//! `read_data`: box, particles, velocities, masses and coefficients from a LAMMPS data file.

use super::data::body::{DataFile, How};
use super::data::properties::{Section, fill};
use super::data::words::{Adding, Ids, Offsets, extra_types, ids, outside};
use super::data::{Column, body};
use super::{Act, CommandStyle};
use perigrain_base::diag::{Code, Diagnostic, Result, Source, Span, fail};
use perigrain_geometry::text::find;
use perigrain_lang::{Args, Word};
use perigrain_styles::common::{self, id};
use perigrain_styles::words::{At, Syntax, Words, read};
use perigrain_styles::{ActCx, BuildCx, Doc, Style};
use perigrain_world::index::Index;
use perigrain_world::{Domain, Particles, Promise, World, memory};
use std::sync::Arc;

/// The command.
pub struct ReadData;

impl Style for ReadData {
    fn name(&self) -> &'static str {
        "read_data"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Reads box, particles, velocities, masses and coefficients from a LAMMPS data file.",
            text: "The file is LAMMPS' format, packed with gzip if its name ends in `.gz`. The header gives `N atoms`, `N atom \
                   types`, `xlo xhi`, `ylo yhi`, `zlo zhi`, for atom styles with bonds also `N bonds` and `N bond types`, with \
                   angles `N angles` and `N angle types`; sections are Masses, Atoms, Velocities, Bonds (number, type, two ids), \
                   Angles (number, type, three ids), Pair Coeffs, PairIJ Coeffs, Bond Coeffs and Angle Coeffs.\n\n\
                   Columns of Atoms: `id type x y z` (atomic), `id type diameter density x y z` (sphere), `id type volume density x \
                   y z` (peri), `id molecule type x y z` (bond, angle, molecular), `id type charge x y z` (charge), `id type charge \
                   x y z mux muy muz` (dipole), `id molecule type charge x y z` (full), `id molecule type diameter density x y z` \
                   (bpm/sphere), `id type x y z` and then the columns of each style in the order of its name (hybrid; what two have \
                   stands once), all with three image flags at the end or none. Velocities: `id vx vy vz`, with spheres also `wx wy \
                   wz`.\n\n\
                   The density of a sphere becomes the mass 4/3 π r³ ρ; without a radius it is the mass. The place at creation of \
                   peridynamic particles is the place in the file: families are built anew, and damage and contact history are not \
                   in a data file (write_restart has them). Masses of types are skipped where particles in a hybrid with bonds have \
                   their own (LAMMPS writes zeros there).\n\n\
                   Positions are wrapped along periodic dimensions; elsewhere they must be inside the box, which is opened by 1e-4 \
                   of its edge at shrink-wrapped faces, which then follow the particles. Image flags of other dimensions become 0, \
                   with a warning.\n\n\
                   Where a comment names the style (`Atoms # sphere`, `Atoms # hybrid sphere peri`, which LAMMPS takes and which \
                   `Atoms # hybrid` may leave out), it must be one with the deck's columns; LAMMPS only warns. Ids that occur \
                   twice, lines beyond the promised number and particles outside are refused in the file itself. Refused by name: \
                   dihedrals and impropers, type labels, general triclinic boxes, sections of fixes that no `fix` names.",
            example: "write_data plate.data\nread_data plate.data add append shift 0.0 0.0 0.02",
        }
    }
}

#[derive(Words)]
#[word(refused = "extra/dihedral/types extra/improper/types extra/dihedral/per/atom extra/improper/per/atom")]
struct Line {
    /// The file; it is looked for in the working folder, then beside the deck.
    #[word(name = "FILE", what = "a file name", kind = Kind::File)]
    file: Word,
    /// Brings particles into the box that is there, which grows to hold the file's.
    #[word(keyword, name = "IDOFFSET", with = ids, kind = Adding::KIND)]
    add: Option<Ids>,
    /// Added to types, bond types and angle types; the last two numbers are for dihedrals and impropers. Needs `add`.
    #[word(keyword, name = "types", placed)]
    offset: Option<At<Offsets>>,
    /// Added to places and to the file's box; needs `add` [length].
    #[word(keyword, name = "X Y Z", what = "a component of the shift", placed)]
    shift: Option<At<[f64; 3]>>,
    /// Room for more types of particles.
    #[word(keyword = "extra/atom/types", name = "N", with = extra_types, kind = Kind::Whole, default = 0)]
    extra_types: usize,
    /// Room for more types of bonds.
    #[word(keyword = "extra/bond/types", name = "N", with = extra_types, kind = Kind::Whole, default = 0)]
    extra_bond_types: usize,
    /// Room for more types of angles.
    #[word(keyword = "extra/angle/types", name = "N", with = extra_types, kind = Kind::Whole, default = 0)]
    extra_angle_types: usize,
    /// LAMMPS' room for bonds; without effect, as lists grow.
    #[word(keyword = "extra/bond/per/atom", name = "N", what = "the extra room", from = 0)]
    room_for_bonds: Option<i64>,
    /// LAMMPS' room for angles; without effect.
    #[word(keyword = "extra/angle/per/atom", name = "N", what = "the extra room", from = 0)]
    room_for_angles: Option<i64>,
    /// LAMMPS' room for what is bonded; without effect.
    #[word(keyword = "extra/special/per/atom", name = "N", what = "the extra room", from = 0)]
    room_for_special: Option<i64>,
    /// The particles join this group, new if there is none.
    #[word(keyword, name = "ID", with = group, kind = Kind::Group)]
    group: Option<Word>,
    /// Coefficients are skipped.
    #[word(flag)]
    nocoeff: bool,
    /// Reads a section of this heading (`NULL`: the fix's ID) into the properties of a fix property/atom: a line for each particle, its id and then
    /// the values in the order of the fix's line; a file without the section leaves zeros. HEADER has no meaning.
    #[word(keyword, name = "section")]
    fix: Vec<Section>,
}

/// The group that particles join.
fn group(args: &mut Args, _: &BuildCx) -> Result<Word> {
    let word = args.expect("a group")?;
    id(word, "the group")?;
    Ok(word.clone())
}

/// A parsed line.
struct Reading {
    file: Word,
    ids: Ids,
    type_offset: u16,
    bond_offset: u16,
    extra_bond_types: usize,
    angle_offset: u16,
    extra_angle_types: usize,
    shift: [f64; 3],
    extra_types: usize,
    group: Option<Word>,
    no_coeff: bool,
    sections: Vec<Section>,
    checking: bool,
}

impl CommandStyle for ReadData {
    fn parse(&self, a: &mut Args, cx: &BuildCx) -> Result<Box<dyn Act>> {
        let line: Line = read(a, cx)?;
        let there = cx.world.domain.is_some();
        if line.add.is_none() && there {
            let text = "the simulation box is defined already";
            let d = Diagnostic::error(Code::WRONG_ORDER, a.name_span(), text);
            return Err(d
                .help("write `add append`, `add merge` or `add N` to bring more particles into it")
                .into());
        }
        if line.add.is_some() && !there {
            return fail(Code::WRONG_ORDER, a.name_span(), "`add` needs a box to add to");
        }
        let (offset, shift) = (line.offset.as_ref().map(|o| o.span), line.shift.as_ref().map(|s| s.span));
        if let (None, Some((name, span))) = (line.add, first(("offset", offset), ("shift", shift))) {
            return fail(Code::CONFLICT, span, format!("`{name}` goes only with `add`"));
        }
        let [type_offset, bond_offset, angle_offset] = line.offset.map_or([0; 3], |o| o.value.used());
        Ok(Box::new(Reading {
            file: line.file,
            ids: line.add.unwrap_or(Ids::First),
            type_offset,
            bond_offset,
            extra_bond_types: line.extra_bond_types,
            angle_offset,
            extra_angle_types: line.extra_angle_types,
            shift: line.shift.map_or([0.0; 3], |s| s.value),
            extra_types: line.extra_types,
            group: line.group,
            no_coeff: line.nocoeff,
            sections: line.fix,
            checking: cx.checking,
        }))
    }
}

/// Which of two keywords stands first in the line, and where.
fn first(
    one: (&'static str, Option<Span>),
    other: (&'static str, Option<Span>),
) -> Option<(&'static str, Span)> {
    let found = [one, other].into_iter().filter_map(|(name, span)| Some((name, span?)));
    found.min_by_key(|(_, span)| span.start)
}

impl Act for Reading {
    fn apply(self: Box<Self>, cx: &mut ActCx) -> Result<()> {
        let began = std::time::Instant::now();
        let text = match self.text(cx.world)? {
            Found::File(text) => text,
            Found::Promised(scene) => return self.promised(cx, &scene),
        };
        cx.print("Reading data file ...");
        let world = &*cx.world;
        let how = How {
            style: world.particles.style,
            types: world.domain.is_some().then_some(world.types),
            type_offset: self.type_offset,
            extra_types: self.extra_types,
            no_coeff: self.no_coeff,
            bond_types: world.domain.is_some().then_some(world.bonds.types),
            bond_offset: self.bond_offset,
            extra_bond_types: self.extra_bond_types,
            angle_types: world.domain.is_some().then_some(world.bonds.angles.types),
            angle_offset: self.angle_offset,
            extra_angle_types: self.extra_angle_types,
            sections: &self.sections,
        };
        let outcome = body::read(&text.text, &how).and_then(|data| self.place(cx, data, &text.text));
        let mut data = outcome.map_err(|e| e.within(&text))?;
        std::mem::take(&mut data.notes).within(&text).0.into_iter().for_each(|note| cx.note(note));
        self.enter(cx, &mut data)?;
        self.miss_sections(cx, &data);
        let coeffs = std::mem::take(&mut data.coeffs);
        cx.then.extend(coeffs.into_iter().map(|line| (line, text.clone())));
        if !self.checking {
            cx.print(format!("  read_data CPU = {:.3} seconds", began.elapsed().as_secs_f64()));
        }
        Ok(())
    }

    /// `perigrain check` reads the file, too, but keeps no particles.
    fn needs_particles(&self) -> bool {
        false
    }

    fn settles(&self) -> Vec<&'static str> {
        vec!["particles", "volume", "density", "mass", "diameter"]
    }
}

/// Where the file's content is.
enum Found {
    File(Arc<Source>),
    /// Check mode: an earlier line would have written it.
    Promised(Arc<World>),
}

impl Reading {
    fn text(&self, world: &World) -> Result<Found> {
        match world.promised.get(&self.file.text) {
            Some(Promise::Scene(scene, _)) => Ok(Found::Promised(scene.clone())),
            _ => find(world, &self.file, "data file").map(Found::File),
        }
    }

    /// Warns of sections that the file does not have.
    fn miss_sections(&self, cx: &ActCx, data: &DataFile) {
        let has = |k: usize| data.filled.iter().any(|f| f.section == k) || data.header.atoms == 0;
        for (_, section) in self.sections.iter().enumerate().filter(|(k, _)| !has(*k)) {
            let text = format!("the file has no section `{}`: these properties stay 0", section.name);
            cx.notes.borrow_mut().push(Diagnostic::warning(Code::SUSPICIOUS, section.span, text));
        }
    }

    /// The box of a file that an earlier line of a checked deck would have written.
    fn promised(&self, cx: &mut ActCx, scene: &World) -> Result<()> {
        let Some(domain) = &*scene.domain else { return Ok(()) };
        let boundary = cx.world.settings.boundary;
        cx.world.domain = Some(Domain { boundary, ..domain.clone() }).into();
        cx.world.types = cx.world.types.max(scene.types + self.extra_types);
        cx.world.type_mass = scene.type_mass.clone();
        cx.world.type_mass.resize(cx.world.types, None);
        cx.world.bonds.types = scene.bonds.types + self.extra_bond_types;
        cx.world.bonds.angles.types = scene.bonds.angles.types + self.extra_angle_types;
        self.group(cx).map(|_| ())
    }

    /// Ids, places and images as they will be in the world; the file's box grows into the present one.
    fn place(&self, cx: &mut ActCx, mut data: DataFile, text: &str) -> Result<DataFile> {
        let world = &*cx.world;
        let domain = self.domain(world, &data);
        if domain.tilt.unwrap_or_default() != data.header.tilt.unwrap_or_default() {
            let text = "the box of the file does not lean as the one that is there";
            return fail(Code::CONFLICT, self.file.span, text);
        }
        let periodic = domain.periodic();
        let mut p = std::mem::take(&mut data.particles);
        data.particles.style = p.style;
        let span = |k: usize, column: Column| data.span(text, k, column);
        let add = match self.ids {
            Ids::First | Ids::Merge => 0,
            Ids::Append => world.particles.last_tag(),
            Ids::Offset(k) => k,
        };
        let mut flags = false;
        for k in 0..p.len() {
            let Some(tag) = p.tag[k].checked_add(add) else {
                let text = format!("the id {} plus {add} is beyond {}", p.tag[k], u32::MAX);
                return fail(Code::TOO_LARGE, span(k, Column::Id), text);
            };
            p.tag[k] = tag;
            let mut image = p.image[k];
            for d in 0..3 {
                p.x[k][d] += self.shift[d];
                if !periodic[d] && std::mem::take(&mut image[d]) != 0 {
                    flags = true;
                }
            }
            domain.wrap(&mut p.x[k], &mut image);
            p.image.set(k, image);
            let at = domain.upright(&p.x[k]);
            let within = |d: usize| at[d] >= domain.lo[d] && at[d] < domain.hi[d];
            // Rounding may leave a wrapped particle on the upper face of a leaning box.
            let settled = |d: usize| domain.tilted() && periodic[d];
            if let Some(d) = (0..3).find(|&d| !within(d) && !settled(d)) {
                return Err(outside(&domain, d, &at, span(k, Column::X(d)), p.tag[k]));
            }
        }
        if !world.particles.is_empty() {
            let index = Index::new(&world.particles.tag);
            if let Some(k) = (0..p.len()).find(|&k| index.find(p.tag[k], &world.particles.tag).is_some()) {
                let text = format!("there is a particle {} already", p.tag[k]);
                let d = Diagnostic::error(Code::DUPLICATE_NAME, span(k, Column::Id), text);
                return Err(d.help("`add append` gives new ids").into());
            }
        }
        if flags {
            let text = "image flags along dimensions that are not periodic were set to 0";
            cx.note(Diagnostic::warning(Code::SUSPICIOUS, None, text));
        }
        if data.idle_masses {
            let text = "the section Masses has no effect: every particle has its own mass";
            cx.note(Diagnostic::note(Code::NO_EFFECT, self.file.span, text));
        }
        data.particles = p;
        for (bond, _) in &mut data.bonds {
            bond.ends = bond.ends.map(|tag| tag.saturating_add(add));
        }
        for angle in &mut data.angles {
            angle.ends = angle.ends.map(|tag| tag.saturating_add(add));
        }
        Ok(data)
    }

    /// The box afterwards.
    fn domain(&self, world: &World, data: &DataFile) -> Domain {
        let mut lo: [f64; 3] = std::array::from_fn(|d| data.header.lo[d] + self.shift[d]);
        let mut hi: [f64; 3] = std::array::from_fn(|d| data.header.hi[d] + self.shift[d]);
        if let Some(old) = &*world.domain {
            for d in 0..3 {
                (lo[d], hi[d]) = (lo[d].min(old.lo[d]), hi[d].max(old.hi[d]));
            }
        }
        let flat = world.settings.two_dimensional;
        // The first box defines how all lean, as `boundary` defines its faces.
        let tilt = world.domain.as_ref().map_or(data.header.tilt, |old| old.tilt);
        let mut domain = Domain { flat, tilt, ..Domain::new(lo, hi, world.settings.boundary) };
        domain.open_shrinking_faces();
        domain
    }

    /// The group the particles join, new if there is none.
    fn group(&self, cx: &mut ActCx) -> Result<u32> {
        let Some(word) = &self.group else { return Ok(0) };
        match cx.world.groups.find_or_add(&word.text) {
            Some(id) => Ok(id.bit()),
            None => fail(Code::TOO_LARGE, word.span, "there are 32 groups already"),
        }
    }

    /// Puts everything into the world.
    fn enter(&self, cx: &mut ActCx, data: &mut DataFile) -> Result<()> {
        let count = data.particles.len();
        if let Some(line) = memory::forecast(cx.world, count as f64)? {
            cx.print(line);
        }
        let domain = self.domain(cx.world, data);
        let faces = (domain.lo[2], domain.hi[2]);
        common::check_flat(domain.boundary, faces, domain.flat).map_err(|e| e.at(self.file.span))?;
        common::check_volume(domain.lengths()).map_err(|e| e.at(self.file.span))?;
        if let Some(d) = memory::lacking_for_types(data.types) {
            return Err(d.at(self.file.span).into());
        }
        let bit = self.group(cx)?;
        self.log_summary(cx, data, &domain);
        let w = &mut *cx.world;
        w.domain = Some(domain).into();
        w.types = data.types;
        w.type_mass.resize(data.types, None);
        (w.bonds.types, w.bonds.angles.types) = (data.bond_types, data.angle_types);
        for &(kind, mass) in &data.masses {
            w.type_mass[usize::from(kind) - 1] = Some(mass);
        }
        if !self.checking {
            let mut new = std::mem::take(&mut data.particles);
            let first = w.n();
            finish(&mut new, bit);
            common::join(w, new);
            fill(w, &self.sections, &data.filled, first);
            data.bonds.drain(..).for_each(|(bond, _)| w.bonds.push(bond));
            w.bonds.angles.list.append(&mut data.angles);
            w.bonds.find_special();
            // LAMMPS lets shrink-wrapped faces follow at once.
            common::settle(w);
        }
        w.spread_type_masses();
        w.touch();
        Ok(())
    }

    fn log_summary(&self, cx: &mut ActCx, data: &DataFile, domain: &Domain) {
        cx.print(format!("  {}", domain.describe(domain.min_lo, domain.min_hi)));
        common::warn_of_skew(cx, domain);
        cx.print("  1 by 1 by 1 MPI processor grid");
        let count = data.particles.len();
        cx.print("  reading atoms ...");
        cx.print(format!("  {count} atoms"));
        if data.velocities {
            cx.print("  reading velocities ...");
            cx.print(format!("  {count} velocities"));
        }
        if !data.bonds.is_empty() {
            cx.print("  reading bonds ...");
            cx.print(format!("  {} bonds", data.bonds.len()));
        }
        if !data.angles.is_empty() {
            cx.print("  reading angles ...");
            cx.print(format!("  {} angles", data.angles.len()));
        }
    }
}

/// Masses from densities, places at creation, group bits.
fn finish(p: &mut Particles, bit: u32) {
    p.mask.iter_mut().for_each(|m| *m |= bit);
    if p.style.peri {
        p.x0.clone_from(&p.x);
    }
    if p.style.own_mass() {
        let density = p.density.clone();
        let all: Vec<usize> = (0..p.len()).collect();
        common::masses_from_density(p, &all, &density);
    }
}
