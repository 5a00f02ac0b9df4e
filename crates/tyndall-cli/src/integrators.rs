//! `tyndall integrators`: the registry as text, for people and for the manual.

use crate::args::Integrators;
use crate::choice::find;
use crate::console::print;
use crate::failure::Failure;
use std::fmt::Write;
use tyndall::integrators::{IntegratorInfo, ParameterInfo, REGISTRY};

/// Prints the list, or the description of one.
pub(crate) fn run(args: &Integrators) -> Result<(), Failure> {
    let chosen: Vec<&IntegratorInfo> = match &args.name {
        Some(name) => vec![find(name)?],
        None => REGISTRY.iter().collect(),
    };
    if args.markdown {
        return print(&chosen.into_iter().map(markdown).collect::<Vec<_>>().join("\n"));
    }
    match (&args.name, &chosen[..]) {
        (Some(_), [info]) => print(&description(info)),
        _ => print(&list(&chosen)),
    }
}

/// One line each.
fn list(infos: &[&IntegratorInfo]) -> String {
    let width = infos.iter().map(|info| info.name.len()).max().unwrap_or(0);
    let mut text: String = infos.iter().map(|info| format!("{:width$}  {}\n", info.name, info.summary)).collect();
    text += "\n`tyndall integrators NAME` describes one with its parameters.\n";
    text
}

/// Everything about one, for a terminal.
fn description(info: &IntegratorInfo) -> String {
    let mut text = format!("{}\n", info.name);
    if !info.aliases.is_empty() {
        text += &format!("also called {}\n", info.aliases.join(", "));
    }
    text += &format!("\n{}\nSource: {}\n", info.summary, info.source);
    if info.parameters.is_empty() {
        text += "\nIt has no parameters.\n";
    } else {
        text += "\nParameters (--set NAME=VALUE):\n";
    }
    for parameter in info.parameters {
        let ParameterInfo { name, kind, default, description, .. } = parameter;
        let _ =
            write!(text, "\n  {name}: {kind}{}, default {}\n      {description}\n", unit(parameter), shown(default));
    }
    text
}

/// Everything about one, as a page of the manual.
fn markdown(info: &IntegratorInfo) -> String {
    let mut text = format!("# `{}`\n\n{}\n\n", info.name, info.summary);
    if !info.aliases.is_empty() {
        let aliases: Vec<String> = info.aliases.iter().map(|alias| format!("`{alias}`")).collect();
        text += &format!("Also called {}.\n\n", aliases.join(", "));
    }
    text += &format!("Source: {}.\n\n", info.source);
    if info.parameters.is_empty() {
        text += "It has no parameters.\n";
        return text;
    }
    text += "| parameter | value | default | |\n|---|---|---|---|\n";
    for parameter in info.parameters {
        let ParameterInfo { name, kind, default, description, .. } = parameter;
        let _ = writeln!(text, "| `{name}` | {kind}{} | `{}` | {description} |", unit(parameter), shown(default));
    }
    text
}

fn unit(parameter: &ParameterInfo) -> String {
    if parameter.unit.is_empty() { String::new() } else { format!(", {}", parameter.unit) }
}

/// An empty default has to be visible.
fn shown(default: &str) -> &str {
    if default.is_empty() { "(empty)" } else { default }
}
