//! The scenes that are cut in two and continued: bodies, grains, bonded grains, with all kinds of history.

/// A scene: the lines that make it, the lines repeated after read_restart, and the steps of the whole run.
pub struct Scene {
    pub name: &'static str,
    pub make: &'static str,
    pub again: &'static str,
    pub steps: i64,
    pub list: bool,
}

/// A block that bursts: fast ends, weak bonds.
pub const BLOCK: &str = "units si\natom_style peri\nboundary s s s\nlattice sc 0.001\nregion blk block 0 7 0 5 0 5\n\
    create_box 1 blk\ncreate_atoms 1 region blk\nset group all density 2400\nset group all volume 1e-9\n\
    variable u atom 6000.0*(x-0.0035)\nvelocity all set v_u 0 0 units box\n";
pub const BLOCK_AGAIN: &str = "pair_style peri/pmb\npair_coeff * * 1.6e21 0.0030001 0.0015 0.25\nneighbor 0.0006 bin\n\
    fix 1 all nve\ntimestep 5.0e-8\ncompute dmg all damage/atom\ncompute dsum all reduce sum c_dmg\n\
    thermo_style custom step time pe ke press c_dsum\nthermo_modify format float %24.17g\nthermo 5\n";

/// The same of bonds that are not alike.
pub const SCATTERED: &str = "units si\natom_style peri\nboundary s s s\nlattice sc 0.001\nregion blk block 0 7 0 5 0 5\n\
    create_box 1 blk\ncreate_atoms 1 region blk\nset group all density 2400\nset group all volume 1e-9\n\
    set group all peri/strength weibull 5 4711 correlated 0.002\nset atom 10*90 peri/stiffness normal 0.1 9\n\
    variable u atom 6000.0*(x-0.0035)\nvelocity all set v_u 0 0 units box\n";

/// Grains that fall on each other, spin and slide.
pub const PILE: &str = "units lj\natom_style sphere\nboundary p p s\nlattice sc 1.0\nregion world block 0 4 0 4 0 9 units box\n\
    create_box 1 world\nregion fill block 0.3 3.9 0.3 3.9 0.6 3.5 units box\nlattice sc 1.2\ncreate_atoms 1 region fill\n\
    variable d atom 0.93+0.06*sin(5.0*x+2.0*y+9.0*z)\nset group all diameter v_d\nset group all density 1.2\n\
    variable u0 atom 0.9*sin(2.0*y+z)\nvelocity all set v_u0 0.2 -0.5\n";
/// The same of two types, of which one lies below.
pub const PAIR_OF_PILES: &str = "units lj\natom_style sphere\nboundary p p s\nlattice sc 1.0\nregion world block 0 4 0 4 0 9 units box\n\
    create_box 2 world\nregion fill block 0.3 3.9 0.3 3.9 0.6 3.5 units box\nlattice sc 1.2\ncreate_atoms 1 region fill\n\
    set group all diameter 0.96\nset group all density 1.2\nset atom 1*4 type 2\n\
    variable u0 atom 0.9*sin(2.0*y+z)\nvelocity all set v_u0 0.2 -0.5\n";
pub const PILE_AGAIN: &str = "pair_style granular\n\
    pair_coeff * * hertz 5000.0 20.0 tangential mindlin 4000.0 0.7 0.5\nneighbor 0.1 bin\n\
    neigh_modify every 1 delay 0 check yes\nregion low block INF INF INF INF INF 1.0 units box\n\
    group foot id 1 2 3 4\ngroup rest subtract all foot\n\
    fix 1 rest nve/sphere\nfix 2 all gravity 1.0 vector 0.2 0 -1\n\
    fix 3 foot move wiggle 0.05 0 0 0.7 units box\nfix 4 all viscous 0.1\ntimestep 0.001\n\
    compute er all erotate/sphere\nthermo_style custom step time ke c_er press\n\
    thermo_modify format float %24.17g norm no\nthermo 5\n";

/// The same pile under laws with other history: contact radius, rolling and twisting; an older style.
pub const STIFF_AGAIN: &str = "pair_style granular\n\
    pair_coeff * * hertz 5000.0 20.0 tangential mindlin_rescale 4000.0 0.7 0.5 rolling sds 2000.0 5.0 0.2 twisting marshall\n\
    neighbor 0.1 bin\nneigh_modify every 1 delay 0 check yes\nfix 1 all nve/sphere\n\
    fix 2 all gravity 1.0 vector 0.2 0 -1\ntimestep 0.001\ncompute er all erotate/sphere\n\
    thermo_style custom step time ke c_er press\nthermo_modify format float %24.17g norm no\nthermo 5\n";
pub const OLDER_AGAIN: &str = "pair_style gran/hertz/history 5000.0 NULL 20.0 NULL 0.5 1\npair_coeff * *\n\
    neighbor 0.1 bin\nneigh_modify every 1 delay 0 check yes\nfix 1 all nve/sphere\n\
    fix 2 all gravity 1.0 vector 0.2 0 -1\ntimestep 0.001\ncompute er all erotate/sphere\n\
    thermo_style custom step time ke c_er press\nthermo_modify format float %24.17g norm no\nthermo 5\n";

/// The same pile of grains that flow and stick, between walls: contacts keep their largest overlap and adhesion.
pub const STICKY_AGAIN: &str = "pair_style granular\n\
    pair_coeff * * eepa 9000.0 0.5 0.3 0.6 0.01 0.5 1.5 1.5 damping coeff_restitution tangential mindlin NULL 0.7 0.5 rolling sds 2000.0 5.0 0.2\n\
    region floor plane 0 0 0.6 0 0 1 units box\n\
    fix low all wall/gran/region granular eepa 9000.0 0.5 0.3 0.6 0.01 0.5 1.0 1.5 damping velocity tangential linear_history 2000.0 0.5 0.4 region floor\n\
    neighbor 0.1 bin\nneigh_modify every 1 delay 0 check yes\nfix 1 all nve/sphere\n\
    fix 2 all gravity 1.0 vector 0.2 0 -1\ntimestep 0.001\ncompute er all erotate/sphere\n\
    thermo_style custom step time ke c_er press\nthermo_modify format float %24.17g norm no\nthermo 5\n";

/// The same pile, wet: springs that slide alone, torques against rolling, bridges that ruptured or did not; the floor yields.
pub const WET_AGAIN: &str = "pair_style granular\n\
    pair_coeff * * hertz/material 9000.0 0.5 0.3 damping coeff_restitution tangential mindlin NULL NULL 0.5 slip spring rolling epsd 0.1 0.3 cohesion capillary 0.001 0.5 20.0\n\
    region floor plane 0 0 0.6 0 0 1 units box\n\
    fix low all wall/gran/region granular hooke/hysteresis 9000.0 0.5 0.3 1.0 2.0 0.2 0.05 damping coeff_restitution tangential linear_history NULL NULL 0.4 slip spring rolling cdt 0.1 cohesion sjkr 5.0 region floor\n\
    neighbor 0.1 bin\nneigh_modify every 1 delay 0 check yes\nfix 1 all nve/sphere\n\
    fix 2 all gravity 1.0 vector 0.2 0 -1\ntimestep 0.001\ncompute er all erotate/sphere\n\
    thermo_style custom step time ke c_er press\nthermo_modify format float %24.17g norm no\nthermo 5\n";

/// The same pile with steps of two lengths, a floor that follows a variable, pairs left out and forces kept.
pub const LEVELS_AGAIN: &str = "pair_style gran/hooke/history 5000.0 NULL 20.0 NULL 0.5 1\npair_coeff * *\n\
    neighbor 0.1 bin\nneigh_modify every 1 delay 0 check yes\nneigh_modify exclude type 1 2\n\
    group foot id 1 2 3 4\nneigh_modify exclude group foot foot\nvariable lift equal 0.3+0.1*sin(0.02*step)\n\
    region floor plane 0 0 0 0 0 1 move NULL NULL v_lift units box\nfix 1 all nve/sphere\n\
    fix 2 all gravity 1.0 vector 0.2 0 -1\nfix 3 all store/force\n\
    fix 4 all wall/gran/region hooke/history 5000.0 NULL 20.0 NULL 0.5 1 region floor\n\
    run_style respa 2 3 pair 1\nfix_modify 2 respa 2\ntimestep 0.002\n\
    compute er all erotate/sphere\ncompute kept all reduce sum f_3[*]\nthermo_style custom step time ke c_er press c_kept[3]\n\
    thermo_modify format float %24.17g norm no\nthermo 5\n";

/// The same pile in a bath whose stream continues, between walls.
pub const BATH_AGAIN: &str = "pair_style granular\npair_coeff * * hertz 5000.0 20.0 tangential mindlin 4000.0 0.7 0.5\n\
    neighbor 0.1 bin\nneigh_modify every 1 delay 0 check yes\nfix 1 all nve/sphere\n\
    variable t atom 2.0+0.1*x\nfix 2 all langevin v_t 0 0.5 48279 omega yes tally yes\n\
    fix 3 all wall/reflect zlo 0.6 units box\nfix 4 all wall/harmonic zlo -0.2 50.0 0 1.5 units box\n\
    fix_modify 4 energy yes virial yes\nfix own all property/atom d_own\ntimestep 0.002\n\
    compute er all erotate/sphere\nthermo_style custom step time ke pe c_er press ecouple f_2 f_4[1]\n\
    thermo_modify format float %24.17g norm no\nthermo 5\n";

/// Plastic grains pressed between two planes: they grow, and keep the history of each contact on both sides.
pub const POWDER: &str = "units si\natom_style sphere\nboundary f f f\nregion world block -0.02 0.02 -0.02 0.02 -0.02 0.02 units box\n\
    create_box 1 world\ncreate_atoms 1 single 0 0 -0.0079 units box\ncreate_atoms 1 single 0.001 0 0.0019 units box\n\
    create_atoms 1 single 0 0.001 0.0118 units box\nset group all diameter 0.01\nset group all density 2000\n\
    velocity all set 0 0 -3 units box\ngroup top id 3\nvelocity top set 0 0 -9 units box\n";
pub const POWDER_AGAIN: &str = "pair_style granular\n\
    pair_coeff * * mdr 5.0e7 0.3 2.0e6 0.1 0.5 0.2 damping mdr 1 tangential linear_history 5.0e4 0.5 0.4\n\
    fix low all wall/gran granular mdr 5.0e7 0.3 2.0e6 0.1 0.5 0.2 damping mdr 1 tangential linear_history 5.0e4 0.5 0.2 zplane -0.0128 NULL\n\
    fix 1 all nve/sphere\nneighbor 0.004 bin\nneigh_modify every 1 delay 0\ntimestep 1.0e-6\n\
    thermo_style custom step time ke press\n\
    thermo_modify format float %24.17g\nthermo 5\n";

/// Grains that come and go while others lie on a floor.
pub const RAIN: &str = "units lj\natom_style sphere\nboundary p p f\nregion world block 0 5 0 5 0 16 units box\n\
    create_box 2 world\n";
pub const RAIN_AGAIN: &str = "region slot block 0 5 0 5 1.5 6 units box\nregion high block 1 4 1 4 9 12 units box\n\
    pair_style gran/hooke/history 4000.0 NULL 50.0 NULL 0.5 0\npair_coeff * *\n\
    neighbor 0.3 bin\nneigh_modify every 1 delay 0 check yes\nfix 1 all nve/sphere\nfix 2 all gravity 1.0 vector 0 0 -1\n\
    fix 3 all wall/gran hooke/history 4000.0 NULL 50.0 NULL 0.5 0 zplane 0.0 NULL\n\
    fix 4 all pour 60 1 4711 region slot vol 0.1 20 diam range 0.7 1.1 vel -0.5 0.5 -0.5 0.5 -3.0\n\
    fix 5 all deposit 12 2 30 777 region high near 1.2 gaussian 2 2 10 1.5 vz -2 -2 attempt 30 units box\n\
    fix 6 all evaporate 50 1 slot 99\ntimestep 0.005\ncompute er all erotate/sphere\ncompute away all msd\n\
    thermo_style custom step time atoms ke c_er c_away[4] f_4 f_5 f_6\n\
    thermo_modify format float %24.17g norm no\nthermo 5\n";

/// Grains that stream out of a face, some of them on their way to it, and others that fill a region up.
pub const STREAM_AGAIN: &str = "region slot block 0 5 0 5 0.5 3 units box\n\
    pair_style gran/hooke/history 4000.0 NULL 50.0 NULL 0.5 0\npair_coeff * *\n\
    neighbor 0.3 bin\nneigh_modify every 1 delay 0 check yes\nfix 1 all nve/sphere\ngroup none empty\n\
    fix 3 all wall/gran hooke/history 4000.0 NULL 50.0 NULL 0.5 0 zplane 0.0 NULL\n\
    fix lid none wall/gran hooke 4000.0 NULL 50.0 NULL 0.5 0 zplane 9.0 NULL\n\
    mixture m mass 4711 sphere 1 0.7 1 0.4 sphere 2 1.0 1 0.6\n\
    fix 4 all insert m stream face lid number 60 rate 20 length 3 vel 0.5 0 -4 gaussian 0.3 0.3 0.3 omega 0 1 0\n\
    fix 5 all insert m pack region slot number 9 every 60 vel 0 0 -1 uniform 1 1 0 seed 99\n\
    fix 2 all gravity 1.0 vector 0 0 -1\n\
    timestep 0.005\ncompute er all erotate/sphere\n\
    thermo_style custom step time atoms ke c_er f_4 f_4[1] f_4[2] f_5[1] f_5[2]\n\
    thermo_modify format float %24.17g norm no\nthermo 5\n";

/// A grain that hits a peridynamic plate.
pub const IMPACT: &str = "units si\natom_style hybrid sphere peri\nboundary s s s\nlattice sc 0.001\n\
    region world block -0.006 0.006 -0.006 0.006 -0.003 0.009 units box\ncreate_box 2 world\n\
    region plate block -0.0035 0.0035 -0.0035 0.0035 -0.001 0.001 units box\ncreate_atoms 1 region plate\n\
    create_atoms 2 single 0.0002 0.0001 0.00249 units box\ngroup ball type 2\ngroup plate type 1\n\
    set group plate diameter 0.001\nset group ball diameter 0.003\n\
    material glass E 7e10 nu 0.25 rho 2235 Gc 2.0\nset type 1 density 2235\nset type 2 density 7800\n\
    set group all volume 1e-9\nvelocity ball set 20 0 -300 units box\n\
    timestep 2e-8\n";
pub const IMPACT_AGAIN: &str = "pair_style hybrid/overlay peri/pmb granular\n\
    pair_coeff * * granular hertz/material 5.0e9 0.7 0.3 damping tsuji tangential mindlin NULL 1.0 0.4\n\
    pair_coeff 1 1 peri/pmb material glass horizon 3.01\npair_coeff 2 2 granular hertz/material 5.0e9 0.7 0.3 damping tsuji tangential mindlin NULL 1.0 0.4\n\
    neighbor 0.0005 bin\nvariable t equal time\nvariable push equal 1e3*sin(1e5*v_t)\n\
    fix 1 plate nve\nfix 2 ball nve/sphere\nfix 3 ball addforce v_push 0 0\n\
    fix 4 all dt/reset 5 1e-9 3e-8 2e-6 units box\n\
    compute dmg all damage/atom\ncompute dsum all reduce sum c_dmg\n\
    thermo_style custom step time dt ke c_dsum f_3[1] f_4\nthermo_modify format float %24.17g\nthermo 5\n";

/// The same block of state-based materials.
pub const LPS_AGAIN: &str = "pair_style peri/lps\npair_coeff * * 14e9 6e9 0.0030001 0.0015 0.25\nneighbor 0.0006 bin\n\
    fix 1 all nve\ntimestep 5.0e-8\ncompute dil all dilatation/atom\ncompute dsum all reduce sum c_dil\n\
    thermo_style custom step time pe ke press c_dsum\nthermo_modify format float %24.17g\nthermo 5\n";
/// Bonds that break by the work done on them, and by the strain of their ends.
pub const WORK_AGAIN: &str = "pair_style peri/ves\npair_coeff * * 14e9 6e9 0.0030001 0.0015 0.25 0.6 4e-7\nneighbor 0.0006 bin\n\
    peri_modify break energy\nfix 1 all nve\ntimestep 5.0e-8\ncompute dmg all damage/atom\ncompute dsum all reduce sum c_dmg\n\
    thermo_style custom step time pe ke press c_dsum\nthermo_modify format float %24.17g\nthermo 5\n";
pub const STRAIN_AGAIN: &str = "pair_style peri/pmb\npair_coeff * * 1.6e21 0.0030001 0.0015 0.25\nneighbor 0.0006 bin\n\
    peri_modify break strain 0.001 every 3\nfix 1 all nve\ntimestep 5.0e-8\ncompute dmg all damage/atom\n\
    compute dsum all reduce sum c_dmg\nthermo_style custom step time pe ke press c_dsum\n\
    thermo_modify format float %24.17g\nthermo 5\n";
pub const VES_AGAIN: &str = "pair_style peri/ves\npair_coeff * * 14e9 6e9 0.0030001 0.0015 0.25 0.6 4e-7\nneighbor 0.0006 bin\n\
    fix 1 all nve\ntimestep 5.0e-8\ncompute dil all dilatation/atom\ncompute dsum all reduce sum c_dil\n\
    thermo_style custom step time pe ke press c_dsum\nthermo_modify format float %24.17g\nthermo 5\n";
pub const EPS_AGAIN: &str = "pair_style peri/eps\npair_coeff * * 14e9 6e9 0.0030001 0.0035 0.25 1e7\nneighbor 0.0006 bin\n\
    fix 1 all nve\ntimestep 5.0e-8\ncompute flow all plasticity/atom\ncompute dsum all reduce sum c_flow\n\
    thermo_style custom step time pe ke press c_dsum\nthermo_modify format float %24.17g\nthermo 5\n";

/// The block of metal, which flows and breaks.
pub const METAL: &str = "units si\natom_style peri\nboundary s s s\nlattice sc 0.001\nregion blk block 0 7 0 5 0 5\n\
    create_box 1 blk\ncreate_atoms 1 region blk\nset group all density 2400\nset group all volume 1e-9\n\
    material metal E 2.5e10 nu 0.3 rho 2400 yield 4e7 hardening linear H 1e9\n\
    variable u atom 6000.0*(x-0.0035)\nvelocity all set v_u 0 0 units box\n";
pub const METAL_AGAIN: &str = "pair_style peri/cauchy\npair_coeff * * material metal horizon 2.015 s00 0.006\n\
    peri_modify volume full\nneighbor 0.0006 bin\n\
    fix 1 all nve\ntimestep 5.0e-8\ncompute flow all peri/state/atom mises plastic damage\n\
    compute dsum all reduce sum c_flow[1] c_flow[2] c_flow[3]\n\
    thermo_style custom step time pe ke press c_dsum[1] c_dsum[2] c_dsum[3]\nthermo_modify format float %24.17g\nthermo 5\n";

/// The block of bonds that soften beyond a peak: what is left of each, and of exponential ones how far they have been stretched.
pub const SOFT_AGAIN: &str = "pair_style peri/pmb/softening\npair_coeff * * 1.6e21 0.0030001 0.0015 1100\nneighbor 0.0006 bin\n\
    fix 1 all nve\ntimestep 5.0e-8\ncompute dmg all damage/atom\ncompute dsum all reduce sum c_dmg\ncompute e all energy/ledger\n\
    thermo_style custom step time pe ke press c_dsum c_e[7]\nthermo_modify format float %24.17g\nthermo 5\n";
pub const DECAYING_AGAIN: &str = "pair_style peri/pmb/softening exponential\npair_coeff * * 1.6e21 0.0030001 0.0015 700\n\
    neighbor 0.0006 bin\nfix 1 all nve\ntimestep 5.0e-8\ncompute dmg all damage/atom\ncompute dsum all reduce sum c_dmg\n\
    compute e all energy/ledger\nthermo_style custom step time pe ke press c_dsum c_e[7]\n\
    thermo_modify format float %24.17g\nthermo 5\n";

/// The block with everything that averages, keeps a list or keeps former positions.
pub const AVERAGES_AGAIN: &str = "pair_style peri/pmb\npair_coeff * * 1.6e21 0.0030001 0.0015 0.25\nneighbor 0.0006 bin\n\
    fix 1 all nve\ntimestep 5.0e-8\ncompute m all msd com yes\ncompute mav all msd\n\
    compute moved all displace/atom\ncompute far all reduce max c_moved[4]\n\
    compute slabs all chunk/atom bin/1d x lower 0.002 units box\n\
    compute types all chunk/atom type nchunk once\ncompute mc all msd/chunk types\ncompute vc all vacf/chunk types\n\
    compute vv all vacf\ncompute crit all property/atom s0\ncompute least all reduce min c_crit\n\
    fix t all ave/time 2 3 10 c_m[4] c_thermo_temp ave running\n\
    fix w all ave/time 5 2 10 c_m[4] c_far ave window 3\nfix tv all ave/time 2 5 10 c_thermo_press mode vector\n\
    fix c all ave/chunk 2 3 10 slabs vx density/number ave running\n\
    fix cw all ave/chunk 1 7 10 slabs vx temp ave window 2\n\
    fix h all ave/histo 5 2 10 -20 20 8 vx mode vector ave running\nfix a all ave/atom 2 4 10 vx fx\n\
    compute ra all reduce sum f_a[1] f_a[2]\nfix keep all vector 4 c_m[4] c_far nmax 6\nfix s all store/state 15 x vx\n\
    compute rs all reduce sum f_s[1] f_s[2]\nvariable late equal f_keep[1][1]\n\
    thermo_style custom step pe c_m[4] c_mav[4] c_far f_t[1] f_t[2] f_w[1] f_w[2] f_tv[2] f_c[1][3] f_c[2][4] f_cw[2][3] f_h[1] \
    f_h[4] f_h[3][2] c_ra[1] c_ra[2] c_rs[2] c_mc[1][4] c_vc[1][4] c_vv[4] c_least\n\
    thermo_modify format float %24.17g\nthermo 10\n";

/// A block of beams with grains that have turned before they were joined, in the middle of breaking; then of bonds as LAMMPS has them.
pub const BEAMS: &str = "units si\natom_style bpm/sphere\nboundary f f f\nlattice sc 0.001\n\
    region world block -0.01 0.02 -0.01 0.02 -0.01 0.02 units box\nregion b block 0 4.1 0 3.1 0 3.1\n\
    create_box 1 world bond/types 2 extra/bond/per/atom 20\ncreate_atoms 1 region b\n\
    set group all diameter 0.001 density 2000\ndisplace_atoms all random 5e-5 5e-5 5e-5 4711 units box\n\
    group odd id 1:100:3\nset group odd quat 0.6 0 0.8 40\ncreate_bonds many all all 1 0.0005 0.0012\n\
    create_bonds many all all 2 0.0012 0.0016\nspecial_bonds lj 0 1 1 coul 1 1 1\n\
    variable u atom 4.0*sin(2000*x)+900*z\nvariable w atom 3.0*cos(3000*y)-900*x\nvelocity all set v_u 0.3 v_w units box\n\
    set group all omega 300 -200 100\n";
pub const BEAMS_AGAIN: &str = "pair_style granular\n\
    pair_coeff * * hertz/material 1e9 0.9 0.2 tangential mindlin NULL 0.9 0.3 damping coeff_restitution\n\
    bond_style bpm/beam store/local gone 10 id1 id2 x/ref\nbond_coeff 1 1e9 0.2 ratio 0.4 strength 1.5e7 8e6 weibull 4 17 damping 0.02\n\
    bond_coeff 2 5e8 0.2 radius 1.5e-4 strength 1.5e7 8e6\nfix 1 all nve/bpm/sphere\ntimestep 2e-7\n\
    compute e all energy/ledger\ncompute nb all nbond/atom\ncompute tb all reduce sum c_nb\n\
    thermo_style custom step time ke ebond bonds c_tb c_e[5] c_e[7]\nthermo_modify format float %24.17g norm no\nthermo 5\n";
pub const ROTATIONAL_AGAIN: &str = "pair_style gran/hooke/history 1e5 NULL 50.0 NULL 0.5 1\npair_coeff * *\n\
    bond_style hybrid bpm/rotational bpm/spring\n\
    bond_coeff 1 bpm/rotational 1.2e5 5e4 4e-3 5e-3 2.4 1.2 2e-4 2e-4 0.05 0.02 1e-6 1e-9\n\
    bond_coeff 2 bpm/spring 5e4 0.03 0.02\nfix 1 all nve/bpm/sphere\ntimestep 2e-7\n\
    compute nb all nbond/atom\ncompute tb all reduce sum c_nb\n\
    thermo_style custom step time ke ebond bonds c_tb\nthermo_modify format float %24.17g norm no\nthermo 5\n";

/// The block of bonds whose micro-moduli have a shape and are corrected at surfaces.
pub const SHAPED_AGAIN: &str = "pair_style peri/pmb\npair_coeff * * 1.6e21 0.0030001 0.0015 0.25\n\
    peri_modify surface energy influence gaussian\nneighbor 0.0006 bin\nfix 1 all nve\ntimestep 5.0e-8\n\
    compute dmg all damage/atom\ncompute dsum all reduce sum c_dmg\n\
    thermo_style custom step time pe ke press c_dsum\nthermo_modify format float %24.17g\nthermo 5\n";

/// The block of unlike, shaken particles with horizons of their own, whose families are made whole.
pub const UNLIKE: &str = "units si\natom_style peri\nboundary s s s\nlattice sc 0.001\nregion blk block 0 7 0 5 0 5\n\
    create_box 1 blk\ncreate_atoms 1 region blk\nset group all density 2400\nset group all volume 1e-9\n\
    set atom 40*90 volume 2e-9\nset group all peri/strength weibull 9 4711\n\
    displace_atoms all random 0.00005 0.00005 0.00005 4711 units box\nmaterial glass E 2.5e10 nu 0.25 rho 2400 Gc 200\n\
    variable u atom 6000.0*(x-0.0035)\nvelocity all set v_u 0 0 units box\n";
pub const UNLIKE_AGAIN: &str = "pair_style peri/lps\npair_coeff * * material glass horizon 3.015\n\
    peri_modify volume full horizon own surface tensor\nneighbor 0.0006 bin\nfix 1 all nve\ntimestep 5.0e-8\n\
    compute dmg all damage/atom\ncompute dsum all reduce sum c_dmg\n\
    thermo_style custom step time pe ke press c_dsum\nthermo_modify format float %24.17g\nthermo 5\n";

pub const SCENES: [Scene; 31] = [
    Scene { name: "lattice", make: BLOCK, again: BLOCK_AGAIN, steps: 60, list: false },
    Scene { name: "list", make: BLOCK, again: BLOCK_AGAIN, steps: 40, list: true },
    Scene { name: "scattered", make: SCATTERED, again: BLOCK_AGAIN, steps: 60, list: false },
    Scene { name: "scattered, list", make: SCATTERED, again: BLOCK_AGAIN, steps: 40, list: true },
    Scene { name: "lps", make: BLOCK, again: LPS_AGAIN, steps: 60, list: false },
    Scene { name: "ves", make: BLOCK, again: VES_AGAIN, steps: 60, list: false },
    Scene { name: "eps", make: BLOCK, again: EPS_AGAIN, steps: 60, list: false },
    Scene { name: "eps, list", make: BLOCK, again: EPS_AGAIN, steps: 40, list: true },
    Scene { name: "metal", make: METAL, again: METAL_AGAIN, steps: 60, list: false },
    Scene { name: "metal, list", make: METAL, again: METAL_AGAIN, steps: 40, list: true },
    Scene { name: "softening", make: BLOCK, again: SOFT_AGAIN, steps: 60, list: false },
    Scene { name: "softening, list", make: BLOCK, again: DECAYING_AGAIN, steps: 60, list: true },
    Scene { name: "work", make: BLOCK, again: WORK_AGAIN, steps: 60, list: false },
    Scene { name: "work, list", make: BLOCK, again: WORK_AGAIN, steps: 40, list: true },
    Scene { name: "strain", make: BLOCK, again: STRAIN_AGAIN, steps: 60, list: false },
    Scene { name: "shaped", make: BLOCK, again: SHAPED_AGAIN, steps: 60, list: false },
    Scene { name: "own horizons", make: UNLIKE, again: UNLIKE_AGAIN, steps: 60, list: false },
    Scene { name: "averages", make: BLOCK, again: AVERAGES_AGAIN, steps: 60, list: false },
    Scene { name: "pile", make: PILE, again: PILE_AGAIN, steps: 400, list: false },
    Scene { name: "bath pile", make: PILE, again: BATH_AGAIN, steps: 400, list: false },
    Scene { name: "stiff pile", make: PILE, again: STIFF_AGAIN, steps: 200, list: false },
    Scene { name: "sticky pile", make: PILE, again: STICKY_AGAIN, steps: 300, list: false },
    Scene { name: "wet pile", make: PILE, again: WET_AGAIN, steps: 300, list: false },
    Scene { name: "older pile", make: PILE, again: OLDER_AGAIN, steps: 200, list: false },
    Scene { name: "levels pile", make: PAIR_OF_PILES, again: LEVELS_AGAIN, steps: 200, list: false },
    Scene { name: "powder pile", make: POWDER, again: POWDER_AGAIN, steps: 400, list: false },
    Scene { name: "rain", make: RAIN, again: RAIN_AGAIN, steps: 424, list: false },
    Scene { name: "stream", make: RAIN, again: STREAM_AGAIN, steps: 300, list: false },
    Scene { name: "beams", make: BEAMS, again: BEAMS_AGAIN, steps: 400, list: false },
    Scene { name: "beams as LAMMPS has them", make: BEAMS, again: ROTATIONAL_AGAIN, steps: 300, list: false },
    Scene { name: "impact", make: IMPACT, again: IMPACT_AGAIN, steps: 60, list: false },
];
