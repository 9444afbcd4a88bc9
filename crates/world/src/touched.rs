//! Which fields of a scene were read and written since the last query; only debug builds record this.

use super::Numbers;
use super::World;
#[cfg(debug_assertions)]
use super::field;
use super::field::Fields;

/// What was read and what was written.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Touched {
    /// Read.
    pub read: Fields,
    /// Written, or borrowed to be written.
    pub written: Fields,
    /// The columns and entries of the memo among these.
    pub names: Vec<Numbers>,
}

impl World {
    /// The fields touched since the last call.
    #[cfg(debug_assertions)]
    pub fn touched(&self) -> Touched {
        let p = &self.particles;
        let fields = [
            (field::X, p.x.take_marks()),
            (field::V, p.v.take_marks()),
            (field::F, p.f.take_marks()),
            (field::OMEGA, p.omega.take_marks()),
            (field::TORQUE, p.torque.take_marks()),
            (field::QUAT, p.quat.take_marks()),
            (field::MU, p.mu.take_marks()),
            (field::CHARGE, p.charge.take_marks()),
            (field::RADIUS, p.radius.take_marks()),
            (field::MASS, p.mass.take_marks()),
            (field::KIND, p.kind.take_marks()),
            (field::MASK, p.mask.take_marks()),
            (field::IMAGE, p.image.take_marks()),
            (field::VOLUME, p.volume.take_marks()),
            (field::X0, p.x0.take_marks()),
            (field::TAG, p.tag.take_marks()),
            (field::MOLECULE, p.molecule.take_marks()),
            (field::DENSITY, p.density.take_marks()),
            (field::RANK, p.rank.take_marks()),
            (field::TYPE_MASS, self.type_mass.take_marks()),
            (field::COLUMNS, self.columns.take_marks()),
            (field::MEMO, self.memo.take_marks()),
            (field::CONTROLS, self.controls.take_marks()),
            (field::SLOTS, self.slots.take_marks()),
            (field::BOX, self.domain.take_marks()),
            (field::REGIONS, self.regions.take_marks()),
            (field::BONDS, self.bonds.take_marks()),
            (field::FAMILIES, self.families.take_marks()),
            // Part of the families, which have the mark.
            (field::SITES, (false, false)),
            (field::RIGID, (false, false)),
            (field::CONTACTS, self.contacts.take_marks()),
            (field::WALL_CONTACTS, self.wall_contacts.take_marks()),
            (field::TALLY, self.tally.take_marks()),
            (field::LISTS, self.rebuild.take_marks()),
            (field::TRAVEL, self.travel.take_marks()),
            (field::CLOCK, self.clock.take_marks()),
            (field::FACTS, self.facts.take_marks()),
            (field::FACTS, self.changed.take_marks()),
            (field::FACTS, self.notes.take_marks()),
            (field::FACTS, self.outlines.take_marks()),
            (field::FACTS, self.promised.take_marks()),
            (field::FACTS, self.unseen.take_marks()),
            (field::FACTS, self.restored.take_marks()),
        ];
        debug_assert_eq!(fields.iter().fold(Fields::NONE, |all, (field, _)| all | *field), Fields::ALL);
        let mut all = Touched::default();
        for (field, (read, written)) in fields {
            all.read |= if read { field } else { Fields::NONE };
            all.written |= if written { field } else { Fields::NONE };
        }
        // Entries looked at without a trace of their field have marks as well.
        let fields = all.read | all.written;
        let columns = self.columns.past().take_touched().filter(|_| fields.has(field::COLUMNS));
        all.names = columns.collect();
        all.names.extend(self.memo.past().take_touched().filter(|_| fields.has(field::MEMO)));
        all
    }
}
