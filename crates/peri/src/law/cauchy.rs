//! `cauchy`: forces from the deformation gradients of both ends and the stress of their materials (correspondence). The loops over bonds
//! are in [`crate::cauchy`]; energies belong to sites, see [`crate::cauchy::energy`].

use crate::cauchy::{lattice, list};
use crate::lattice::chunk::{CELLS, Chunk, SUMS};
use crate::lattice::energies;
use crate::lattice::kernels::Cells;
use crate::law::kernels::{About, Alone, Loops};
use crate::law::lps::Elastic;
use crate::law::moment::{Held, Moment};
use crate::law::settle::{Settling, Sites};
use crate::law::site::Unrelaxed;
use crate::law::state::SiteState;
use crate::law::style::{Kernels, Losses, Style};
use crate::list::laws::{self, Hand};
use perigrain_base::math::form::Form;

/// The law of decks.
pub static CAUCHY: Style = Style {
    correspondence: true,
    losses: Losses::Sites,
    own: Kernels::with(&Correspondence),
    lammps: Kernels::with(&Correspondence),
    ..Style::of::<Elastic>("cauchy", 10)
};

/// Numbers of each site that forces need: M (3×3) and γ.
pub(crate) const NUMBERS: usize = 10;

/// The loops of the law. A bond by itself has neither energy nor pull.
struct Correspondence;

impl Loops for Correspondence {
    fn about(&self) -> About {
        About {
            columns: NUMBERS,
            memory: 0,
            plain: false,
            apart: true,
            back: false,
            limited: false,
            lazy: false,
            norm: None,
        }
    }

    fn chunk(
        &self,
        form: Form,
        at: (&Chunk, &Cells),
        _degree: usize,
        masked: bool,
        track: bool,
    ) -> (f64, f64) {
        lattice::pull(form, at, masked, track)
    }

    fn chunk_sums(&self, _: Form, _: (&Chunk, &Cells), _: &energies::Looking) -> [[f64; CELLS]; SUMS] {
        [[0.0; CELLS]; SUMS]
    }

    fn in_hand(&self, form: Form, hand: Hand) -> bool {
        list::pull(form, hand);
        false
    }

    fn in_hand_sums(&self, _: Form, _: Hand, _: &laws::Looking) -> [f64; SUMS] {
        [0.0; SUMS]
    }

    fn alone(&self, _: &Alone, _: &Moment) -> [[f64; 2]; 2] {
        [[0.0; 2]; 2]
    }

    fn slips(&self, _: f64, _: [f64; 2], _: Held, _: [Unrelaxed; 2]) -> [f64; 2] {
        [0.0; 2]
    }

    fn dilatations(&self, _: &Settling, _: &mut SiteState, _: &Sites) {}

    fn flow(&self, _: &Settling, _: &mut SiteState, _: &Sites) {}
}
