//! The verdict on a command before Task reads it, for all sources of commands: the job, an operator, the mailbox of a
//! workstation controller.
//!
//! A command passes if the task data have all that it needs ([`Verdict`]), and `check` has found no error in its
//! records, which `--unchecked` permits. PAUSE always passes.

use closed_loop::{JobPlayer, generations::Generations, workstation::SimulatedWorkstation};
use diagnostics::{DataGroup, Group, grouped};
use interfaces::{CommonMemory, HwsCommand, emove::Holding};
use neighbours::{
    mailbox::Mailbox,
    workstation::{Gate, Judge, Refusal, player::Progress},
};
use paths::{
    finding::Finding,
    holster::{lacking, wanted},
    job::{WalkedJob, walk_job_once},
    uses::{Present, used},
};
use plant::{CellDescription, room::Room};
use rcs_core::tick::Tick;
use taskdata::load::{
    At, Fault, Job, Step, Store, Workstation,
    verdict::{Before, Verdict, in_words},
};

use crate::{error::StartError, event::Event};

#[derive(Clone, Copy)]
pub struct CommandJudge<'a> {
    pub generations: &'a Generations,
    /// Number of the first reload that the job has requested in this tick.
    pub load: Option<u32>,
    pub memory: &'a CommonMemory,
    /// Ignore errors in the records that a command uses.
    pub unchecked: bool,
}

impl Judge for CommandJudge<'_> {
    fn verdict(&self, command: &HwsCommand) -> Option<String> {
        verdict(command, self.store(), &present(self.memory), self.unchecked)
    }
}

/// The error in a command of a robot at `present`, as a sentence. `unchecked` ignores errors in its records.
#[must_use]
pub fn verdict(command: &HwsCommand, store: &Store, present: &Present, unchecked: bool) -> Option<String> {
    let verdict = Verdict::of(command, &store.view(), Before::unknown());
    if !verdict.passes() {
        return Some(in_words(&verdict.findings));
    }
    if unchecked {
        return None;
    }
    let data = store.view();
    let wanted = wanted(command, present.gripper, &data);
    let lacking = wanted.and_then(|wanted| lacking(present.gripper, wanted, &data));
    let of_data = || match store.faults().next() {
        None => None,
        Some(_) => of_faults(&store.faults_of(command, &used(command, store, present))),
    };
    lacking.map(|lacking| lacking.to_string()).or_else(of_data)
}

impl<'a> CommandJudge<'a> {
    /// The task data that Task uses for a command that is sent now.
    #[must_use]
    pub fn store(&self) -> &'a Store {
        self.generations.next(self.memory, self.load)
    }
}

/// State of the robot before a command, according to the buffers of a tick.
#[must_use]
pub fn present(memory: &CommonMemory) -> Present {
    let status = &memory.subtask.status;
    Present {
        place: memory.emove.estimates.place.unwrap_or_default(),
        gripper: status.end_effector_id,
        held: match status.held {
            Holding::Object(held) => Some((held.object, held.grip)),
            Holding::Nothing | Holding::Something | Holding::NotKnown => None,
        },
    }
}

/// Read the command mailbox. Returns `Some` if the mailgram is refused.
pub fn read_command(
    gate: &mut Gate,
    command_box: &Mailbox,
    judge: &CommandJudge<'_>,
    events: &mut Vec<Event>,
) -> Option<Refusal> {
    let before = gate.command().number;
    let refused = gate.read(command_box, judge);
    if let Some(wrong) = gate.wrong().filter(|_| gate.command().number != before) {
        events.push(Event::CommandFailsCheck(wrong.to_owned()));
    }
    refused
}

/// Called once per tick. A job reads its status and writes its command, which is then read from its mailbox.
pub fn play(
    job: &mut JobPlayer,
    tick: Tick,
    gate: &mut Gate,
    workstation: &mut SimulatedWorkstation,
    judge: &CommandJudge<'_>,
    events: &mut Vec<Event>,
) -> Progress {
    let before = job.hwsc.retried().len();
    let progress = job.write(tick, gate, workstation);
    events.extend(job.hwsc.retried().iter().skip(before).cloned().map(Event::Retries));
    let judge = CommandJudge { load: workstation.first_load(), ..*judge };
    read_command(gate, job.command_box(), &judge, events);
    progress
}

fn of_faults(faults: &[&Fault]) -> Option<String> {
    let (first, others) = faults.split_first()?;
    let more = match others.len() {
        0 => String::new(),
        1 => "; 1 more error in the data that it uses".to_owned(),
        count => format!("; {count} more errors in the data that it uses"),
    };
    Some(format!("{}{more}", first.in_line()))
}

/// Find the errors in the paths of a job. Each becomes an error of the record that is probably wrong, so that no
/// command uses it.
pub fn add_paths(store: &mut Store, job: &mut Job, cell: &CellDescription) -> WalkedJob {
    let walked = walk_job_once(job, store, &Room::new(cell));
    let expected = |line: u32| job.steps.iter().any(|step| step.line == line && step.expects_error);
    let findings = walked.findings.iter().filter(|finding| finding.error && !expected(finding.line));
    let faults = path_faults(&findings.collect::<Vec<_>>(), store);
    for reload in &mut job.reloads {
        reload.store.add_faults(faults.iter().cloned());
    }
    store.add_faults(faults);
    walked
}

fn path_faults(findings: &[&Finding], store: &Store) -> Vec<Fault> {
    let named = |finding: &&&Finding| !finding.data.is_empty();
    let findings: Vec<&Finding> = findings.iter().filter(named).copied().collect();
    let suspects = |finding: &&Finding| DataGroup {
        data: finding.data.iter().map(|datum| datum.name.clone()).collect(),
        error: true,
    };
    let suspects: Vec<DataGroup> = findings.iter().map(suspects).collect();
    let fault = |group: &Group| {
        let first = findings.get(*group.findings.first()?)?;
        let datum = first.data.iter().find(|datum| datum.name == group.datum)?;
        let message = match group.findings.len() {
            1 => format!("{}: {}", datum.name, first.message),
            count => format!("{}, {count} findings, the first: {}", datum.name, first.message),
        };
        Some(Fault::of_record(datum.at, store.place(datum.at), message))
    };
    grouped(&suspects).iter().filter_map(fault).collect()
}

/// Check that no command of a job uses a record with an error.
pub fn check_job(job: &Job, store: &Store, walked: Option<&WalkedJob>) -> Result<(), StartError> {
    let mut current = store;
    let mut wrong = Vec::new();
    for line in &job.steps {
        match &line.step {
            Step::Command(command) if !line.expects_error => {
                let known =
                    walked.and_then(|walked| walked.lines.iter().find(|known| known.line == line.line));
                let used: Vec<At> = match known {
                    _ if current.faults().next().is_none() => continue,
                    Some(known) => {
                        known.phases.iter().flat_map(|phase| phase.plan.used.iter().copied()).collect()
                    }
                    None => used(command, current, &Present::default()),
                };
                if let Some(why) = of_faults(&current.faults_of(command, &used)) {
                    wrong.push(format!("line {}, `{}`: {why}", line.line, line.text));
                }
            }
            Step::Workstation(Workstation::Load { number })
            | Step::After { action: Workstation::Load { number }, .. } => {
                current = job.reload(*number).map_or(current, |reload| &reload.store);
            }
            _ => {}
        }
    }
    if wrong.is_empty() { Ok(()) } else { Err(StartError::WrongData { job: job.name.clone(), wrong }) }
}
