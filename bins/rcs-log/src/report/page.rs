//! The page as HTML: light, dark and on paper, without anything from elsewhere.

use std::fmt::Write as _;

use rcs_core::tick::TICK_S;
use record::{Log, proto::foxglove::Level};

use super::{
    gather::Run,
    svg::{Curve, TimeAxis, curve, escape, lanes, path},
};

/// Limits of the link (A 2.3): in/s and rad/s.
const SPEED_LIMIT: f64 = 14.0;
const TURNING_LIMIT: f64 = 1.0;

const STYLE: &str = "
:root { color-scheme: light dark; --ink: #1c2733; --paper: #ffffff; --faint: #8a97a5; --line: #2563a8; --limit: #b3361b; }
@media (prefers-color-scheme: dark) {
  :root { --ink: #dde5ec; --paper: #12181f; --faint: #76838f; --line: #6db1f2; --limit: #f0836a; }
}
body { font: 15px/1.45 system-ui, sans-serif; color: var(--ink); background: var(--paper); margin: 2rem auto; max-width: 1240px; padding: 0 1rem; }
h1 { font-size: 1.5rem; } h2 { font-size: 1.1rem; margin-top: 2rem; }
table { border-collapse: collapse; } td, th { text-align: left; padding: .15rem .9rem .15rem 0; vertical-align: top; }
td.n { text-align: right; font-variant-numeric: tabular-nums; }
svg { width: 100%; height: auto; display: block; } svg text { font: 12px system-ui, sans-serif; fill: var(--ink); }
svg text.scale { fill: var(--faint); } svg text.in { fill: #10161c; font-size: 11px; pointer-events: none; }
rect { stroke: var(--paper); stroke-width: .5; }
.c0 { fill: #9ecae9; } .c1 { fill: #f6c28b; } .c2 { fill: #a6d8a8; } .c3 { fill: #e7a9a9; } .c4 { fill: #c9b6e4; } .c5 { fill: #d8c7a3; }
.c6 { fill: #a3d6d1; } .c7 { fill: #e6b8d8; }
polyline { fill: none; stroke: var(--line); stroke-width: 1; } .path { stroke-width: .8; }
.limit { stroke: var(--limit); stroke-dasharray: 5 4; } .axis { stroke: var(--faint); stroke-width: .5; }
.pair { display: grid; grid-template-columns: 1fr 1fr; gap: 1rem; } figure { margin: 0; } figcaption { color: var(--faint); }
.failure { border-left: 4px solid var(--limit); padding-left: .8rem; }
@media print { body { margin: 0; max-width: none; } h2 { break-after: avoid; } svg { break-inside: avoid; } }
";

/// The page of a run.
#[must_use]
pub fn page(log: &Log, run: &Run) -> String {
    let of = |key: &str| log.run.get(key).map_or("unknown", String::as_str);
    let title = format!("Run of {}", of("job"));
    let mut out = format!(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\
         <meta name=\"viewport\" content=\"width=device-width\"><title>{0}</title><style>{STYLE}</style></head>\n\
         <body><h1>{0}</h1>\n",
        escape(&title)
    );
    head(log, run, &mut out);
    commands(run, &mut out);
    drawings(run, &mut out);
    lines(run, &mut out);
    out + "</body></html>\n"
}

fn head(log: &Log, run: &Run, out: &mut String) {
    let of = |key: &str| log.run.get(key).map_or("unknown", String::as_str);
    let end = log.end.as_ref().and_then(|end| end.get("result"));
    let last = run.ticks.last().copied().unwrap_or_default();
    let rows = [
        ("ended", end.map_or("the log has no end", String::as_str).to_owned()),
        ("length", format!("{} ticks, {:.1} s", run.ticks.len(), last as f64 * TICK_S)),
        ("program", format!("{} {}, commit {}", of("program"), of("version"), of("commit"))),
        ("command line", of("command_line").to_owned()),
        ("seed, clock, robot", format!("{}, {}, {}", of("seed"), of("clock"), of("robot"))),
        ("digest", log.end.as_ref().and_then(|end| end.get("digest")).cloned().unwrap_or_default()),
    ];
    out.push_str("<table>\n");
    for (name, value) in rows {
        let _ = writeln!(out, "<tr><th>{name}</th><td>{}</td></tr>", escape(&value));
    }
    out.push_str("</table>\n");
    if let Some(failure) = &run.chronicle.failure {
        let _ = writeln!(out, "<p class=\"failure\">Tick {}: {}</p>", failure.tick, escape(&failure.text));
    }
}

fn commands(run: &Run, out: &mut String) {
    out.push_str("<h2>Commands</h2>\n<table><tr><th>tick</th><th>at s</th><th>for s</th><th>status</th><th></th></tr>\n");
    for command in &run.chronicle.commands {
        let length = (command.last_tick - command.first_tick + 1) as f64 * TICK_S;
        let _ = writeln!(
            out,
            "<tr><td class=\"n\">{}</td><td class=\"n\">{:.1}</td><td class=\"n\">{length:.1}</td><td>{}</td><td>{}</td></tr>",
            command.first_tick,
            command.first_tick as f64 * TICK_S,
            escape(&command.status),
            escape(&command.text)
        );
    }
    out.push_str("</table>\n");
}

fn drawings(run: &Run, out: &mut String) {
    let (Some(first), Some(last)) = (run.ticks.first(), run.ticks.last()) else { return };
    let axis = TimeAxis::new(*first, *last);
    out.push_str("<h2>Commands by level</h2>\n");
    out.push_str(&lanes(&run.lanes, axis));
    out.push_str("<h2>Motion</h2>\n");
    let faults: Vec<f64> = run.link_faults.iter().map(|count| f64::from(*count)).collect();
    let curves = [
        Curve { name: "speed, in/s", values: &run.speed, limit: Some(SPEED_LIMIT) },
        Curve { name: "turning, rad/s", values: &run.turning, limit: Some(TURNING_LIMIT) },
        Curve { name: "opening, in", values: &run.opening, limit: None },
        Curve { name: "finger force, lb", values: &run.force, limit: None },
        Curve { name: "link faults", values: &faults, limit: None },
    ];
    for each in &curves {
        out.push_str(&curve(each, &run.ticks, axis));
    }
    out.push_str("<h2>Path of the tool point</h2>\n<div class=\"pair\">\n");
    out.push_str(&path("From above: +X (machine tool) to the right, +Y up", &run.path, |p| p[0], |p| p[1]));
    out.push_str(&path(
        "From the side: distance from the base axis to the right, +Z up",
        &run.path,
        |p| p[0].hypot(p[1]),
        |p| p[2],
    ));
    out.push_str("</div>\n");
}

fn lines(run: &Run, out: &mut String) {
    out.push_str("<h2>Warnings and errors</h2>\n");
    if run.lines.is_empty() {
        out.push_str("<p>None.</p>\n");
        return;
    }
    out.push_str("<table>\n");
    for (tick, level, source, text) in &run.lines {
        let word = if *level == Level::Error { "error" } else { "warning" };
        let _ = writeln!(
            out,
            "<tr><td class=\"n\">{tick}</td><td>{word}</td><td>{}</td><td>{}</td></tr>",
            escape(source),
            escape(text)
        );
    }
    out.push_str("</table>\n");
}
