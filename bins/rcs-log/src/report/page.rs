//! The page as HTML: light, dark and on paper, without anything from elsewhere.

use std::fmt::Write as _;

use rcs_core::tick::TICK_S;
use record::{Log, proto::foxglove::Level};

use super::{
    gather::{Run, Stretch},
    svg::{Curve, Mark, TimeAxis, curve, escape, lanes, path, scale},
};
use crate::why::{Link, Told};

/// Limits of the link (A 2.3): in/s and rad/s.
const SPEED_LIMIT: f64 = 14.0;
const TURNING_LIMIT: f64 = 1.0;
/// What the controller part of a tick may take (docs/design/tick.md "Budget"), microseconds.
const CONTROLLER_LIMIT: f64 = 20.0;

const STYLE: &str = include_str!("style.css");

/// The page of a run.
#[must_use]
pub fn page(log: &Log, run: &Run) -> String {
    let of = |key: &str| log.run.get(key).map_or("unknown", String::as_str);
    let title = format!("Run of {}", of("job"));
    let mut out = format!(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\
         <meta name=\"viewport\" content=\"width=device-width\"><title>{}</title><style>{STYLE}</style></head>\n<body>\n",
        escape(&title)
    );
    head(log, run, &title, &mut out);
    tiles(log, run, &mut out);
    if let Some(told) = &run.failure {
        failure(told, &mut out);
    }
    drawings(run, &mut out);
    commands(run, &mut out);
    pictures(run, &mut out);
    paths(run, &mut out);
    lines(run, &mut out);
    about(log, &mut out);
    out + "</body></html>\n"
}

fn head(log: &Log, run: &Run, title: &str, out: &mut String) {
    let end = log.end.as_ref().and_then(|end| end.get("result")).map_or("the log has no end", String::as_str);
    let (class, word) = match (&run.chronicle.failure, end) {
        (None, "finished") => ("good", "finished"),
        (None, _) if log.complete => ("", "stopped"),
        (None, _) => ("bad", "broken off"),
        (Some(_), _) => ("bad", "failed"),
    };
    let _ = writeln!(
        out,
        "<header><h1>{}</h1><span class=\"badge {class}\">{word}</span><div class=\"sub\">{}</div></header>",
        escape(title),
        escape(if end == word { "" } else { end })
    );
}

/// The figures that are looked for first.
fn tiles(log: &Log, run: &Run, out: &mut String) {
    let seconds = run.ticks.last().copied().unwrap_or_default() as f64 * TICK_S;
    let most = |values: &[f64]| values.iter().copied().fold(0.0, f64::max);
    let faults: u64 = run.link_faults.iter().map(|count| u64::from(*count)).sum();
    let over = |value: f64, limit: f64| if value > limit * 1.0005 { " bad" } else { "" };
    let (speed, turning) = (most(&run.speed), most(&run.turning));
    let finished = run.chronicle.commands.iter().filter(|command| command.status == "finished").count();
    let end = |key: &str| log.end.as_ref().and_then(|end| end.get(key)).cloned().unwrap_or_default();
    let mut tiles = vec![
        (String::new(), duration(seconds), format!("{} ticks", run.ticks.len())),
        (
            String::new(),
            format!("{finished} of {}", run.chronicle.commands.len()),
            "commands finished".to_owned(),
        ),
        (
            over(speed, SPEED_LIMIT).to_owned(),
            format!("{speed:.1} in/s"),
            format!("top speed, limit {SPEED_LIMIT}"),
        ),
        (
            over(turning, TURNING_LIMIT).to_owned(),
            format!("{turning:.2} rad/s"),
            format!("top turning, limit {TURNING_LIMIT}"),
        ),
        (String::new(), faults.to_string(), "faults and re-starts of the link".to_owned()),
        (String::new(), run.lines.len().to_string(), "warnings and errors".to_owned()),
    ];
    if !run.controller.is_empty() {
        let mut sorted = run.controller.clone();
        sorted.sort_by(f64::total_cmp);
        let p99 = sorted.get((sorted.len() - 1) * 99 / 100).copied().unwrap_or_default();
        let text = format!("controller, 99 of 100 ticks; {} overruns", run.overruns);
        tiles.push((over(p99, CONTROLLER_LIMIT).to_owned(), format!("{p99:.1} µs"), text));
    }
    tiles.push((" long".to_owned(), end("digest"), "digest of all output buffers".to_owned()));
    out.push_str("<div class=\"tiles\">\n");
    for (class, value, text) in tiles {
        let _ = writeln!(
            out,
            "<div class=\"tile{class}\"><b>{}</b><span>{}</span></div>",
            escape(&value),
            escape(&text)
        );
    }
    out.push_str("</div>\n");
}

/// `22 min 13 s`.
fn duration(seconds: f64) -> String {
    let whole = seconds.round() as u64;
    if whole < 60 { format!("{seconds:.1} s") } else { format!("{} min {:02} s", whole / 60, whole % 60) }
}

fn failure(told: &Told, out: &mut String) {
    let story = &told.story;
    let _ = writeln!(
        out,
        "<section class=\"failure\"><h2>Why it failed</h2><p>Tick {} ({:.2} s): {}.</p><p><b>First cause:</b> {}.</p>",
        story.tick,
        story.tick as f64 * TICK_S,
        escape(&story.text),
        escape(&story.first_cause)
    );
    links("The commands that led there", &story.commands, out);
    links("From the failure to its cause, each because of the next", &story.causes, out);
    if !story.evidence.is_empty() {
        out.push_str("<h3>What was sensed while it tried</h3><ol>");
        story.evidence.iter().for_each(|line| {
            let _ = writeln!(out, "<li>{}</li>", escape(line));
        });
        out.push_str("</ol>\n");
    }
    links("What followed", &story.consequences, out);
    out.push_str("</section>\n");
}

fn links(title: &str, links: &[Link], out: &mut String) {
    if links.is_empty() {
        return;
    }
    let _ = writeln!(out, "<h3>{title}</h3><ol>");
    for Link { tick, process, text } in links {
        let _ = writeln!(out, "<li><b>tick {tick}</b>{} {}</li>", escape(process), escape(text));
    }
    out.push_str("</ol>\n");
}

fn commands(run: &Run, out: &mut String) {
    out.push_str(
        "<section><h2>Commands of the workstation controller</h2>\n<table><thead><tr><th class=\"n\">tick</th>\
         <th class=\"n\">at, s</th><th class=\"n\">for, s</th><th>end</th><th>command</th></tr></thead><tbody>\n",
    );
    for command in &run.chronicle.commands {
        let length = (command.last_tick - command.first_tick + 1) as f64 * TICK_S;
        let class = match command.status.as_str() {
            "finished" => "good-text",
            "error" => "bad-text",
            _ => "",
        };
        let _ = writeln!(
            out,
            "<tr><td class=\"n\">{}</td><td class=\"n\">{:.1}</td><td class=\"n\">{length:.1}</td>\
             <td class=\"{class}\">{}</td><td>{}</td></tr>",
            command.first_tick,
            command.first_tick as f64 * TICK_S,
            escape(&command.status),
            escape(&command.text)
        );
    }
    out.push_str("</tbody></table></section>\n");
}

fn drawings(run: &Run, out: &mut String) {
    let (Some(first), Some(last)) = (run.ticks.first(), run.ticks.last()) else { return };
    let axis = TimeAxis::new(*first, *last);
    let marks: Vec<Mark> = run
        .lines
        .iter()
        .map(|(tick, level, _, text)| Mark { tick: tick.0, error: *level == Level::Error, text })
        .collect();
    out.push_str("<section><h2>Commands by level</h2>\n");
    let link: Vec<(&str, Vec<Stretch>)> = vec![("Link", run.link.clone())];
    out.push_str(&lanes(&run.lanes, &marks, axis));
    out.push_str(&lanes(&link, &[], axis));
    out.push_str(&scale(axis));
    out.push_str("</section>\n<section><h2>Motion, forces, link and time</h2>\n");
    let faults: Vec<f64> = run.link_faults.iter().map(|count| f64::from(*count)).collect();
    let mut curves = vec![
        Curve { name: "speed", unit: "in/s", values: &run.speed, limit: Some(SPEED_LIMIT) },
        Curve { name: "turning", unit: "rad/s", values: &run.turning, limit: Some(TURNING_LIMIT) },
        Curve { name: "finger opening", unit: "in", values: &run.opening, limit: None },
        Curve { name: "finger force", unit: "lb", values: &run.force, limit: None },
    ];
    if run.tool_force.iter().any(|force| *force > 0.0) {
        curves.push(Curve { name: "force on the tool", unit: "lb", values: &run.tool_force, limit: None });
    }
    curves.push(Curve { name: "link faults", unit: "a tick", values: &faults, limit: None });
    if !run.controller.is_empty() {
        let limit = Some(CONTROLLER_LIMIT);
        curves.push(Curve { name: "controller", unit: "µs", values: &run.controller, limit });
    }
    for each in &curves {
        out.push_str(&curve(each, &run.ticks, axis));
    }
    out.push_str(&scale(axis));
    if run.controller.is_empty() {
        out.push_str("<p class=\"sub\">A run in fast clock has no times of the controller in its log: the same run writes the same bytes.</p>\n");
    }
    out.push_str("</section>\n");
}

fn pictures(run: &Run, out: &mut String) {
    if run.pictures.is_empty() {
        return;
    }
    out.push_str(
        "<section><h2>The cell where commands begin, and at the end</h2>\n<div class=\"gallery\">\n",
    );
    for picture in &run.pictures {
        let _ = writeln!(
            out,
            "<figure>{}<figcaption><b>{:.1} s</b> · {}</figcaption></figure>",
            picture.svg,
            picture.tick as f64 * TICK_S,
            escape(&picture.text)
        );
    }
    out.push_str("</div></section>\n");
}

fn paths(run: &Run, out: &mut String) {
    let at = |tick: u64| run.ticks.binary_search(&tick).ok().and_then(|at| run.path.get(at)).copied();
    let stops: Vec<[f64; 3]> =
        run.chronicle.commands.iter().filter_map(|command| at(command.last_tick)).collect();
    out.push_str("<section><h2>Path of the tool point</h2>\n<div class=\"pair\">\n");
    out.push_str(&path(
        "From above: +X (machine tool) to the right, +Y up; inches. Dots: where commands ended.",
        &run.path,
        &stops,
        |p| [p[0], p[1]],
    ));
    out.push_str(&path(
        "From the side: distance from the base axis to the right, +Z up; inches.",
        &run.path,
        &stops,
        |p| [p[0].hypot(p[1]), p[2]],
    ));
    out.push_str("</div></section>\n");
}

fn lines(run: &Run, out: &mut String) {
    out.push_str("<section><h2>Warnings and errors</h2>\n");
    if run.lines.is_empty() {
        let _ = writeln!(out, "<p>None among the {} lines of the log.</p></section>", run.all_lines);
        return;
    }
    out.push_str(
        "<table><thead><tr><th class=\"n\">tick</th><th></th><th>who</th><th>what</th></tr></thead><tbody>\n",
    );
    for (tick, level, source, text) in &run.lines {
        let (class, word) =
            if *level == Level::Error { ("bad-text", "error") } else { ("warn-text", "warning") };
        let _ = writeln!(
            out,
            "<tr><td class=\"n\">{tick}</td><td class=\"{class}\">{word}</td><td>{}</td><td>{}</td></tr>",
            escape(source),
            escape(text)
        );
    }
    out.push_str("</tbody></table></section>\n");
}

/// What it takes to run it again, and what the run says of itself.
fn about(log: &Log, out: &mut String) {
    out.push_str("<section><h2>The run</h2>\n<table><tbody>\n");
    let end = log.end.iter().flatten().filter(|(key, _)| !key.starts_with("lost_"));
    for (key, value) in log.run.iter().chain(end).filter(|(_, value)| !value.is_empty()) {
        let name = key.replace('_', " ");
        let _ = writeln!(out, "<tr><th>{}</th><td class=\"mono\">{}</td></tr>", escape(&name), escape(value));
    }
    let names: Vec<&str> = log.attachments.iter().map(|attachment| attachment.name.as_str()).collect();
    let _ = writeln!(
        out,
        "<tr><th>attached files</th><td class=\"mono\">{}</td></tr></tbody></table></section>",
        escape(&names.join(", "))
    );
}
