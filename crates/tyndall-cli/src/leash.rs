//! A child that does not outlive the program: `tyndall leash COMMAND...` becomes COMMAND.
//!
//! A program that is killed cannot end its children. Instead the child asks the system for its own end, before it becomes
//! the program that it was started for. Only Linux offers that; elsewhere a killed comparison leaves its render to finish.

use crate::failure::Failure;
use std::ffi::OsString;
use std::process::{Command, ExitCode};

/// Becomes the command; comes back only if that fails.
pub(crate) fn run(command: &[OsString]) -> Result<ExitCode, Failure> {
    let (program, arguments) =
        command.split_first().ok_or_else(|| Failure::usage("expected a command to become, found none"))?;
    #[cfg(target_os = "linux")]
    {
        let signal = Some(rustix::process::Signal::KILL);
        rustix::process::set_parent_process_death_signal(signal)
            .map_err(|error| Failure::other(format_args!("cannot ask for the parent's end: {error}")))?;
    }
    let mut command = Command::new(program);
    command.args(arguments);
    let name = program.to_string_lossy();
    become_it(&mut command).map_err(|error| Failure::other(format_args!("cannot start `{name}`: {error}")))
}

#[cfg(unix)]
fn become_it(command: &mut Command) -> std::io::Result<ExitCode> {
    use std::os::unix::process::CommandExt;
    Err(command.exec())
}

#[cfg(not(unix))]
fn become_it(command: &mut Command) -> std::io::Result<ExitCode> {
    let code = command.status()?.code();
    Ok(code.and_then(|code| u8::try_from(code).ok()).map_or(ExitCode::FAILURE, ExitCode::from))
}
