//! A process that is measured: wall clock, peak memory, how it ended and what it said.

use crate::failure::Failure;
use crate::interrupt;
use crate::statistics::peak_memory;
use std::ffi::OsString;
use std::fs::File;
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

/// Between two looks at the child: what the wall clock is exact to.
const LOOK: Duration = Duration::from_millis(2);
/// Between two looks at its memory, in looks.
const MEMORY_EVERY: u32 = 25;

/// A process that ended.
#[derive(Debug)]
pub(crate) struct Ended {
    /// From start to end.
    pub(crate) seconds: f64,
    /// Most resident memory, bytes.
    pub(crate) memory: Option<u64>,
    /// How it failed; `None` for success.
    pub(crate) failure: Option<String>,
}

/// Runs a command in `folder` to its end, with what it says in the file `log`. It does not outlive this program.
pub(crate) fn run(words: &[OsString], folder: &Path, log: &Path, limit: Option<Duration>) -> Result<Ended, Failure> {
    let program = std::env::current_exe()
        .map_err(|error| Failure::other(format_args!("cannot find this program's own file: {error}")))?;
    let cannot = |what: &str, error: std::io::Error| Failure::other(format_args!("{what} {}: {error}", log.display()));
    let out = File::create(log).map_err(|error| cannot("cannot write", error))?;
    let error_out = out.try_clone().map_err(|error| cannot("cannot write", error))?;
    let mut command = Command::new(program);
    command.arg("leash").arg("--").args(words).current_dir(folder);
    command.stdin(Stdio::null()).stdout(out).stderr(error_out);
    let started = Instant::now();
    let mut child = command.spawn().map_err(|error| Failure::other(format_args!("cannot start a process: {error}")))?;
    let (status, memory) = wait(&mut child, started, limit)?;
    let seconds = started.elapsed().as_secs_f64();
    if interrupt::requested() {
        return Err(Failure::Interrupted);
    }
    let said = std::fs::read(log).map(|bytes| String::from_utf8_lossy(&bytes).into_owned()).unwrap_or_default();
    let failure = match status {
        Some(status) if status.success() => None,
        Some(status) => Some(describe(status, &said)),
        None => Some(format!("was ended after {seconds:.0} s, its limit")),
    };
    Ok(Ended { seconds, memory, failure })
}

/// Waits; `None` for a child that had to be ended.
fn wait(
    child: &mut Child,
    started: Instant,
    limit: Option<Duration>,
) -> Result<(Option<ExitStatus>, Option<u64>), Failure> {
    let fail = |error| Failure::other(format_args!("cannot wait for a process: {error}"));
    let mut memory = None;
    for look in 0u32.. {
        if let Some(status) = child.try_wait().map_err(fail)? {
            return Ok((Some(status), memory));
        }
        if look % MEMORY_EVERY == MEMORY_EVERY - 1 {
            memory = memory.max(peak_memory(Some(child.id())));
        }
        if limit.is_some_and(|limit| started.elapsed() > limit) {
            child.kill().and_then(|()| child.wait()).map_err(fail)?;
            return Ok((None, memory));
        }
        std::thread::sleep(LOOK);
    }
    unreachable!("a child that never ends is waited for")
}

/// `exit code 1: error: no such scene`.
fn describe(status: ExitStatus, said: &str) -> String {
    let how = match status.code() {
        Some(code) => format!("exit code {code}"),
        None => signal(status),
    };
    match last_words(said) {
        Some(words) => format!("{how}: {words}"),
        None => how,
    }
}

#[cfg(unix)]
fn signal(status: ExitStatus) -> String {
    use std::os::unix::process::ExitStatusExt;
    status.signal().map_or("ended without a code".into(), |signal| format!("killed by signal {signal}"))
}

#[cfg(not(unix))]
fn signal(_status: ExitStatus) -> String {
    "ended without a code".into()
}

/// The line that most likely says why: the first error, else the last line.
fn last_words(said: &str) -> Option<String> {
    let lines = || said.lines().map(str::trim).filter(|line| !line.is_empty());
    let line = lines().find(|line| line.starts_with("error:")).or_else(|| lines().next_back())?;
    Some(line.chars().take(400).collect())
}

/// What a render of this program warned of.
pub(crate) fn warnings(log: &Path) -> Vec<String> {
    let said = std::fs::read_to_string(log).unwrap_or_default();
    let mut found: Vec<String> = said.lines().filter_map(|l| l.strip_prefix("warning: ")).map(str::to_owned).collect();
    found.dedup();
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_line_that_says_why() {
        assert_eq!(last_words("start\nerror: no scene\nmore\n"), Some("error: no scene".into()));
        assert_eq!(last_words("one\n\n two \n\n"), Some("two".into()));
        assert_eq!(last_words("\n"), None);
    }
}
