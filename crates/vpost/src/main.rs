//! The command `vpost`.

use std::process::ExitCode;

fn main() -> ExitCode {
    vpost::run(std::env::args_os())
}
