//! The command without Python: everything but `closecall run`.

use std::process::ExitCode;

fn main() -> ExitCode {
    closecall_cli::keep_panics_quiet();
    ExitCode::from(closecall_cli::main(std::env::args_os(), None))
}
