//! Rigid bodies on ranks: a rank moves the bodies of its particles as a whole, so that no sums over bodies
//! are exchanged.

use super::Declared;
use super::bodies::Split;
use super::motion::Crew;
use super::pass::POSE;
use perigrain_base::par;
use perigrain_plan::{Span, Tick};
use perigrain_styles::ledger;
use perigrain_styles::rigid_bodies::WIDTH;
use perigrain_world::World;
use perigrain_world::share::RigidBodies;

/// The bodies of this rank.
#[derive(Default)]
pub struct Own {
    /// The deal of rows for which they are valid.
    deal: Option<u64>,
    /// Their numbers from 0, ascending.
    pub bodies: Vec<u32>,
    /// Buffers in which they are moved side by side.
    pub room: Room,
}

/// Buffers for bodies that are moved, and for their poses.
#[derive(Default)]
pub struct Room {
    rows: Vec<[f64; WIDTH]>,
    poses: Vec<[f64; POSE]>,
}

impl Room {
    /// Lets `act` move only these bodies, beginning at an index among them.
    pub fn move_some(
        &mut self,
        bodies: &[u32],
        (rows, poses): (&mut [[f64; WIDTH]], &mut [[f64; POSE]]),
        act: impl Fn(usize, &mut [[f64; WIDTH]], &mut [[f64; POSE]]) + Sync,
    ) {
        self.rows.clear();
        self.rows.extend(bodies.iter().map(|k| rows[*k as usize]));
        self.poses.resize(bodies.len(), [0.0; POSE]);
        let some = (&mut self.rows[..], &mut self.poses[..]);
        par::each(some, |start, (rows, poses)| act(start, rows, poses));
        for ((k, row), pose) in bodies.iter().zip(&self.rows).zip(&self.poses) {
            (rows[*k as usize], poses[*k as usize]) = (*row, *pose);
        }
    }
}

impl Declared {
    /// Whether a rank moves only its own bodies at this tick: grains (or the peridynamic bodies beside them)
    /// are distributed over ranks, and no sums over all particles are requested.
    pub fn shares(&self, w: &mut World, t: &Tick) -> bool {
        // Dipole moments are not exchanged.
        if w.share.is_none() || t.virial || w.particles.style.dipole || ledger::is_open(w) {
            return false;
        }
        w.grains_dealt().is_some() || self.is_common(w)
    }

    /// Whether all ranks move all particles of the bodies.
    fn is_common(&self, w: &mut World) -> bool {
        let groups = match &self.split {
            Split::Groups(list) => &list[..],
            _ => std::slice::from_ref(&self.group),
        };
        let bits = groups.iter().fold(0, |bits, group| bits | group.bit());
        groups.iter().all(|group| w.groups.is_fixed(*group)) && w.is_common(bits)
    }

    /// The rows whose values an op of this part of a step needs.
    pub fn span(&self, w: &mut World, t: &Tick) -> Span {
        if self.shares(w, t) { Span::Requested } else { Span::All }
    }

    /// Restricts the current op to the bodies of this rank, if it shares the work.
    pub fn take_part(&self, w: &mut World, crew: &mut Crew) {
        w.act_narrowly();
        let bodies = w.memo.get(self.keys.bodies).map_or(0, |rows| rows.len() / WIDTH);
        let anew = crew.muster(w, bodies);
        let (deal, generation) = (w.narrow_share().map(|share| share.deal), w.rebuild.generation);
        if !anew && crew.own.deal == deal {
            return;
        }
        let (first, members) = (&crew.first[..], &crew.members[..]);
        let dealt = RigidBodies { key: self.keys.bodies, width: WIDTH, first, members };
        crew.own.bodies = w.deal_bodies(&dealt, generation);
        crew.own.deal = deal;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn some_bodies_are_moved_as_among_all() {
        let mut rows: Vec<[f64; WIDTH]> = (0..7).map(|k| [k as f64; WIDTH]).collect();
        let mut poses = vec![[0.0; POSE]; 7];
        let act = |start: usize, rows: &mut [[f64; WIDTH]], poses: &mut [[f64; POSE]]| {
            for (k, (row, pose)) in rows.iter_mut().zip(poses).enumerate() {
                pose[0] = row[0] + (start + k) as f64;
                row[0] += 0.5;
            }
        };
        Room::default().move_some(&[1, 4, 6], (&mut rows, &mut poses), act);
        assert_eq!(rows.iter().map(|row| row[0]).collect::<Vec<_>>(), [0.0, 1.5, 2.0, 3.0, 4.5, 5.0, 6.5]);
        assert_eq!(poses.iter().map(|pose| pose[0]).collect::<Vec<_>>(), [0.0, 1.0, 0.0, 0.0, 5.0, 0.0, 8.0]);
    }
}
