//! The reference page of a program.

use std::collections::hash_map::Entry;
use std::collections::{BTreeMap, HashMap};
use std::fmt::Write as _;

use clap::{Arg, Command};

/// A section for the program and each subcommand. An argument of several commands is described once.
#[must_use]
pub fn markdown(command: &Command) -> String {
    let mut command = command.clone();
    command.build();
    let mut page = String::new();
    section(&command, 1, &mut HashMap::new(), &mut page);
    page
}

/// `described` lists the arguments that are already described, with their commands.
fn section(command: &Command, depth: usize, described: &mut HashMap<String, String>, page: &mut String) {
    let name = command.get_bin_name().unwrap_or(command.get_name());
    let usage = command.clone().render_usage().to_string();
    let about = command.get_long_about().or(command.get_about()).map(ToString::to_string).unwrap_or_default();
    let about: Vec<String> = about.split("\n\n").map(paragraph).collect();
    add(page, format_args!("{} {name}\n\n{}\n", "#".repeat(depth), about.join("\n\n")));
    let usage: Vec<_> = usage.trim_start_matches("Usage: ").lines().map(str::trim).collect();
    add(page, format_args!("```text\n{}\n```\n", usage.join("\n")));
    // Options of all subcommands are listed once, at the program.
    let shown = |argument: &&Arg| {
        let is_told = depth > 1 && argument.is_global_set();
        !argument.is_hide_set() && !is_told && !matches!(argument.get_id().as_str(), "help" | "version")
    };
    let mut elsewhere: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for argument in command.get_arguments().filter(shown) {
        let what = format!("{}: {}", label(argument), escaped(&text(argument)));
        match described.entry(what) {
            Entry::Occupied(at) => elsewhere.entry(at.get().clone()).or_default().push(typed(argument)),
            Entry::Vacant(at) => {
                add(page, format_args!("- {}", at.key().trim_end_matches([':', ' '])));
                at.insert(name.to_owned());
            }
        }
    }
    for (name, arguments) in elsewhere {
        add(page, format_args!("- As for `{name}`: {}.", arguments.join(", ")));
    }
    if command.get_arguments().any(|argument| shown(&argument)) {
        page.push('\n');
    }
    if let Some(after) = command.get_after_help() {
        add(page, format_args!("```text\n{after}\n```\n"));
    }
    let visible = |below: &&Command| !below.is_hide_set() && below.get_name() != "help";
    command.get_subcommands().filter(visible).for_each(|below| section(below, depth + 1, described, page));
}

/// The name of an argument: `--json`, or `<JOB>` without a flag.
fn typed(argument: &Arg) -> String {
    let value = || argument.get_value_names().unwrap_or_default().join(" ");
    argument.get_long().map_or_else(|| format!("`<{}>`", value()), |long| format!("`--{long}`"))
}

fn label(argument: &Arg) -> String {
    let values = argument.get_value_names().unwrap_or_default();
    let values = if argument.get_action().takes_values() {
        values.iter().map(|value| format!("<{value}>")).collect::<Vec<_>>().join(" ")
    } else {
        String::new()
    };
    let option = argument.get_long().map(|long| format!("--{long}"));
    let typed =
        option.into_iter().chain((!values.is_empty()).then_some(values)).collect::<Vec<_>>().join(" ");
    let default: Vec<_> = argument.get_default_values().iter().map(|value| value.to_string_lossy()).collect();
    let is_shown = !argument.is_hide_default_value_set() && !default.is_empty();
    let taken = argument.get_action().takes_values() && is_shown;
    if taken { format!("`{typed}` (default `{}`)", default.join(",")) } else { format!("`{typed}`") }
}

/// The help on one line, with the possible values.
fn text(argument: &Arg) -> String {
    let help = argument.get_long_help().or(argument.get_help()).map(ToString::to_string).unwrap_or_default();
    let mut text = sentence(&help.split("\n\n").map(sentence).collect::<Vec<_>>().join(" "));
    let values = argument.get_possible_values();
    if argument.get_action().takes_values() && !argument.is_hide_possible_values_set() && !values.is_empty() {
        let value = |value: &clap::builder::PossibleValue| {
            let help = value.get_help().map(|help| format!(" ({help})")).unwrap_or_default();
            format!("`{}`{help}", value.get_name())
        };
        let values = values.iter().filter(|value| !value.is_hide_set()).map(value).collect::<Vec<_>>();
        let _ = write!(text, " Values: {}.", values.join(", "));
    }
    text
}

fn escaped(text: &str) -> String {
    text.replace('<', "\\<").replace('|', "\\|")
}

/// A paragraph of prose; other lines do not change.
fn paragraph(text: &str) -> String {
    let own_lines = text.lines().any(|line| line.starts_with(' '));
    if own_lines { format!("```text\n{text}\n```") } else { escaped(&sentence(text)) }
}

/// One line that ends with a full stop.
fn sentence(text: &str) -> String {
    let line = text.split_whitespace().collect::<Vec<_>>().join(" ");
    if line.is_empty() || line.ends_with(['.', ')', ':']) { line } else { line + "." }
}

fn add(page: &mut String, line: std::fmt::Arguments<'_>) {
    let _ = writeln!(page, "{line}"); // cannot fail
}
