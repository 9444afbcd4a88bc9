//! Dynamic groups: their members are chosen anew in each step, after forces and before the fixes that change them.

use super::node::{FixNode, Graph};
use super::seal::Sealer;
use perigrain_base::diag::{Code, Diagnostic, Diagnostics, Result};
use perigrain_lang::{RefKind, ValueRef};
use perigrain_plan::{About, Needs, Op, Stage, Tick, When};
use perigrain_styles::step_op::StepOp;
use perigrain_styles::surface::choose;
use perigrain_styles::{Reading, SealCx};
use perigrain_world::field::{BOX, FAMILIES, LISTS, MASK, REGIONS, SLOTS, VOLUME, X};
use perigrain_world::{GroupId, Key, Region, World};

/// Adds the ops that choose the members of dynamic groups.
///
/// # Errors
/// Variables that are gone.
pub fn seal(s: &mut Sealer) -> Result<()> {
    let groups = &s.world().groups;
    let list: Vec<_> =
        groups.dynamics().map(|(id, d)| (id, groups.name(id).to_string(), d.clone())).collect();
    for (group, name, rule) in list {
        let when = When::First.or(When::Every(rule.every));
        let chosen = match &rule.variable {
            None => None,
            Some(v) => {
                let r =
                    ValueRef { kind: RefKind::Variable, name: v.name.clone(), index: vec![], span: v.span };
                Some(s.value(&r, Stage::PostForce, &when)?)
            }
        };
        let (title, region) = (format!("group {name} dynamic"), rule.region.as_deref().map(Key::new));
        let op = Choose { title, group, parent: rule.parent, region, chosen, when };
        let span = s.span();
        s.add(vec![Box::new(op)], span);
    }
    let surfaces: Vec<_> = s.world().groups.surfaces().to_vec();
    for (group, surface) in surfaces {
        let Some(every) = surface.every else { continue };
        let title = format!("group {} surface", s.world().groups.name(group));
        let op = StepOp::new(
            title,
            Stage::EndOfStep,
            Needs::new().read(X | VOLUME | FAMILIES | BOX).write(MASK | LISTS),
            move |w, _| {
                if choose(w, group.bit(), &surface) {
                    // Contacts are looked for anew in the next step.
                    w.rebuild.due = true;
                }
                Ok(())
            },
        );
        let when = When::First.or(When::Every(every));
        let span = s.span();
        s.add(vec![op.when(when).in_setup(true).boxed()], span);
    }
    Ok(())
}

/// Fixes that keep the particles of their group from the start, or cannot use others: LAMMPS allows no dynamic group for them.
const FIXED_MEMBERS: [&str; 17] = [
    "adapt",
    "ave/atom",
    "drag",
    "freeze",
    "halt",
    "indent",
    "move",
    "nve/noforce",
    "print",
    "property/atom",
    "spring/self",
    "store/force",
    "store/state",
    "vector",
    "wall/gran",
    "wall/gran/region",
    "wall/mesh",
];

/// Reports fixes that cannot have a group whose members change.
pub fn check(graph: &Graph, w: &World, found: &mut Diagnostics) {
    let changing = |f: &&FixNode| w.groups.dynamic(f.group).is_some() && FIXED_MEMBERS.contains(&f.style);
    for f in graph.fixes.iter().filter(changing) {
        let text = format!("fix {} does not go with the dynamic group `{}`", f.style, w.groups.name(f.group));
        let d = Diagnostic::error(Code::CONFLICT, f.span, text);
        found.push(d.help("make the group static with `group ID static`, or give the fix another group"));
    }
}

/// Chooses the members of one group.
struct Choose {
    title: String,
    group: GroupId,
    parent: GroupId,
    region: Option<Key<Region>>,
    chosen: Option<Reading>,
    when: When,
}

impl Op for Choose {
    fn about(&self) -> About {
        About {
            when: self.when.clone(),
            ..About::new(&self.title, Stage::PostForce, Needs::new().read(X | REGIONS | SLOTS).write(MASK))
        }
    }
    fn run(&mut self, w: &mut World, _t: &Tick) -> Result<()> {
        let mut mask = std::mem::take(&mut w.particles.mask);
        let region = self.region.map(|key| w.regions.get(key));
        let (parent, bit) = (self.parent.bit(), self.group.bit());
        for (i, mask) in mask.iter_mut().enumerate() {
            let here = region.is_none_or(|r| r.is_some_and(|r| r.contains(w.particles.x[i])));
            let meant = *mask & parent != 0 && here && self.chosen.is_none_or(|v| v.atom(w, i) != 0.0);
            *mask = if meant { *mask | bit } else { *mask & !bit };
        }
        w.particles.mask = mask;
        Ok(())
    }
}
