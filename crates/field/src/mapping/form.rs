//! The keys of a mapping file.

use std::collections::BTreeMap;

use serde::Deserialize;

use crate::scale::Format;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Sheet {
    pub form: u32,
    #[serde(default)]
    pub name: String,
    pub device: BTreeMap<String, DeviceForm>,
    #[serde(default, rename = "in")]
    pub inputs: BTreeMap<String, InForm>,
    #[serde(default, rename = "out")]
    pub outputs: BTreeMap<String, OutForm>,
    #[serde(default)]
    pub groups: BTreeMap<String, String>,
    #[serde(default)]
    pub holds: BTreeMap<String, String>,
    #[serde(default)]
    pub line: Vec<SequenceForm>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct DeviceForm {
    pub address: String,
    pub unit: u8,
    pub kind: String,
    pub fallback: String,
    pub watchdog_ms: Option<u16>,
    pub alive: Option<String>,
    #[serde(default = "exchange_ms")]
    pub exchange_ms: u16,
    #[serde(default = "timeout_ms")]
    pub timeout_ms: u16,
}

/// Two exchanges in a tick of 40 ms.
const fn exchange_ms() -> u16 {
    20
}

/// A later answer would delay the next exchange.
const fn timeout_ms() -> u16 {
    15
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct InForm {
    pub at: Option<String>,
    pub fixed: Option<i64>,
    #[serde(rename = "type")]
    pub format: Option<Format>,
    pub words: Option<String>,
    pub raw: Option<[f64; 2]>,
    pub counts: Option<[f64; 2]>,
    #[serde(default)]
    pub invert: bool,
    #[serde(default = "stale_ms")]
    pub stale_ms: u16,
    pub then: Option<i64>,
    #[serde(default)]
    pub by_gripper: BTreeMap<String, LineForm>,
}

/// Two ticks and a half.
const fn stale_ms() -> u16 {
    100
}

#[derive(Clone, Copy, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct LineForm {
    pub raw: [f64; 2],
    pub counts: [f64; 2],
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct OutForm {
    pub at: String,
    #[serde(rename = "type")]
    pub format: Option<Format>,
    pub words: Option<String>,
    #[serde(default)]
    pub invert: bool,
    pub safe: i64,
    #[serde(default)]
    pub rest: bool,
}

/// A `[[line]]`: how the devices execute a line of a job.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SequenceForm {
    pub line: String,
    pub ask: Option<String>,
    #[serde(default)]
    pub needs: Vec<String>,
    #[serde(default)]
    pub sets: BTreeMap<String, i64>,
    #[serde(default)]
    pub begun: Vec<String>,
    #[serde(default = "begun_within_s")]
    pub begun_within_s: u16,
    pub done: Vec<String>,
    #[serde(default, rename = "while")]
    pub during: Vec<String>,
    #[serde(default)]
    pub fault: Vec<String>,
    pub within_s: u16,
    #[serde(default)]
    pub then: BTreeMap<String, i64>,
}

const fn begun_within_s() -> u16 {
    5
}
