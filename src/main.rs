//! The command without Python: everything but `closecall run`.

use std::process::ExitCode;

fn main() -> ExitCode {
    closecall::cli::keep_panics_quiet();
    ExitCode::from(closecall::cli::main(std::env::args_os(), None))
}
