//! Dumps `atom/gz`, `custom/gz`, `cfg/gz`, `xyz/gz` and `local/gz`: compressed files with a selectable level.

use super::base::{Files, OfFile};
use super::columns::Columns;
use super::local::Line;
use super::{Dump, DumpStyle, forms, local, text};
use perigrain_base::diag::Result;
use perigrain_lang::Args;
use perigrain_styles::words::{Grammar, Syntax, Words};
use perigrain_styles::{BuildCx, Doc, Style};

/// A style whose files are always compressed.
pub struct Packed {
    name: &'static str,
    grammar: &'static Grammar,
    example: &'static str,
    /// Reads its line.
    build: fn(Files, &mut Args, &BuildCx) -> Result<Box<dyn Dump>>,
}

/// `dump … atom/gz`.
pub const ATOM: Packed = Packed {
    name: "atom/gz",
    grammar: OfFile::GRAMMAR,
    example: "dump 1 all atom/gz 100 flow.dump.gz",
    build: text::atom,
};

/// `dump … custom/gz`.
pub const CUSTOM: Packed = Packed {
    name: "custom/gz",
    grammar: Columns::GRAMMAR,
    example: "dump 1 all custom/gz 100 plate.*.dump.gz id type x y z\ndump_modify 1 compression_level 9",
    build: text::custom,
};

/// `dump … cfg/gz`.
pub const CFG: Packed = Packed {
    name: "cfg/gz",
    grammar: Columns::GRAMMAR,
    example: "dump 1 all cfg/gz 100 flow.*.cfg.gz mass type xs ys zs",
    build: forms::cfg,
};

/// `dump … xyz/gz`.
pub const XYZ: Packed = Packed {
    name: "xyz/gz",
    grammar: OfFile::GRAMMAR,
    example: "dump 1 all xyz/gz 100 grains.xyz.gz",
    build: forms::xyz,
};

/// `dump … local/gz`.
pub const LOCAL: Packed = Packed {
    name: "local/gz",
    grammar: Line::GRAMMAR,
    example: "compute b all property/local batom1 batom2\ndump 1 all local/gz 100 bonds.*.gz index c_b[1] c_b[2]",
    build: local::local,
};

impl Style for Packed {
    fn name(&self) -> &'static str {
        self.name
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(self.grammar),
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
        (self.build)(Files { style: self.name, endings: &[".gz"], level: Some(-1) }, args, cx)
    }
}
