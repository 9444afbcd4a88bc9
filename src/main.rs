//! The `perigrain` program: maps the command line's result to an exit code.

fn main() -> std::process::ExitCode {
    perigrain::cli::main()
}
