//! fix rigid/nve, rigid/nve/small: rigid bodies with orientations integrated by NO_SQUISH.

use super::words::{Large, Small};
use super::{large, small};
use crate::{Fix, FixStyle};
use perigrain_base::diag::Result;
use perigrain_lang::Args;
use perigrain_styles::words::{Syntax, Words};
use perigrain_styles::{BuildCx, Doc, Style};

/// `fix rigid/nve`.
pub struct RigidNve;

/// `fix rigid/nve/small`.
pub struct RigidNveSmall;

impl Style for RigidNve {
    fn name(&self) -> &'static str {
        "rigid/nve"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Large::GRAMMAR),
            summary: "Rigid bodies as fix rigid, turned by the NO_SQUISH rotations, which keep energy better.",
            text: "As `fix rigid` in everything, but for how orientations move: a step is split into exact rotations about the principal axes \
                   (Miller et al., J. Chem. Phys. 116, 2002, 8649). It is symplectic, so that energy does not drift in long runs; \
                   Richardson's steps of `fix rigid` let it drift with the step size. Where two moments of a body are equal, any axes across the third are principal: \
                   LAMMPS takes others, and its numbers differ by the error of a step. The ensembles nvt, npt and nph are refused.",
            example: "unfix motion\nset group plate diameter 0.0\nfix body plate rigid/nve single torque * off off on",
        }
    }
}

impl Style for RigidNveSmall {
    fn name(&self) -> &'static str {
        "rigid/nve/small"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Small::GRAMMAR),
            summary: "Molecules as rigid bodies as fix rigid/small, turned by the NO_SQUISH rotations, which keep energy better.",
            text: "As `fix rigid/small`, with the rotations of `fix rigid/nve`. The scalar is the temperature here too, where LAMMPS \
                   (and `compat lammps`) gives an energy.",
            example: "units si\natom_style sphere\nregion b block 0 0.1 0 0.1 0 0.1\ncreate_box 1 b\nfix m all property/atom mol\n\
                      create_atoms 1 single 0.05 0.05 0.05\ncreate_atoms 1 single 0.055 0.05 0.05\nset group all diameter 0.01 density 2500.0 \
                      mol 1\npair_style zero 0.01\npair_coeff * *\nneigh_modify exclude molecule/intra all\nvelocity all ramp vy 0 1 x 0.05 0.055\n\
                      fix 1 all rigid/nve/small molecule\nthermo_style custom step f_1\nrun 10",
        }
    }
}

impl FixStyle for RigidNve {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        large(self.name(), args, cx)
    }
}

impl FixStyle for RigidNveSmall {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        small(self.name(), args, cx)
    }
}
