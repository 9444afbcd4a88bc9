//! Regions that follow variables, put where they are now: between runs, and in every step.

use super::env::DeckEnv;
use super::node::Graph;
use super::seal::Sealer;
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_lang::{RefKind, Value, ValueRef, Vars};
use perigrain_plan::{About, Level, Needs, Op, Stage, Tick, When};
use perigrain_styles::{Reading, SealCx};
use perigrain_world::field::{REGIONS, SLOTS};
use perigrain_world::region::Variable;
use perigrain_world::{Key, Region, World};

/// The stages whose ops find moving regions in their present places.
const STAGES: [Stage; 2] = [Stage::PreForce, Stage::Output];

/// Puts those regions that follow variables and are meant in their present places.
///
/// # Errors
/// Variables that are gone, have no number, or give a region no shape.
pub fn place_following(
    w: &mut World,
    graph: &Graph,
    vars: &Vars,
    meant: impl Fn(&str) -> bool,
) -> Result<()> {
    let follows = w.regions.iter().filter(|(key, region)| region.follows() && meant(key.text()));
    let keys: Vec<Key<Region>> = follows.map(|(key, _)| key).collect();
    for key in keys {
        // Out of the world meanwhile: a formula that queries the region it places would never end.
        let Some(region) = w.regions.remove(key) else { continue };
        let placed = placed(w, graph, vars, &region);
        w.regions.insert(key, placed.as_ref().unwrap_or(&region).clone());
        placed.map_err(|mut e| {
            e.0.iter_mut().for_each(|d| d.help.push(format!("region `{key}` follows this variable")));
            e
        })?;
    }
    Ok(())
}

/// Puts all regions in their places that can be placed now; the others stay where they were, and a line or formula that names one
/// of them is refused with a message.
pub fn place_all(w: &mut World, graph: &Graph, vars: &Vars) {
    // All of them out of the world meanwhile: evaluating their variables may come here again.
    let following: Vec<Key<Region>> =
        w.regions.iter().filter(|(_, r)| r.follows()).map(|(key, _)| key).collect();
    let taken: Vec<_> = following.into_iter().filter_map(|key| Some((key, w.regions.remove(key)?))).collect();
    for (key, region) in taken {
        let placed = placed(w, graph, vars, &region).unwrap_or(region);
        w.regions.insert(key, placed);
    }
}

fn placed(w: &mut World, graph: &Graph, vars: &Vars, region: &Region) -> Result<Region> {
    let mut region = region.clone();
    region.place(&mut |v| number(w, graph, vars, v))?;
    Ok(region)
}

fn number(w: &mut World, graph: &Graph, vars: &Vars, v: &Variable) -> Result<Option<f64>> {
    let mut env = DeckEnv { w, graph };
    match vars.value(&v.name, v.span, &mut env)? {
        Value::Number(a) => Ok(Some(a)),
        Value::Unknown => Ok(None),
        _ => {
            let text = format!("variable `{}` has no single number for a region", v.name);
            Err(Diagnostic::error(Code::WRONG_KIND, v.span, text).into())
        }
    }
}

/// Adds the ops that put regions in their places in each step.
///
/// # Errors
/// Variables that are gone.
pub fn seal(s: &mut Sealer) -> Result<()> {
    let following = s.world().regions.iter().filter(|(_, r)| r.follows());
    let regions: Vec<(Key<Region>, Vec<Variable>)> =
        following.map(|(key, r)| (key, r.variables().into_iter().cloned().collect())).collect();
    for (region, variables) in regions {
        for stage in STAGES {
            let mut readings = vec![];
            for v in &variables {
                let r =
                    ValueRef { kind: RefKind::Variable, name: v.name.clone(), index: vec![], span: v.span };
                readings.push(s.value(&r, stage, &When::Always)?);
            }
            let op = PlaceRegion { title: format!("region {region}"), region, readings, stage };
            let span = s.span();
            s.add(vec![Box::new(op)], span);
        }
    }
    Ok(())
}

/// Puts one region where its variables place it.
struct PlaceRegion {
    title: String,
    region: Key<Region>,
    /// Values of its variables, in the order in which it reads them.
    readings: Vec<Reading>,
    stage: Stage,
}

impl Op for PlaceRegion {
    fn about(&self) -> About {
        About {
            in_setup: true,
            level: Level::Every,
            ..About::new(&self.title, self.stage, Needs::new().read(SLOTS).write(REGIONS))
        }
    }
    fn run(&mut self, w: &mut World, _t: &Tick) -> Result<()> {
        let values: Vec<f64> = self.readings.iter().map(|r| r.get(w)).collect();
        let mut next = values.into_iter();
        match w.regions.get_mut(self.region) {
            Some(region) => region.place(&mut |_| Ok(next.next())),
            None => Ok(()),
        }
    }
}
