//! Constants of the three binary interfaces of MPI libraries.

use super::{Handle, c_int};

/// The interface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Abi {
    /// Open MPI: handles are addresses within the library.
    Open,
    /// MPICH and its derivatives (Intel, MVAPICH, Cray): handles are four-byte numbers.
    Mpich,
    /// The interface of the MPI 5.0 standard, chapter 20.
    Standard,
}

impl Abi {
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Open => "interface of Open MPI",
            Self::Mpich => "interface of MPICH",
            Self::Standard => "standard interface",
        }
    }
}

/// The constants of an interface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Constants {
    pub abi: Abi,
    /// `MPI_COMM_WORLD`.
    pub world: Handle,
    /// `MPI_BYTE`, `MPI_DOUBLE`, `MPI_INT64_T`.
    pub byte: Handle,
    pub double: Handle,
    pub int64: Handle,
    /// `MPI_SUM`, `MPI_MAX`.
    pub sum: Handle,
    pub max: Handle,
    /// `MPI_IN_PLACE`.
    pub in_place: usize,
    /// `MPI_STATUS_IGNORE` and `MPI_STATUSES_IGNORE`.
    pub no_statuses: usize,
    /// `MPI_THREAD_SERIALIZED`.
    pub serialized: c_int,
    /// Size of an entry in a table of requests [bytes].
    pub request: usize,
}

impl Constants {
    /// The constants of an interface; `address` looks up Open MPI's within the library.
    pub(super) fn of(abi: Abi, address: impl Fn(&str) -> Handle) -> Self {
        match abi {
            Abi::Open => Self {
                abi,
                world: address("ompi_mpi_comm_world"),
                byte: address("ompi_mpi_byte"),
                double: address("ompi_mpi_double"),
                int64: address("ompi_mpi_int64_t"),
                sum: address("ompi_mpi_op_sum"),
                max: address("ompi_mpi_op_max"),
                in_place: 1,
                no_statuses: 0,
                serialized: 2,
                request: 8,
            },
            Abi::Mpich => Self {
                abi,
                world: 0x4400_0000,
                byte: 0x4c00_010d,
                double: 0x4c00_080b,
                int64: 0x4c00_083a,
                sum: 0x5800_0003,
                max: 0x5800_0001,
                in_place: usize::MAX,
                no_statuses: 1,
                serialized: 2,
                request: 4,
            },
            Abi::Standard => Self {
                abi,
                world: 0x101,
                byte: 0x247,
                double: 0x214,
                int64: 0x258,
                sum: 0x21,
                max: 0x23,
                in_place: 1,
                no_statuses: 0,
                serialized: 2048,
                request: 8,
            },
        }
    }
}
