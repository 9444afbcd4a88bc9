//! `neighbor`: the skin of neighbour lists.

use super::{Act, CommandStyle};
use perigrain_base::diag::Result;
use perigrain_lang::Args;
use perigrain_styles::common::setting;
use perigrain_styles::words::{Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, Style};

/// The command.
pub struct Neighbor;

impl Style for Neighbor {
    fn name(&self) -> &'static str {
        "neighbor"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Sets the extra reach of neighbour lists [length].",
            text: "Lists are rebuilt when a particle has moved half the skin (see `neigh_modify`). How they are built is \
                   perigrain's business: all words give the same lists, which search each size of particle by \
                   itself where sizes differ; `multi/old` is refused. Without this line the skin is LAMMPS' for the units (0.3 in \
                   `lj`, 0.001 in `si`, 0.1 in `cgs` …); where that is more than the largest of many grains a note says what to write, since lists \
                   hold many times the pairs that can touch then.",
            example: "neighbor 0.5 bin",
        }
    }
}

#[derive(Words)]
struct Line {
    /// The skin [length].
    #[word(name = "SKIN", non_negative)]
    skin: f64,
    way: Way,
}

/// LAMMPS' ways of building lists.
#[derive(PartialEq, Words)]
#[word(what = "way of building lists", refused = "multi/old")]
enum Way {
    Bin,
    Nsq,
    Multi,
}

impl CommandStyle for Neighbor {
    fn parse(&self, a: &mut Args, cx: &BuildCx) -> Result<Box<dyn Act>> {
        let Line { skin, way } = read(a, cx)?;
        Ok(setting(move |cx| {
            let near = &mut cx.world.settings.neighbor;
            (near.skin, near.skin_set, near.multi) = (skin, true, way == Way::Multi);
            Ok(())
        }))
    }
}
