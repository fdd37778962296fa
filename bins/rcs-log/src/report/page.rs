//! The HTML page, for light and dark screens and for print. It loads nothing from other files.

use maud::{DOCTYPE, Markup, PreEscaped, html};
use os_io::text::amount;
use os_io::units::shown;
use rcs_core::tick::TICK_S;
use record::{Log, proto::foxglove::Level};

use super::{
    gather::{Picture, Run, Stretch},
    svg::{Curve, Mark, TimeAxis, curve, lanes, path, scale},
};
use crate::why::{Link, Told};

/// Limits of the link (A 2.3): in/s and rad/s.
const SPEED_LIMIT: f64 = 14.0;
const TURNING_LIMIT: f64 = 1.0;
/// Time limit of the controller part of a tick (docs/design/tick.md "Budget"), us.
const CONTROLLER_LIMIT: f64 = 20.0;

const STYLE: &str = include_str!("style.css");

/// The page of a run, in the units of the person.
#[must_use]
pub fn page(log: &Log, run: &Run) -> String {
    let title = format!("Run of {}", log.run.get("job").map_or("unknown", String::as_str));
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width";
                title { (title) }
                style { (PreEscaped(STYLE)) }
            }
            body {
                (head(log, run, &title))
                (tiles(log, run))
                @if let Some(told) = &run.failure { (failure(told, run)) }
                (drawings(run))
                (commands(run))
                (pictures(run))
                (paths(run))
                (lines(run))
                (about(log))
            }
        }
    };
    shown(&page.into_string()).into_owned()
}

fn head(log: &Log, run: &Run, title: &str) -> Markup {
    let end = log.end.as_ref().and_then(|end| end.get("result")).map_or("the log has no end", String::as_str);
    let (class, word) = match (&run.account, end) {
        (None, "finished") => ("badge good", "finished"),
        (None, _) if log.complete => ("badge", "stopped"),
        (None, _) => ("badge bad", "broken off"),
        (Some(_), _) => ("badge bad", "failed"),
    };
    html! {
        header {
            h1 { (title) }
            span class=(class) { (word) }
            div.sub { @if end != word { (end) } }
        }
    }
}

/// The most important numbers, at the top of the page.
fn tiles(log: &Log, run: &Run) -> Markup {
    let seconds = run.ticks.last().copied().unwrap_or_default() as f64 * TICK_S;
    let most = |values: &[f64]| values.iter().copied().fold(0.0, f64::max);
    let faults: u64 = run.link_faults.iter().map(|count| u64::from(*count)).sum();
    let over = |value: f64, limit: f64| if value > limit * 1.0005 { "tile bad" } else { "tile" };
    let (speed, turning) = (most(&run.speed), most(&run.turning));
    let commands = &run.chronicle.commands;
    let finished = commands.iter().filter(|command| command.status == "finished").count();
    let digest = log.end.as_ref().and_then(|end| end.get("digest")).cloned().unwrap_or_default();
    let mut tiles = vec![
        ("tile", duration(seconds), amount(run.ticks.len(), "tick")),
        ("tile", format!("{finished} of {}", commands.len()), "commands finished".to_owned()),
        (
            over(speed, SPEED_LIMIT),
            format!("{speed:.1} in/s"),
            format!("top speed, limit {SPEED_LIMIT} in/s"),
        ),
        (
            over(turning, TURNING_LIMIT),
            format!("{turning:.2} rad/s"),
            format!("top turning, limit {TURNING_LIMIT}"),
        ),
        ("tile", faults.to_string(), "faults and re-starts of the link".to_owned()),
        ("tile", run.lines.len().to_string(), "warnings and errors".to_owned()),
    ];
    if !run.controller.is_empty() {
        let mut sorted = run.controller.clone();
        sorted.sort_by(f64::total_cmp);
        let p99 = sorted.get((sorted.len() - 1) * 99 / 100).copied().unwrap_or_default();
        let text = format!("controller, 99 of 100 ticks; {}", amount(run.overruns, "overrun"));
        tiles.push((over(p99, CONTROLLER_LIMIT), format!("{p99:.1} µs"), text));
    }
    tiles.push(("tile long", digest, "digest of all output buffers".to_owned()));
    html! {
        div.tiles {
            @for (class, value, text) in &tiles {
                div class=(class) { b { (value) } span { (text) } }
            }
        }
    }
}

/// `22 min 13 s`.
fn duration(seconds: f64) -> String {
    let whole = seconds.round() as u64;
    if whole < 60 { format!("{seconds:.1} s") } else { format!("{} min {:02} s", whole / 60, whole % 60) }
}

/// Time of a tick, s.
fn seconds(tick: u64) -> f64 {
    tick as f64 * TICK_S
}

fn failure(told: &Told, run: &Run) -> Markup {
    let story = &told.story;
    let seen = run.pictures.iter().filter(|picture| picture.tick == story.tick);
    html! {
        section.failure {
            h2 { "Why it failed" }
            p { "Tick " (story.tick) " (" (format_args!("{:.2}", seconds(story.tick))) " s): " (story.text) "." }
            @for picture in seen.take(1) {
                div.gallery {
                    (figure(picture))
                    @for (what, svg) in &picture.near {
                        figure { (PreEscaped(svg)) figcaption { (what) } }
                    }
                }
            }
            p { b { "First cause:" } " " (story.first_cause) "." }
            (links("The commands that led there", &story.commands))
            (links("From the failure to its cause, each because of the next", &story.causes))
            @if !story.evidence.is_empty() {
                h3 { "What was sensed while it tried" }
                ol { @for line in &story.evidence { li { (line) } } }
            }
            (links("What followed", &story.consequences))
        }
    }
}

fn links(title: &str, links: &[Link]) -> Markup {
    html! {
        @if !links.is_empty() {
            h3 { (title) }
            ol {
                @for Link { tick, process, text } in links {
                    li { b { "tick " (tick) } (process) " " (text) }
                }
            }
        }
    }
}

fn commands(run: &Run) -> Markup {
    html! {
        section {
            h2 { "Commands of the workstation controller" }
            div.wide { table {
                thead { tr { th.n { "tick" } th.n { "at, s" } th.n { "for, s" } th { "end" } th { "command" } } }
                tbody {
                    @for command in &run.chronicle.commands {
                        @let class = match command.status.as_str() {
                            "finished" => "good-text",
                            "error" => "bad-text",
                            _ => "",
                        };
                        @let length = seconds(command.last_tick - command.first_tick + 1);
                        tr {
                            td.n { (command.first_tick) }
                            td.n { (format_args!("{:.1}", seconds(command.first_tick))) }
                            td.n { (format_args!("{length:.1}")) }
                            td class=(class) { (command.status) (command.remark()) }
                            td { (command.text) }
                        }
                    }
                }
            } }
        }
    }
}

fn drawings(run: &Run) -> Markup {
    let (Some(first), Some(last)) = (run.ticks.first(), run.ticks.last()) else { return html! {} };
    let axis = TimeAxis::new(*first, *last);
    let marks: Vec<Mark> = run
        .lines
        .iter()
        .map(|(tick, level, _, text)| Mark { tick: tick.0, error: *level == Level::Error, text })
        .collect();
    let link: Vec<(&str, Vec<Stretch>)> = vec![("Link", run.link.clone())];
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
    html! {
        section {
            h2 { "Commands by level" }
            div.wide { (lanes(&run.lanes, &marks, axis)) (lanes(&link, &[], axis)) (scale(axis)) }
        }
        section {
            h2 { "Motion, forces, link and time" }
            div.wide {
                @for each in &curves { (curve(each, &run.ticks, axis)) }
                (scale(axis))
            }
            @if run.controller.is_empty() {
                p.sub {
                    "A run in fast clock has no times of the controller in its log: the same run writes the same bytes."
                }
            }
        }
    }
}

fn pictures(run: &Run) -> Markup {
    html! {
        @if !run.pictures.is_empty() {
            section {
                h2 { "The cell where commands begin, and at the end" }
                div.gallery { @for picture in &run.pictures { (figure(picture)) } }
            }
        }
    }
}

fn figure(picture: &Picture) -> Markup {
    html! {
        figure {
            (PreEscaped(&picture.svg))
            figcaption { b { (format_args!("{:.1} s", seconds(picture.tick))) } " · " (picture.text) }
        }
    }
}

fn paths(run: &Run) -> Markup {
    let at = |tick: u64| run.ticks.binary_search(&tick).ok().and_then(|at| run.path.get(at)).copied();
    let stops: Vec<[f64; 3]> =
        run.chronicle.commands.iter().filter_map(|command| at(command.last_tick)).collect();
    let closest = run.clearance.as_ref();
    let ring = closest.and_then(|clearance| Some((at(clearance.tick)?, clearance.text.as_str())));
    html! {
        section {
            h2 { "Path of the tool point" }
            div.pair {
                (path(
                    "From above: +X (machine tool) to the right, +Y up. Dots: where commands ended.",
                    &run.path,
                    &stops,
                    ring,
                    |p| [p[0], p[1]],
                ))
                (path(
                    "From the side: distance from the base axis to the right, +Z up.",
                    &run.path,
                    &stops,
                    ring,
                    |p| [p[0].hypot(p[1]), p[2]],
                ))
            }
            @if let Some(clearance) = closest {
                p { span.key {} "Closest clearance: " (clearance.text) "." }
            }
        }
    }
}

fn lines(run: &Run) -> Markup {
    html! {
        section {
            h2 { "Warnings and errors" }
            @if run.lines.is_empty() {
                p { "None among the " (run.all_lines) " lines of the log." }
            } @else {
                div.wide { table {
                    thead { tr { th.n { "tick" } th {} th { "source" } th { "message" } } }
                    tbody {
                        @for (tick, level, source, text) in &run.lines {
                            @let (class, word) =
                                if *level == Level::Error { ("bad-text", "error") } else { ("warn-text", "warning") };
                            tr {
                                td.n { (tick.0) }
                                td class=(class) { (word) }
                                td { (source) }
                                td { (text) }
                            }
                        }
                    }
                } }
            }
        }
    }
}

/// The data needed to repeat the run, and the facts that the run recorded.
fn about(log: &Log) -> Markup {
    let end = log.end.iter().flatten().filter(|(key, _)| !key.starts_with("lost_"));
    let entries = log.run.iter().chain(end).filter(|(_, value)| !value.is_empty());
    let names: Vec<&str> = log.attachments.iter().map(|attachment| attachment.name.as_str()).collect();
    html! {
        section {
            h2 { "The run" }
            div.wide { table { tbody {
                @for (key, value) in entries {
                    tr { th { (key.replace('_', " ")) } td.mono { (value) } }
                }
                tr { th { "attached files" } td.mono { (names.join(", ")) } }
            } } }
        }
    }
}
