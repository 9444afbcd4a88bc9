//! The page about formulas: operators, functions, and what they can see of a scene.

use super::Entry;
use perigrain_styles::Doc;
use perigrain_styles::words::Syntax;

pub(super) const FORMULAS: Entry = (
    "formulas",
    Doc {
        syntax: Syntax::Written(
            "# formulas stand in\nvariable NAME equal formula\nvariable NAME atom formula\ncommand $(formula) $(formula:%.3f)",
        ),
        summary: "What a formula may contain: operators, functions, thermo keywords, particles, groups, computes.",
        text: TEXT,
        example: "variable speed equal sqrt(vcm(ball,x)^2+vcm(ball,z)^2)\n\
            variable phase equal swiggle(0.0,0.001,1.0e-6)\n\
            variable out atom \"sqrt(x^2+y^2) > 0.0021 && type == 1\"\n\
            group rim variable out\n\
            print \"$(v_speed:%.2f) m/s, $(count(rim)) particles in the rim, x of particle 7: $(x[7])\"",
    },
);

const TEXT: &str = "**Operators**, from loose to tight: `||` and `|^` (exclusive or); `&&`; `==` `!=`; `<` `<=` `>` `>=`; \
    `+` `-`; `*` `/` `%` (remainder); `^`; and tightest the signs `-x` and `!x`. All bind from left to right, and as in \
    LAMMPS `-2^2` is 4. Comparisons and logic yield 1 or 0.\n\n\
    **Numbers** are written as in decks; `PI`, `version` (20250722: the LAMMPS whose decks are read), `yes on true` (1) and \
    `no off false` (0) are known by name.\n\n\
    **Functions.** A root of a negative number, a logarithm of one that is not positive, a division by zero and the like are \
    errors at their place.\n\n\
    - `sqrt(a)` `exp(a)` `ln(a)` `log(a)` (base 10) `abs(a)` `sin(a)` `cos(a)` `tan(a)` `asin(a)` `acos(a)` `atan(a)` \
    `atan2(a,b)`; angles in radians;\n\
    - `ceil(a)` `floor(a)` `round(a)` (halves go up) `sign(a)` (1 or -1; 1 for 0) `ternary(a,b,c)` (b if a is not 0, else \
    c);\n\
    - `random(low,high,seed)` and `normal(mean,sigma,seed)`: the first use seeds one stream for all further uses, as \
    LAMMPS has it;\n\
    - functions of the step: `ramp(a,b)` goes from a to b over a run (`run … start … stop` counts); `vdisplace(a,b)` is \
    a + b t, `swiggle(a,b,period)` is a + b sin(2πt/period), `cwiggle(a,b,period)` is a + b (1 − cos(2πt/period)), t the \
    time since the run began (between runs the last one; step 0 under `-compat lammps`, as in LAMMPS);\n\
    - sequences of steps, each the next one after the present: `stride(x,y,z)` `stride2(x,y,z,a,b,c)` `stagger(x,y)` \
    `logfreq(x,y,z)` `logfreq2(x,y,z)` `logfreq3(x,y,z)`.\n\n\
    **Groups**: `count(g)` `mass(g)` `ke(g)` `gyration(g)`; with a direction `xcm(g,x)` `vcm(g,x)` `fcm(g,x)` \
    `angmom(g,x)` `torque(g,x)` `omega(g,x)`; `inertia(g,xx)` (xx yy zz xy yz xz), in which spheres count with 2/5 m R² and their spins \
    (points under `-compat lammps/2025`); `bound(g,xmin)` (xmin xmax ymin ymax \
    zmin zmax). A region as last argument counts only the group's particles in it, as in `count(plate,notch)`; its open faces \
    are closed here ([region](region.md)).\n\n\
    **Particles**: `id type mass radius x y z vx vy vz fx fy fz omegax omegay omegaz` are values per particle in an \
    `atom` formula; `x[7]` or `x[v_n]` is that of the particle with this id, a number.\n\n\
    **The scene**: every keyword of [thermo_style](thermo_style.md); `c_ID`, `c_ID[i]`, `c_ID[i][j]` of a compute, `f_ID` \
    likewise of a fix, `C_ID[i]` (`C_ID[i][j]`) the value of particle i of a compute with values per particle (`F_ID` of a \
    fix), `v_NAME` another variable, `v_NAME[i]` the value of particle i of an `atom` variable. A formula evaluated while the \
    deck is read computes what it needs of the present state. Energies, stresses and pressures are those of the last step of the \
    run before, and of computes declared before that run; where the scene has changed since, `run 0` computes them.\n\n\
    **Vectors**: `sum(v)` `min(v)` `max(v)` `ave(v)` `trap(v)` (the sum with half the first and last element) `slope(v)` \
    (of the straight line through the elements, numbered from 1) yield a number, `sort(v)` and `rsort(v)` (falling) a vector; \
    v is `c_ID`, `f_ID`, a column `c_ID[i]` or `f_ID[i]` of a global array, or `v_NAME` of a vector-style variable. Operators \
    and functions of numbers act on each element; two vectors must have the same length. `[1,3,7]` is a vector.\n\n\
    **Masks**, one value per particle: `gmask(group)` `rmask(region)` `grmask(group,region)` are 1 inside, else 0.\n\n\
    **Files and the session**: `next(NAME)` is the present value of a file- or atomfile-style variable, which then moves \
    to its next value. `extract_setting(name)` knows LAMMPS' settings such as `dimension box_exist ntypes nlocal \
    nthreads`. These yield 1 or 0:\n\n\
    - `is_file(path)`;\n\
    - `is_os(pattern)`, a regular expression, as `is_os(^Linux)`;\n\
    - `is_timeout()`, whether `timer timeout` has passed;\n\
    - `is_defined(category,name)`: compute dump fix group region variable;\n\
    - `is_available(category,name)`: atom integrate minimize pair bond angle dihedral improper kspace fix compute region \
    dump command, pair_style for pair as LAMMPS' manual has it, feature: gzip png exceptions; 0 for a name that is not \
    there, where LAMMPS 22Jul2025 ends;\n\
    - `is_active(category,name)`: package newton pair comm_style min_style run_style atom_style pair_style bond_style …; \
    packages never are.\n\n\
    `label2type` and `is_typelabel` are refused: there are no label maps. `charge(g)` is refused: no atom style here has \
    charges.";
