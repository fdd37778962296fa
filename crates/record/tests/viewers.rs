//! Channels for viewers: states of the run, and the layout for Foxglove and Lichtblick, which refers only to
//! data of a log.

use std::{fs, path::Path};

use interfaces::{CommonMemory, ExternalInputs};
use prost::Message as _;
use prost_types::{DescriptorProto, FileDescriptorSet, field_descriptor_proto::Type};
use rcs_core::tick::Tick;
use record::{
    CellFrame, CellModel, End, Epoch, Link, Pace, Recorder, Setup, Shown,
    views::{Changes, JOB_STATE, JobState, View},
};
use serde_json::Value;

fn log() -> Vec<u8> {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("run.mcap");
    let links = vec![Link { name: "quick_change".into(), parent: "world".into() }];
    let cell = Some(CellModel { links, ..CellModel::default() });
    let setup = Setup { epoch: Epoch::Fixed, cell, ..Setup::default() };
    let mut recorder = Recorder::start(&path, Pace::Wait, setup).unwrap();
    recorder.cell(&CellFrame::new(Tick(1)));
    let (external, memory) = (ExternalInputs::default(), CommonMemory::default());
    recorder.tick(Tick(1), &external, &memory, Default::default);
    recorder.finish(End::default()).unwrap();
    fs::read(path).unwrap()
}

/// All message types of a set, by their names without the package.
fn messages(set: &FileDescriptorSet) -> impl Iterator<Item = &DescriptorProto> {
    set.file.iter().flat_map(|file| &file.message_type)
}

/// True if a message type of a set has the field that a path such as `.pose.x` or `.position[0]` leads to.
fn has_field(set: &FileDescriptorSet, message: &str, path: &str) -> bool {
    let simple = |name: &str| name.rsplit('.').next().unwrap_or_default().to_owned();
    let mut message = messages(set).find(|m| m.name() == simple(message));
    path.split('.').filter(|part| !part.is_empty()).all(|part| {
        let name = part.split('[').next().unwrap_or_default();
        let field = message.and_then(|m| m.field.iter().find(|f| f.name() == name));
        message = field
            .filter(|f| f.r#type() == Type::Message)
            .and_then(|f| messages(set).find(|m| m.name() == simple(f.type_name())));
        field.is_some()
    })
}

fn frames(log: &[u8]) -> Vec<String> {
    let messages = mcap::MessageStream::new(log).unwrap().map(Result::unwrap);
    let moving = messages.filter(|message| message.channel.topic == "/tf");
    let links = moving.flat_map(|message| record::proto::foxglove::take_transforms(&message.data));
    links.flat_map(|(link, _)| [link.parent, link.name]).collect()
}

/// Paths, topics, frames and panels that a part of a layout names.
fn named<'v>(value: &'v Value, found: &mut Vec<(&'v str, &'v str)>) {
    match value {
        Value::Object(map) => {
            for (key, value) in map {
                match (key.as_str(), value) {
                    (
                        "value" | "topicToRender" | "topicPath" | "imageTopic" | "followTf" | "first"
                        | "second" | "layout",
                        Value::String(text),
                    ) => found.push((key, text)),
                    ("topics", Value::Object(topics)) => {
                        found.extend(topics.keys().map(|t| ("topic", t.as_str())))
                    }
                    _ => named(value, found),
                }
            }
        }
        Value::Array(list) => list.iter().for_each(|value| named(value, found)),
        _ => {}
    }
}

#[test]
fn foxglove_layout_names_existing_channels_and_fields() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../viewers/foxglove.json");
    let layout: Value = serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap();
    let log = log();
    let summary = mcap::Summary::read(&log).unwrap().unwrap();
    let frames = frames(&log);
    let mut names = Vec::new();
    named(&layout, &mut names);
    let mut panels = 0;
    for (key, name) in &names {
        if matches!(*key, "first" | "second" | "layout") {
            assert!(layout["configById"].get(name).is_some(), "the panel {name} has no settings");
            panels += 1;
            continue;
        }
        if *key == "followTf" {
            assert!(frames.iter().any(|frame| frame == name), "no frame {name} among {frames:?}");
            continue;
        }
        let (topic, field) = name.find('.').map_or((*name, ""), |dot| name.split_at(dot));
        let channel = summary.channels.values().find(|channel| channel.topic == topic);
        let schema = channel.unwrap_or_else(|| panic!("no channel {topic}")).schema.as_ref().unwrap();
        if schema.encoding == "protobuf" {
            let set = FileDescriptorSet::decode(&*schema.data).unwrap();
            assert!(has_field(&set, &schema.name, field), "{name} is not a field of {}", schema.name);
        } else {
            let text = String::from_utf8_lossy(&schema.data);
            let field = field.trim_start_matches('.').split('[').next().unwrap_or_default();
            let has = text.lines().any(|line| line.split_whitespace().nth(1) == Some(field));
            assert!(field.is_empty() || has, "{name} is not a field of {text}");
        }
    }
    assert_eq!(panels, layout["configById"].as_object().unwrap().len(), "each panel has its place");
    assert!(names.len() > 20);
}

fn ticks(log: &[u8], topic: &str) -> Vec<u32> {
    let messages = mcap::MessageStream::new(log).unwrap().map(Result::unwrap);
    messages.filter(|message| message.channel.topic == topic).map(|message| message.sequence).collect()
}

#[test]
fn states_are_logged_on_change_and_in_the_last_tick() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("run.mcap");
    let mut recorder = Recorder::start(&path, Pace::Wait, Setup::default()).unwrap();
    let job = |index, text: &str, is_command| {
        let state = JobState { index, lines: 2, text: text.into(), is_command, ..JobState::default() };
        Shown::View(View::JobState(JobState { began: u64::from(index) * 5, ..state }))
    };
    let (external, memory) = (ExternalInputs::default(), CommonMemory::default());
    for tick in (1..=30).map(Tick) {
        match tick.0 {
            3 => recorder.show(tick, job(1, "** vise open PFIXTURE", false)),
            7 => recorder.show(tick, job(2, "== PAUSE", true)),
            _ => {}
        }
        recorder.tick(tick, &external, &memory, Default::default);
    }
    recorder.show(Tick(31), job(2, "== PAUSE", true));
    recorder.finish(End::default()).unwrap();
    let log = fs::read(&path).unwrap();
    assert_eq!(ticks(&log, JOB_STATE), [3, 7, 31], "the last one is newer than the last tick");
    for topic in ["/task/status", "/task/row", "/ladder", "/instruments"] {
        assert_eq!(ticks(&log, topic), [1, 30], "{topic}");
    }
    let log = record::Log::open(&path).unwrap();
    let changes = Changes::<JobState>::of(&log);
    let index = |tick| changes.at(Tick(tick)).map(|state| state.index);
    assert_eq!(
        [index(2), index(3), index(6), index(7), index(31)],
        [None, Some(1), Some(1), Some(2), Some(2)]
    );
    assert_eq!(changes.last().map(|state| state.text.as_str()), Some("== PAUSE"));
    let lines: Vec<_> = log.lines().map(|line| (line.tick, line.text)).collect();
    assert_eq!(lines, [(Tick(3), "line 1 of 2: ** vise open PFIXTURE".to_owned())]);
}
