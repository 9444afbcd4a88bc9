//! What a line of a deck has made, in one line for a terminal: LAMMPS' blocks stay in the log.

/// Parts of LAMMPS' blocks without information on the result.
const EMPTY: [&str; 7] = [
    "MPI processor grid",
    " units in orthogonal box = ",
    " units in triclinic box = ",
    "0 fragments",
    "0 bodies",
    " with max type 0",
    // A terminal shows the memory before the run.
    "forecast: about ",
];

/// The lines of a command as one; `None` where they have no content.
pub(super) fn one_line(lines: &[String]) -> Option<String> {
    let shown: Vec<&str> = lines
        .iter()
        .flat_map(|s| s.lines())
        .map(str::trim)
        .filter(|s| !s.is_empty() && !EMPTY.iter().any(|e| s.ends_with(e) || s.contains(e)))
        .collect();
    // `reading atoms ...` is printed before the number of them.
    let begins = |s: &str| s.starts_with("reading ") && s.ends_with(" ...");
    let shown: Vec<&str> = shown.into_iter().filter(|s| !begins(s)).collect();
    let (head, rest) = shown.split_first()?;
    let open =
        head.strip_suffix(" ...").or_else(|| head.strip_suffix("...")).or_else(|| head.strip_suffix(':'));
    let rest = rest.join(", ");
    Some(match (open, rest.is_empty()) {
        (Some(head), true) => head.to_string(),
        (Some(head), false) => format!("{head}: {rest}"),
        (None, true) => (*head).to_string(),
        (None, false) => format!("{head}, {rest}"),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(lines: &[&str]) -> Option<String> {
        one_line(&lines.iter().map(|s| (*s).to_string()).collect::<Vec<_>>())
    }

    #[test]
    fn blocks_become_lines() {
        let of = |lines: &[&str]| line(lines).unwrap_or_default();
        let set =
            ["Setting atom values ...", "  8 settings made for diameter", "  8 settings made for density"];
        assert_eq!(
            of(&set),
            "Setting atom values: 8 settings made for diameter, 8 settings made for density"
        );
        let made = ["Created 8 atoms", "  using lattice units in orthogonal box = (0 0 0) to (1 1 1)"];
        assert_eq!(of(&made), "Created 8 atoms");
        let made = [
            "Created 8 atoms",
            "  using box units in triclinic box = (0 0 0) to (1 1 1) with tilt (0.5 0 0)",
        ];
        assert_eq!(of(&made), "Created 8 atoms");
        let made = ["Created orthogonal box = (0 0 0) to (1 1 1)", "  1 by 1 by 1 MPI processor grid"];
        assert_eq!(of(&made), "Created orthogonal box = (0 0 0) to (1 1 1)");
        let read =
            ["Reading data file ...", "  reading atoms ...", "  8 atoms", "  read_data CPU = 0.001 seconds"];
        assert_eq!(of(&read), "Reading data file: 8 atoms, read_data CPU = 0.001 seconds");
        assert_eq!(line(&["  1 by 1 by 1 MPI processor grid"]), None);
    }
}
