//! Detects how this process was started: by a launcher of several ranks, or by itself.

use super::{Comm, Error};
use std::sync::Arc;

/// Variables that launchers set: number of ranks, this rank; and the launcher's name.
const LAUNCHERS: [(&str, &str, &str); 4] = [
    ("OMPI_COMM_WORLD_SIZE", "OMPI_COMM_WORLD_RANK", "Open MPI"),
    ("PMI_SIZE", "PMI_RANK", "MPICH or its kin"),
    ("MPI_LOCALNRANKS", "MPI_LOCALRANKID", "MPICH or its kin"),
    ("SLURM_STEP_NUM_TASKS", "SLURM_PROCID", "srun"),
];

/// With the value `none`, each process of a launcher runs by itself; any other value names the MPI library to
/// load.
pub(crate) const CHOICE: &str = "PERIGRAIN_MPI";

/// A launcher, from its environment variables.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Launched {
    /// Number of processes it has started.
    pub size: usize,
    /// Rank of this process.
    pub rank: usize,
    /// Its name.
    pub by: &'static str,
}

/// The launcher that has started this process among several; `None` for a single process, and with
/// `PERIGRAIN_MPI=none`.
pub fn launched() -> Option<Launched> {
    found(|key| std::env::var(key).ok())
}

fn found(variable: impl Fn(&str) -> Option<String>) -> Option<Launched> {
    if variable(CHOICE).is_some_and(|choice| choice == "none") {
        return None;
    }
    let number = |key: &str| variable(key)?.trim().parse::<usize>().ok();
    let several = |(size, rank, by): &(&str, &str, &'static str)| {
        let size = number(size).filter(|size| *size > 1)?;
        Some(Launched { size, rank: number(rank).unwrap_or(0), by })
    };
    LAUNCHERS.iter().find_map(several)
}

/// Prepares a program started by a rank so that it does not take itself for a rank.
pub fn set_apart(command: &mut std::process::Command) {
    for (size, rank, _) in LAUNCHERS {
        command.env_remove(size).env_remove(rank);
    }
    #[cfg(unix)]
    command.env_remove(super::local::SEAT);
}

/// Joins the ranks of a launcher.
///
/// # Errors
/// No usable MPI library; a library with another number of ranks than the launcher.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
pub fn open(by: &Launched) -> Result<Arc<dyn Comm>, Error> {
    let mpi = super::Mpi::open()?;
    if mpi.size() != by.size {
        let (library, seen) = (mpi.library(), mpi.size());
        return Err(Error::Other { library, seen, launcher: by.by, started: by.size });
    }
    Ok(Arc::new(mpi))
}

/// Joins the ranks of a launcher.
///
/// # Errors
/// Always: MPI libraries are loaded at run time on Linux only.
#[cfg(not(all(target_os = "linux", target_env = "gnu")))]
pub fn open(_by: &Launched) -> Result<Arc<dyn Comm>, Error> {
    Err(Error::NotLinux)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn launchers_are_known_by_their_variables() {
        let of = |set: &[(&str, &str)]| {
            let set: Vec<(String, String)> =
                set.iter().map(|(k, v)| (k.to_string(), v.to_string())).collect();
            found(|key| set.iter().find(|(k, _)| k == key).map(|(_, v)| v.clone()))
        };
        assert_eq!(of(&[]), None);
        // A job script has these variables from the queue without any launcher.
        assert_eq!(of(&[("SLURM_NTASKS", "4"), ("SLURM_PROCID", "0")]), None);
        assert_eq!(of(&[("OMPI_COMM_WORLD_SIZE", "1"), ("OMPI_COMM_WORLD_RANK", "0")]), None);
        let open = of(&[("OMPI_COMM_WORLD_SIZE", "3"), ("OMPI_COMM_WORLD_RANK", "2")]).unwrap();
        assert_eq!((open.size, open.rank, open.by), (3, 2, "Open MPI"));
        let mpich = [("PMI_SIZE", "2"), ("PMI_RANK", "1")];
        assert_eq!(of(&mpich).unwrap().rank, 1);
        assert_eq!(of(&[&mpich[..], &[(CHOICE, "none")]].concat()), None);
        assert_eq!(of(&[("SLURM_STEP_NUM_TASKS", "2"), ("SLURM_PROCID", "1")]).unwrap().by, "srun");
    }
}
