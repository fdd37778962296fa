//! Groups of values: the show words of IV.2.6, the vocabularies of IV.2.5, and the watched fields (VI.6.1).

use interfaces::ProcessId;
use os_io::text::amount;

use super::{Section, Text, Tone, buffers};
use crate::rcs_console::picture::Picture;

/// A show word (IV.2.6) with its board, subject and buffers.
#[derive(Debug)]
pub struct ShowWord {
    pub word: &'static str,
    /// The board on whose terminal the word is known.
    pub board: u8,
    pub about: &'static str,
    pub buffers: &'static [&'static str],
}

pub static SHOW_WORDS: [ShowWord; 5] = [
    ShowWord {
        word: "TAI",
        board: 6,
        about: "Task: command from the HWSC, and status to it",
        buffers: &["hws", "task.status"],
    },
    ShowWord {
        word: "TAO",
        board: 6,
        about: "Task: command to Subtask, and status from it",
        buffers: &["task.subtask", "subtask.status"],
    },
    ShowWord {
        word: "SB",
        board: 6,
        about: "Subtask: its interfaces to Task and E-move",
        buffers: &["task.subtask", "subtask.status", "subtask.emove", "emove.status"],
    },
    ShowWord {
        word: "EM",
        board: 2,
        about: "E-move: its interfaces to Subtask and Prim",
        buffers: &["subtask.emove", "emove.status", "emove.prim", "prim.status"],
    },
    ShowWord {
        word: "II",
        board: 2,
        about: "Prim: its interfaces to E-move and T3 Interface",
        buffers: &["emove.prim", "prim.status", "prim.t3i", "t3i.status"],
    },
];

/// The vocabularies (IV.2.5; V to VII) and their processes; `None` for SDEF, which exists on each board, and for FDEF
/// of the task data. That of T3 Interface has no known name (VI.1).
pub static VOCABULARIES: [(&str, Option<ProcessId>); 10] = [
    ("SDEF", None),
    ("TDEF", Some(ProcessId::Task)),
    ("STDEF", Some(ProcessId::Subtask)),
    ("EDEF", Some(ProcessId::Emove)),
    ("PDEF", Some(ProcessId::Prim)),
    ("QDEF", Some(ProcessId::QuickChange)),
    ("GDEF", Some(ProcessId::Grip)),
    ("VDEF", Some(ProcessId::VGrip)),
    ("TGDEF", Some(ProcessId::ToolGrip)),
    ("FDEF", None),
];

/// The manual's names of the interface variables, with their fields here (docs/traceability.md).
static NAMES: &[(&str, &str)] = &[
    ("command-#-in", "hws.number"),
    ("command-16", "hws.command"),
    ("obj", "hws.object"),
    ("obj-serial-#", "hws.serial"),
    ("source-grip-#", "hws.source_grip"),
    ("src-loc-16", "hws.source"),
    ("src-sector#", "hws.source_sector"),
    ("dest-grip-#", "hws.destination_grip"),
    ("dest-loc-16", "hws.destination"),
    ("dest-sector#", "hws.destination_sector"),
    ("end-at-16", "hws.end_at"),
    ("endatsector#", "hws.end_at_sector"),
    ("command-echo", "task.status.command"),
    ("status", "task.status.report"),
    ("command-#-in", "task.subtask.number"),
    ("command-in", "task.subtask.command"),
    ("obj", "task.subtask.object"),
    ("obj-endeff-id#", "task.subtask.end_effector_id"),
    ("src-grip-#-in", "task.subtask.source_grip"),
    ("dst-grip-#-in", "task.subtask.destination_grip"),
    ("obj-para-^", "task.subtask.object_parameters"),
    ("locpt-name-in", "task.subtask.site.location"),
    ("locpt-type-in", "task.subtask.site.kind"),
    ("locpt-^-in", "task.subtask.site.record"),
    ("pose-^-in", "task.subtask.pose"),
    ("command-#-echo", "subtask.status.echo"),
    ("status-report", "subtask.status.report"),
    ("status-para-out", "subtask.status.reason"),
    ("ref-pose-^-out", "subtask.status.reference_pose"),
    ("obj-held-status-out", "subtask.status.held"),
    ("pres-endeff-id#-out", "subtask.status.end_effector_id"),
    ("command-#-in", "subtask.emove.number"),
    ("command-in", "subtask.emove.command"),
    ("obj", "subtask.emove.object"),
    ("obj-para-^", "subtask.emove.object_parameters"),
    ("obj-grip-loc-^", "subtask.emove.object_grips"),
    ("obj-vision-para-^", "subtask.emove.object_vision"),
    ("locpt-name", "subtask.emove.site.location"),
    ("locpt-type", "subtask.emove.site.kind"),
    ("locpt-^-in", "subtask.emove.site.record"),
    ("pose-^-in", "subtask.emove.pose"),
    ("endeff-id#-in", "subtask.emove.end_effector_id"),
    ("command-#-echo-out", "emove.status.echo"),
    ("status-report", "emove.status.report"),
    ("status-para-out", "emove.status.reason"),
    ("ref-pose-^", "emove.status.reference_pose"),
    ("obj-held-status-out", "emove.status.held"),
    ("pres-endeff-id#-out", "emove.status.end_effector_id"),
    ("command-#-in", "emove.prim.number"),
    ("command", "emove.prim.command"),
    ("sensor", "emove.prim.sensor"),
    ("^-pose", "emove.prim.pose"),
    ("^-movtab", "emove.prim.movetable"),
    ("^-traj-para", "emove.prim.trajectory_parameters"),
    ("endeff-id#-in", "emove.prim.end_effector_id"),
    ("command-#-echo", "prim.status.echo"),
    ("status-report", "prim.status.report"),
    ("restart-status", "prim.status.restarting"),
    ("pres-pose-^-out", "prim.status.present_pose"),
    ("sensor-pose-^-out", "prim.status.sensor_pose"),
    ("detected-pose-^-out", "prim.status.detected_pose"),
    ("hol-R-status", "prim.status.holster_right"),
    ("hol-L-status", "prim.status.holster_left"),
    ("hol-C-status", "prim.status.holster_centre"),
    ("joy-grip-status", "prim.status.joystick_grip"),
    ("cycle-cnt-#-in", "prim.t3i.cycle"),
    ("inc-command-#-in", "prim.t3i.number"),
    ("input-command", "prim.t3i.command"),
    ("frame-command-in", "prim.t3i.frame"),
    ("cycle-cnt-#-status-out", "t3i.status.cycle"),
    ("cycle-cnt-#-echo-out", "t3i.status.cycle_echo"),
    ("inc-command-#-echo", "t3i.status.echo"),
    ("input-command-echo", "t3i.status.command"),
    ("status-report", "t3i.status.report"),
    ("status-arg-out", "t3i.status.fault"),
    ("frame-feedback", "t3i.status.frame_feedback"),
    ("scale-factor-out", "t3i.status.scale_factor"),
    ("joint-limit-dummy", "t3i.status.joint_limit"),
    ("command-#-in", "emove.quick_change.number"),
    ("command", "emove.quick_change.command"),
    ("command-#-echo", "quick_change.status.echo"),
    ("status-report", "quick_change.status.report"),
    ("status-para-out", "quick_change.status.reason"),
    ("endeff-id#", "quick_change.status.end_effector_id"),
    ("sincr-cmnd#", "emove.grip.number"),
    ("scommand", "emove.grip.command"),
    ("sforce", "emove.grip.force"),
    ("sposition", "emove.grip.position"),
    ("svelocity", "emove.grip.velocity"),
    ("send-effector", "emove.grip.end_effector_id"),
    ("incr-cmnd#-echo", "grip.status.echo"),
    ("status", "grip.status.report"),
    ("initialized-?", "grip.status.initialized"),
    ("pos", "grip.status.position"),
    ("l-force", "grip.status.left_force"),
    ("r-force", "grip.status.right_force"),
    ("vel", "grip.status.velocity"),
    ("finger-hgt", "grip.status.finger_height"),
    ("grip", "grip.status.valves"),
    ("command-#-in", "emove.v_grip.number"),
    ("command", "emove.v_grip.command"),
    ("commanded-force", "emove.v_grip.force"),
    ("commanded-size", "emove.v_grip.size"),
    ("commanded-vel", "emove.v_grip.velocity"),
    ("endeff-id", "emove.v_grip.end_effector_id"),
    ("command-#-echo", "v_grip.status.echo"),
    ("status-report", "v_grip.status.report"),
    ("status-para-out", "v_grip.status.reason"),
    ("vgrip-size", "v_grip.status.size"),
    ("vgrip-left-force", "v_grip.status.left_force"),
    ("vgrip-right-force", "v_grip.status.right_force"),
    ("vgrip-vel", "v_grip.status.velocity"),
    ("cycle-cnt", "subtask.pedestal.cycle"),
    ("incr-cmnd#", "subtask.pedestal.number"),
    ("command", "subtask.pedestal.command"),
    ("grasp-size", "subtask.pedestal.grasp_size"),
    ("grasp-force", "subtask.pedestal.grasp_force"),
    ("table-angle", "subtask.pedestal.table_angle"),
    ("cycle-cnt-echo", "pedestal.status.cycle_echo"),
    ("incr-cmnd#-echo", "pedestal.status.echo"),
    ("status", "pedestal.status.report"),
    ("status-code", "pedestal.status.reason"),
    ("grip-size", "pedestal.status.grip_size"),
    ("grip-force", "pedestal.status.grip_force"),
    ("table-position", "pedestal.status.table_position"),
    ("ITEM-NAME", "task.data_base.item"),
    ("ITEM#", "task.data_base.serial"),
    ("STORAGE-POS", "task.data_base.position"),
    ("SECTOR#", "task.data_base.sector"),
];

#[must_use]
pub fn manual_name(path: &str) -> Option<&'static str> {
    NAMES.iter().find(|(_, field)| buffers::is_within(path, field)).map(|(name, _)| *name)
}

/// The fields with a name: the manual's name, or the end of a field's path.
#[must_use]
pub fn fields_named(name: &str, among: &[&str]) -> Vec<&'static str> {
    let plain = name.trim_matches('"').to_lowercase();
    let is_among =
        |path: &str| among.is_empty() || among.iter().any(|buffer| buffers::is_within(path, buffer));
    let named =
        NAMES.iter().filter(|(manual, path)| *manual == plain && is_among(path)).map(|(_, path)| *path);
    let end = plain.replace('-', "_");
    let own = buffers::paths().filter(|path| {
        let rest = path.strip_suffix(end.as_str());
        is_among(path) && rest.is_some_and(|rest| rest.is_empty() || rest.ends_with('.'))
    });
    let mut found: Vec<_> = named.collect();
    if found.is_empty() {
        found = own.collect();
    }
    found
}

/// The values of buffers or fields, with the manual's names where they exist.
#[must_use]
pub fn lines(of: &[&str], picture: &Picture, last: Option<&Picture>) -> Vec<Text> {
    let found = buffers::under(of, picture, last);
    found
        .into_iter()
        .map(|field| {
            let name = manual_name(&field.name).unwrap_or_default();
            let (mark, tone) = if field.changed { ('>', Tone::Marked) } else { (' ', Tone::Plain) };
            let value = format!("{} {}", field.value, field.unit);
            Text::verbatim(tone, format!("{mark} {name:<22} {:<32} {}", field.name, value.trim_end()))
        })
        .collect()
}

#[must_use]
pub fn watched(watch: &[String], picture: &Picture, last: Option<&Picture>) -> Section {
    let of: Vec<&str> = watch.iter().map(String::as_str).collect();
    let mut lines = lines(&of, picture, last);
    if watch.is_empty() {
        lines.push(Text::new(Tone::Faint, "  w adds a field or a buffer, as task.status or t3i.status.echo"));
    }
    Section::new(format!("watched, {}", amount(lines.len() - usize::from(watch.is_empty()), "field")), lines)
}

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::{CommonMemory, ExternalInputs};
    use rcs_core::tick::Tick;

    #[test]
    fn every_manual_name_matches_a_field() {
        for (name, path) in NAMES {
            assert!(buffers::paths().any(|field| buffers::is_within(field, path)), "{name}: {path}");
        }
        for word in &SHOW_WORDS {
            for buffer in word.buffers {
                assert!(buffers::paths().any(|field| buffers::is_within(field, buffer)), "{buffer}");
            }
        }
    }

    #[test]
    fn name_search_covers_the_given_buffers() {
        assert_eq!(fields_named("command-#-in", &["hws"]), ["hws.number"]);
        assert_eq!(fields_named("\"command-in\"", &["subtask.emove"]), ["subtask.emove.command"]);
        assert!(fields_named("number", &["task.subtask"]).contains(&"task.subtask.number"));
        assert!(fields_named("no-such-name", &[]).is_empty());
    }

    #[test]
    fn show_word_uses_the_names_of_the_manual() {
        let (external, memory) = (ExternalInputs::default(), CommonMemory::default());
        let picture = Picture { tick: Tick(1), external, memory, timing: None };
        let said: Vec<String> =
            lines(SHOW_WORDS[0].buffers, &picture, None).into_iter().map(|line| line.text).collect();
        for name in ["command-#-in", "src-loc-16", "endatsector#", "command-echo"] {
            assert!(said.iter().any(|line| line.contains(name)), "{name}: {said:#?}");
        }
        assert!(watched(&[], &picture, None).lines[0].text.contains("w adds"));
        assert_eq!(watched(&["t3i.status.echo".to_owned()], &picture, None).lines.len(), 1);
    }
}
