//! Units of lengths: those of the box where a line has no `units`, also where the deck has a lattice, whose spacings count in LAMMPS.
//!
//! Source: LIGGGHTS manual, defaults of region, create_atoms, velocity, change_box, fix move, fix deform, fix wall/reflect; all but
//! change_box, deform and reflect measured with LIGGGHTS 3.8.0, and `displace_atoms`, whose page names the lattice as its default.

use crate::native::Line;
use perigrain_lang::Command;

/// Fixes with the word `units`.
const FIXES: &[&str] = &["move", "deform", "wall/reflect"];

/// The line with `units box`, where it has no `units` and LAMMPS would count spacings.
pub(crate) fn in_box(cmd: &Command) -> Option<Command> {
    let at = |k: usize| cmd.args.get(k).map_or("", |w| w.text.as_str());
    let takes = match cmd.name.text.as_str() {
        // `delete` takes no more words.
        "region" => at(1) != "delete",
        "create_atoms" | "change_box" | "displace_atoms" => true,
        "velocity" => ["set", "ramp"].contains(&at(1)),
        "fix" => FIXES.contains(&at(2)),
        _ => false,
    };
    if !takes || cmd.args.iter().any(|w| w.text == "units") {
        return None;
    }
    let mut line = Line::new(cmd, &cmd.name.text);
    line.words(&cmd.args).put("units box", cmd.name.span);
    Some(line.done())
}

#[cfg(test)]
mod tests {
    use crate::tests::behind;

    #[test]
    fn lengths_are_those_of_the_box() {
        let lines = "region a block 0 1 0 1 0 1\nregion b sphere 0 0 0 1 units lattice\ncreate_atoms 1 region a\nvelocity all set 1 2 3\n\
                     velocity all zero linear\ndisplace_atoms all move 0 0 1\nfix m all move linear 1 0 0\nfix g all gravity 9.81 vector 0 0 -1\n";
        let found = behind(&format!("lattice sc 0.01\n{lines}"));
        let wanted = |line: &str| match line.split(' ').next().unwrap() {
            _ if line.contains("units") || line.contains("zero") || line.contains("gravity") => {
                line.to_string()
            }
            _ => format!("{line} units box"),
        };
        assert_eq!(found[1..], lines.lines().map(wanted).collect::<Vec<_>>());
        assert_eq!(behind(lines), lines.lines().collect::<Vec<_>>());
    }
}
