//! The text of a log before and after a run: memory, loop time, timing tables, counts, wall time.

use perigrain_base::comm;
use perigrain_base::math::cformat::{Format, Value, general};

/// A line of the timing table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Section<'a> {
    /// LAMMPS' word: `Pair`, `Bond`, `Neigh`, `Comm`, `Output`, `Modify`.
    pub name: &'a str,
    /// Wall time in seconds.
    pub seconds: f64,
}

/// Everything that is printed at the end of a run.
#[derive(Clone, Copy, Debug, Default)]
pub struct Finish<'a> {
    /// Wall time of the loop in seconds.
    pub seconds: f64,
    /// Processor time of the loop in seconds.
    pub cpu: f64,
    /// Steps done.
    pub steps: i64,
    /// Particles.
    pub atoms: u64,
    /// Threads used.
    pub threads: usize,
    /// The deck's unit system: `si`, `lj`, ….
    pub units: &'a str,
    /// Simulated time of the loop in these units.
    pub time: f64,
    /// Where the time went; the rest of `seconds` is `Other`.
    pub sections: &'a [Section<'a>],
    /// Entries of full lists (peridynamic families among them), if there are any.
    pub full: Option<u64>,
    /// Neighbour list builds.
    pub builds: u64,
    /// Builds that came later than they should have.
    pub dangerous: u64,
    /// The summary of a minimization.
    pub minimized: Option<&'a str>,
}

/// The line before the first row, in megabytes.
pub fn memory_line(bytes: u64) -> String {
    let mb = print("%.4g", &[Value::Float(bytes as f64 / 1024.0 / 1024.0)]);
    format!("Per MPI rank memory allocation (min/avg/max) = {mb} | {mb} | {mb} Mbytes")
}

/// The last line of a log.
pub fn wall_time(seconds: f64) -> String {
    let s = seconds.max(0.0) as u64;
    format!("Total wall time: {}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60)
}

impl Finish<'_> {
    /// The whole text after the last row, without the last newline.
    pub fn text(&self) -> String {
        let mut text = format!(
            "Loop time of {} on {} procs for {} steps with {} atoms\n\n",
            general(self.seconds, 6),
            comm::present().size(),
            self.steps,
            self.atoms
        );
        if self.steps > 0 && self.seconds > 0.0 && self.minimized.is_none() {
            text.push_str(&self.performance());
        }
        let percent = if self.seconds > 0.0 { 100.0 * self.cpu / self.seconds } else { 0.0 };
        text.push_str(&format!(
            "{percent:.1}% CPU use with {} MPI tasks x {} OpenMP threads\n\n",
            comm::present().size(),
            self.threads
        ));
        if let Some(block) = self.minimized {
            text.push_str(block);
            text.push_str("\n\n");
        }
        text.push_str(&self.breakdown());
        text.push_str(&self.counts());
        text
    }

    /// Simulated time and steps per unit of wall time, in LAMMPS' words.
    fn performance(&self) -> String {
        let per_day = self.time / self.seconds * 86400.0;
        let in_units = match self.units {
            "lj" => print("%.3f tau/day, ", &[Value::Float(per_day)]),
            "electron" => Self::pair("fs", per_day),
            "real" => Self::pair("ns", per_day * 1e-6),
            "metal" => Self::pair("ns", per_day * 1e-3),
            "nano" => Self::pair("ns", per_day),
            _ => String::new(),
        };
        let steps = self.steps as f64 / self.seconds;
        let (rate, prefix) = match steps * self.atoms as f64 {
            r if r >= 1e9 => (r * 1e-9, "G"),
            r if r >= 1e6 => (r * 1e-6, "M"),
            r if r >= 1e3 => (r * 1e-3, "k"),
            r => (r, ""),
        };
        format!("Performance: {in_units}{steps:.3} timesteps/s, {rate:.3} {prefix}atom-step/s\n")
    }

    fn pair(unit: &str, per_day: f64) -> String {
        format!("{per_day:.3} {unit}/day, {:.3} hours/{unit}, ", 24.0 / per_day)
    }

    /// LAMMPS' table of where the time went.
    fn breakdown(&self) -> String {
        let mut text = String::from(
            "MPI task timing breakdown:\n\
             Section |  min time  |  avg time  |  max time  |%varavg| %total\n\
             ---------------------------------------------------------------\n",
        );
        let share = |seconds: f64| if self.seconds > 0.0 { 100.0 * seconds / self.seconds } else { 0.0 };
        for s in self.sections {
            let (time, percent) = (Value::Float(s.seconds), Value::Float(share(s.seconds)));
            let name = Value::Text(s.name);
            text.push_str(&print(
                "%-8s| %-10.5g | %-10.5g | %-10.5g |   0.0 |%6.2f\n",
                &[name, time, time, time, percent],
            ));
        }
        // Times of short steps are those of some of them: sums may be a little more than all.
        let other = (self.seconds - self.sections.iter().map(|s| s.seconds).sum::<f64>()).max(0.0);
        // Rounding may leave a hair below zero.
        let other = other.max(0.0);
        text.push_str(&print(
            "Other   |            | %-10.4g |            |       |%6.2f\n\n",
            &[Value::Float(other), Value::Float(share(other))],
        ));
        text
    }

    /// LAMMPS' counts, without those that do not exist here; there are no ghosts.
    fn counts(&self) -> String {
        let mut text = count("Nlocal:", self.atoms) + &count("Nghost:", 0);
        if let Some(total) = self.full {
            text.push_str(&count("FullNghs:", total));
            let average = if self.atoms > 0 { total as f64 / self.atoms as f64 } else { 0.0 };
            let average = general(average, 8);
            text.push_str(&format!("\nTotal # of neighbors = {total}\nAve neighs/atom = {average}"));
        }
        let (builds, dangerous) = (self.builds, self.dangerous);
        text.push_str(&format!("\nNeighbor list builds = {builds}\nDangerous builds = {dangerous}"));
        text
    }
}

/// One quantity and its histogram over one process.
fn count(name: &str, value: u64) -> String {
    let v = Value::Float(value as f64);
    let line = print("%-11s%11.6g ave %11.6g max %11.6g min\n", &[Value::Text(name), v, v, v]);
    line + "Histogram: 1 0 0 0 0 0 0 0 0 0\n"
}

/// Time by op, the longest first: name, seconds, calls. Follows LAMMPS' own table in a log.
pub fn ops_table(ops: &[(&str, f64, u64)], seconds: f64) -> String {
    let mut order: Vec<usize> = (0..ops.len()).collect();
    order.sort_by(|&a, &b| ops[b].1.total_cmp(&ops[a].1));
    let width = ops.iter().map(|o| o.0.len()).max().unwrap_or(0).max("Op".len());
    let mut text = format!("Time by op:\n{:<width$} |  seconds   | %total |   calls    | us/call\n", "Op");
    text.push_str(&"-".repeat(width + 45));
    for k in order {
        let (name, time, calls) = ops[k];
        let share = if seconds > 0.0 { 100.0 * time / seconds } else { 0.0 };
        let each = if calls > 0 { 1e6 * time / calls as f64 } else { 0.0 };
        let numbers = print(
            " | %-10.5g | %6.2f | %10d | %.4g",
            &[Value::Float(time), Value::Float(share), Value::Int(calls as i64), Value::Float(each)],
        );
        text.push_str(&format!("\n{name:<width$}{numbers}"));
    }
    text
}

/// `printf` into a string, for formats written in this file.
fn print(format: &str, values: &[Value<'_>]) -> String {
    Format::parse(format).map(|f| f.text(values)).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The end of LAMMPS 22Jul2025's log of the reference deck pd_pmb_collide (timings of that run), with
    /// the Nghost line as it is there and a Performance line, which LAMMPS leaves out in units si.
    const COLLIDE: &str = "\
Loop time of 0.521856 on 1 procs for 700 steps with 455 atoms

Performance: 1341.366 timesteps/s, 610.322 katom-step/s
67.2% CPU use with 1 MPI tasks x 1 OpenMP threads

MPI task timing breakdown:
Section |  min time  |  avg time  |  max time  |%varavg| %total
---------------------------------------------------------------
Pair    | 0.50214    | 0.50214    | 0.50214    |   0.0 | 96.22
Neigh   | 0.0047208  | 0.0047208  | 0.0047208  |   0.0 |  0.90
Comm    | 0.00021104 | 0.00021104 | 0.00021104 |   0.0 |  0.04
Output  | 0.010238   | 0.010238   | 0.010238   |   0.0 |  1.96
Modify  | 0.0032427  | 0.0032427  | 0.0032427  |   0.0 |  0.62
Other   |            | 0.001303   |            |       |  0.25

Nlocal:            455 ave         455 max         455 min
Histogram: 1 0 0 0 0 0 0 0 0 0
Nghost:              0 ave           0 max           0 min
Histogram: 1 0 0 0 0 0 0 0 0 0
FullNghs:        51146 ave       51146 max       51146 min
Histogram: 1 0 0 0 0 0 0 0 0 0

Total # of neighbors = 51146
Ave neighs/atom = 112.40879
Neighbor list builds = 14
Dangerous builds = 0";

    #[test]
    fn the_end_of_a_log() {
        let sections = [
            ("Pair", 0.50214),
            ("Neigh", 0.0047208),
            ("Comm", 0.00021104),
            ("Output", 0.010238),
            ("Modify", 0.0032427),
        ]
        .map(|(name, seconds)| Section { name, seconds });
        let finish = Finish {
            seconds: 0.521856,
            cpu: 0.672 * 0.521856,
            steps: 700,
            atoms: 455,
            threads: 1,
            units: "si",
            time: 700.0 * 5e-8,
            sections: &sections,
            full: Some(51146),
            builds: 14,
            dangerous: 0,
            minimized: None,
        };
        // Half lists, which LAMMPS counts too, are not here. "Other" differs from its 0.001308 because the sections above are already rounded.
        assert_eq!(finish.text(), COLLIDE);
    }

    #[test]
    fn performance_in_units() {
        // From probe logs of LAMMPS 22Jul2025: 10 steps of 27 particles; timings of those runs.
        let f = |units, seconds, dt: f64| {
            Finish { seconds, steps: 10, atoms: 27, units, time: 10.0 * dt, ..Finish::default() }
                .performance()
        };
        let digits = |text: &str| text.split(' ').nth(1).unwrap().parse::<f64>().unwrap();
        let lj = f("lj", 5.0325e-05, 0.005);
        assert!(lj.contains(" tau/day, ") && lj.contains(" Matom-step/s"));
        // 85842026.826 tau/day; the loop time in the log has six digits.
        assert!((digits(&lj) / 85842026.826 - 1.0).abs() < 1e-5);
        let real = f("real", 0.000179686, 1.0);
        // 4808.388 ns/day, 0.005 hours/ns, 55652.638 timesteps/s, 1.503 Matom-step/s.
        assert!((digits(&real) / 4808.388 - 1.0).abs() < 1e-5);
        assert!(real.contains(" ns/day, 0.005 hours/ns, 5565") && real.ends_with(" 1.503 Matom-step/s\n"));
        let electron = f("electron", 4.8872e-05, 0.001);
        assert!((digits(&electron) / 17678834.506 - 1.0).abs() < 1e-5, "{electron}");
        let nano = f("nano", 5.0555e-05, 0.00045);
        assert!((digits(&nano) / 7690633.963 - 1.0).abs() < 1e-4, "{nano}");
    }

    #[test]
    fn single_lines() {
        assert_eq!(
            memory_line((4.316 * 1048576.0) as u64),
            "Per MPI rank memory allocation (min/avg/max) = 4.316 | 4.316 | 4.316 Mbytes"
        );
        assert_eq!(wall_time(3725.9), "Total wall time: 1:02:05");
        let zero = Finish { threads: 2, ..Finish::default() }.text();
        assert!(zero.contains("0.0% CPU use with 1 MPI tasks x 2 OpenMP threads"));
        assert!(!zero.contains("NaN") && !zero.contains("Performance"));
    }

    #[test]
    fn time_by_op() {
        let table = ops_table(&[("fix nve", 0.25, 10), ("pair peri/pmb", 0.75, 10)], 1.0);
        let lines: Vec<&str> = table.lines().collect();
        assert_eq!(lines[3], "pair peri/pmb | 0.75       |  75.00 |         10 | 7.5e+04");
        assert_eq!(lines[4], "fix nve       | 0.25       |  25.00 |         10 | 2.5e+04");
    }
}
