//! Dumps `atom/gz`, `custom/gz`, `cfg/gz`, `xyz/gz` and `local/gz`: compressed files with a selectable level.

use super::base::Base;
use super::{Dump, DumpStyle, forms, local, text};
use perigrain_base::diag::Result;
use perigrain_lang::Args;
use perigrain_styles::{BuildCx, Doc, Style};

/// A style whose files are always compressed.
pub struct Packed {
    name: &'static str,
    syntax: &'static str,
    example: &'static str,
    /// Reads the words after the file name.
    build: fn(Base, &mut Args, &BuildCx) -> Result<Box<dyn Dump>>,
}

/// `dump … atom/gz`.
pub const ATOM: Packed = Packed {
    name: "atom/gz",
    syntax: "dump ID group atom/gz N file",
    example: "dump 1 all atom/gz 100 flow.dump.gz",
    build: text::atom,
};

/// `dump … custom/gz`.
pub const CUSTOM: Packed = Packed {
    name: "custom/gz",
    syntax: "dump ID group custom/gz N file attribute …",
    example: "dump 1 all custom/gz 100 plate.*.dump.gz id type x y z\ndump_modify 1 compression_level 9",
    build: text::custom,
};

/// `dump … cfg/gz`.
pub const CFG: Packed = Packed {
    name: "cfg/gz",
    syntax: "dump ID group cfg/gz N file mass type xs|xsu ys|ysu zs|zsu attribute …",
    example: "dump 1 all cfg/gz 100 flow.*.cfg.gz mass type xs ys zs",
    build: forms::cfg,
};

/// `dump … xyz/gz`.
pub const XYZ: Packed = Packed {
    name: "xyz/gz",
    syntax: "dump ID group xyz/gz N file",
    example: "dump 1 all xyz/gz 100 grains.xyz.gz",
    build: forms::xyz,
};

/// `dump … local/gz`.
pub const LOCAL: Packed = Packed {
    name: "local/gz",
    syntax: "dump ID group local/gz N file index|c_ID|c_ID[k]|f_ID|f_ID[k] …",
    example: "compute b all property/local batom1 batom2\ndump 1 all local/gz 100 bonds.*.gz index c_b[1] c_b[2]",
    build: local::local,
};

impl Style for Packed {
    fn name(&self) -> &'static str {
        self.name
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: self.syntax,
            summary: "The dump of the same name without `/gz`, compressed.",
            text: "The file name must end in `.gz`. `dump_modify ID compression_level N` says how tightly: from 0 (not at \
                   all) and 1 (fast) to 9, or -1 for the usual one, 6. All else is as without `/gz`, whose files are \
                   compressed, too, if their names end in `.gz`.",
            example: self.example,
        }
    }
}

impl DumpStyle for Packed {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Dump>> {
        let mut base = Base::new(self.name, args, cx, &[".gz"])?;
        base.level = Some(-1);
        (self.build)(base, args, cx)
    }
}
