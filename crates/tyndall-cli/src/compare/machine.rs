//! What a comparison was made on, and when.

use std::time::SystemTime;
use tyndall_report::report::Machine;

/// This machine.
pub(crate) fn describe(threads: usize) -> Machine {
    let system = format!("{} {}", std::env::consts::OS, std::env::consts::ARCH);
    Machine { processor: processor().unwrap_or_default(), threads, system }
}

/// The processor's name, as Linux gives it.
fn processor() -> Option<String> {
    let text = std::fs::read_to_string("/proc/cpuinfo").ok()?;
    let line = text.lines().find(|line| line.starts_with("model name"))?;
    Some(line.split_once(':')?.1.trim().to_owned())
}

/// The time, RFC 3339.
pub(crate) fn now() -> String {
    humantime::format_rfc3339_seconds(SystemTime::now()).to_string()
}
