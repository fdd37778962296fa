//! The status to the workstation controller (V.4.2). Additional fields are CHOSEN, such as the echo of the number and
//! a word for failure. A refused mailgram changes no field before `verdict`: they describe Task's command.

use interfaces::{
    Detail, Reason, Unconfirmed,
    hws::{HwsReport, HwsStatus},
};
use rcs_core::{Plain, name::Name16};

use super::Refusal;
use crate::{
    fields::{FieldError, command_number},
    layout::{At, Chars, Codec, Coded, LayoutError, Sentence, Spelled, Text, U16, Unused, Width},
};

pub const REASON: usize = 160; // bytes

/// The field `task-state`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum TaskState {
    /// Task runs.
    Runs,
    /// Task's switch on the joystick box holds Task (III.3.3), which then does not read its commands.
    Held,
    /// Task did not run in the last tick.
    Lost,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Status<'a> {
    pub command: Name16,   // `"command-echo"`
    pub report: HwsReport, // `"status"`
    pub echo: u16,         // `command-#-echo`
    pub mailgram_echo: u16,
    pub verdict: u16, // 0: the mailgram was accepted
    pub code: Reason, // `status-code`
    pub task: TaskState,
    pub unconfirmed: Unconfirmed,
    pub reason: &'a str,
}

crate::layout! {
    /// The status to the workstation controller.
    StatusLayout: Status<'_> = "a status";
    "fdbf>w"               ()               Unused<4>,     "blanks";
    "echo>w"               ()               Unused<16>,    "blanks";
    "status-length>w"      ()               Length,        "238";
    "time-stamp-status>w"  ()               Unused<12>,    "blanks";
    "command-echo"         (command)        Chars<16>,     "Task's present command";
    "status"               (report)         Spelled<16>,
        "executing, finished; CHOSEN: also idle, error, joystick-on";
    "command-#-echo"       (echo)           U16,           "CHOSEN: number of the command that `status` reports";
    "mailgram-echo"        (mailgram_echo)  U16,
        "CHOSEN: mailgram number of the command mailbox that was read last";
    "verdict"              (verdict)        U16,
        "CHOSEN: 0 accepted; refused: 1 not a command, 2 the number belongs to another command, 3 another number is \
         next";
    "status-code"          (code)           Coded<2>,
        "CHOSEN: why the command failed, 0 if it did not: [its code](reasons.md)";
    "task-state"           (task)           Coded<2>,
        "CHOSEN: 0 Task runs, 1 its switch on the joystick box holds it (III.3.3), 2 it is lost";
    "unconfirmed"          (unconfirmed)    Coded<2>,
        "CHOSEN: with finished, the condition that no sensor confirms: 0 none, 1 the grasp force, 2 the tool in the \
         drum, 3 the robot's position, 4 the part's place in the fingers";
    "reason"               (reason)         Text<REASON>,
        "CHOSEN: the reason of a refused mailgram; else the error in the command, the reason of its failure with \
         names and distances, or the unconfirmed condition";
}

#[derive(Clone, Copy, Debug)]
struct Length; // `status-length>w`; decoding ignores it

impl Width for Length {
    const BYTES: usize = 2;
}

impl Codec<'_, ()> for Length {
    fn put((): &(), to: &mut [u8]) {
        U16::put(&u16::try_from(StatusLayout::BYTES).unwrap_or_default(), to);
    }

    fn take(_: At, _: &[u8]) -> Result<(), FieldError> {
        Ok(())
    }
}

#[derive(Clone, Copy, Debug)]
pub enum Why<'a> {
    Mailgram(&'a Refusal),
    Command(&'a str), // it fails its check
    Reason(Detail),   // with names and distances
}

#[must_use]
pub fn encode(
    status: &HwsStatus,
    why: Why<'_>,
    task: TaskState,
    mailgram_echo: u16,
) -> [u8; StatusLayout::BYTES] {
    let (reason, unconfirmed) = (status.reason.text(), status.unconfirmed);
    let sentence = match why {
        Why::Mailgram(refused) => Sentence::<REASON>::of(refused),
        Why::Command(wrong) => Sentence::of(&wrong),
        Why::Reason(_) if reason.is_empty() && !unconfirmed.is_none() => {
            Sentence::of(&format_args!("unconfirmed: {unconfirmed}"))
        }
        Why::Reason(detail) => Sentence::of(&format_args!("{reason}{detail:#}")),
    };
    StatusLayout::encode(&Status {
        command: status.command,
        report: status.report,
        echo: command_number(status.echo),
        mailgram_echo,
        verdict: if let Why::Mailgram(refused) = why { refused.code() } else { 0 },
        code: status.reason,
        task,
        unconfirmed: status.unconfirmed,
        reason: sentence.as_str(),
    })
}

pub fn decode(bytes: &[u8]) -> Result<Status<'_>, LayoutError> {
    StatusLayout::decode(bytes)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use rcs_core::name::Name10;

    use super::*;

    fn failed() -> HwsStatus {
        HwsStatus {
            echo: 7,
            command: Name16::new("TRANSFER").unwrap(),
            report: HwsReport::Error,
            reason: Reason::GraspMissed,
            unconfirmed: Unconfirmed::None,
        }
    }

    #[test]
    fn every_field_is_at_its_byte() {
        let expected = [
            &[b' '; 20][..],
            b"\xEE\x00            TRANSFER        error           ",
            b"\x07\x00\x09\x00\x00\x00",
            &[Reason::GraspMissed.code(), 0, 1, 0, 0, 0],
            format!("{:160}", "the fingers closed on nothing").as_bytes(),
        ]
        .concat();
        let bytes = encode(&failed(), Why::Reason(Detail::None), TaskState::Held, 9);
        assert_eq!(bytes, &expected[..]);
        let status = decode(&bytes).unwrap();
        assert_eq!((status.echo, status.report, status.code), (7, HwsReport::Error, Reason::GraspMissed));
        assert_eq!((status.mailgram_echo, status.verdict, status.task), (9, 0, TaskState::Held));
        assert_eq!(status.reason, "the fingers closed on nothing");
    }

    #[test]
    fn every_report_and_reason_round_trips() {
        for &report in HwsReport::ALL {
            for &reason in Reason::ALL {
                let failed = HwsStatus { report, reason, ..failed() };
                let bytes = encode(&failed, Why::Reason(Detail::None), TaskState::Lost, 0);
                let status = decode(&bytes).unwrap();
                assert_eq!((status.report, status.code, status.reason), (report, reason, reason.text()));
            }
        }
    }

    #[test]
    fn reason_text_has_names_but_no_remedy() {
        let detail = Detail::Pair(Name10::clipped("BENCH"), Name16::clipped("VISE"));
        let failed = HwsStatus { reason: Reason::NoTrajectory, ..failed() };
        let bytes = encode(&failed, Why::Reason(detail), TaskState::Runs, 0);
        let told = format!("{}: none leads from BENCH to VISE", Reason::NoTrajectory.text());
        assert_eq!(decode(&bytes).unwrap().reason, told);
    }

    #[test]
    fn a_finished_command_lists_unconfirmed_goals() {
        for &unconfirmed in Unconfirmed::ALL {
            let finished =
                HwsStatus { report: HwsReport::Finished, reason: Reason::None, unconfirmed, ..failed() };
            let bytes = encode(&finished, Why::Reason(Detail::None), TaskState::Runs, 0);
            let status = decode(&bytes).unwrap();
            let text = match unconfirmed {
                Unconfirmed::None => String::new(),
                what => format!("unconfirmed: {what}"),
            };
            assert_eq!((status.unconfirmed, status.reason), (unconfirmed, text.as_str()));
        }
    }

    proptest! {
        #[test]
        fn no_bytes_panic(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
            let _ = decode(&bytes);
        }
    }
}
