//! The verdict on a branch and its report.
//!
//! ```text
//!   a command has ended ──► the world as in the undisturbed run?     no: hurt, or apart after a slide
//!   a confirmation is false                                          false
//!   a contact, a part that slides                                    hurt if a point was commanded, or else apart
//!   the operator has no try left                                     stranded
//!   the command after the interrupted one has finished               done
//! ```

use levels::ladder::Ladder;
use neighbours::workstation::player::Workstation as _;

use super::{
    super::{
        harm::{World, is_commanded},
        interruption::Kind,
        known::End,
        motion::Motion,
        verdict::{BranchResult, OutageResult, Verdict},
    },
    Observer, Trial, Until,
};

/// Ticks for which a branch continues after damage by a commanded point: 2 s.
const AFTERMATH: u64 = 50;
/// Ticks for which a branch continues after a false confirmation, which the processes above pass on.
const PASSED_ON: u64 = 12;

impl Trial<'_, '_> {
    /// The verdict, as soon as the branch can be judged.
    pub(super) fn verdict(&mut self, observer: &mut impl Observer) -> Option<Verdict> {
        let mut reached = false;
        for ended in self.operator.ended() {
            let how = if ended.failure.is_empty() { "finished" } else { ended.failure.as_str() };
            let text = format!("tick {}: {}: {how}", ended.tick.0, ended.command);
            observer.say(ended.tick, &text);
            // A run repeats a failed command by itself (--retry), but no line of the workstation.
            let is_command = self.operator.command_at(ended.line).is_some();
            self.has_failed_line |= !is_command && !ended.failure.is_empty();
            self.ended.push((ended.tick, text));
            if ended.of_job && ended.failure.is_empty() {
                self.compare(ended.line, &ended.command);
                reached |= ended.line >= self.goal && self.next().is_none();
            }
        }
        if let Some(first) = self.untrue.iter().find(|confirmation| confirmation.is_false()) {
            return (self.branch.at().0 >= first.tick + PASSED_ON).then_some(Verdict::False);
        }
        let worst = self.monitor.worst().map(|harm| (harm.commanded, harm.tick));
        if self.mismatch.is_some() {
            return Some(Verdict::Hurt);
        }
        if let Some(motion) = &self.motion {
            return motion.verdict(worst.map(|(commanded, _)| commanded));
        }
        if let Some((true, tick)) = worst {
            // Continue for a while, to learn the full extent of the damage.
            return (self.branch.at().since(tick) >= AFTERMATH).then_some(Verdict::Hurt);
        }
        let stranded = self.operator.stranded().is_some() || self.branch.closed.contacts().is_stuck();
        let apart = worst.is_some() || (stranded && self.monitor.attribute_to_slide(""));
        match (stranded, apart) {
            (true, false) => Some(Verdict::Stranded),
            (true, true) => Some(Verdict::Apart),
            (false, _) if !reached && !self.operator.is_over() => None,
            (false, false) => Some(Verdict::Done),
            (false, true) => Some(Verdict::Apart),
        }
    }

    /// Compare the world with that of the undisturbed run when a command finishes.
    fn compare(&mut self, line: usize, command: &str) {
        if self.kind().disturbance().is_some() {
            return;
        }
        let Some(world) = self.parent.world_after(line) else { return };
        // The world can differ without a fault: an uncommanded contact moves a part, and an arm without pressure sinks.
        if self.monitor.worst().is_some() || !is_commanded(&self.branch) {
            return;
        }
        let verb = command.split_whitespace().next().unwrap_or_default();
        let moves = !matches!(verb, "STARTUP" | "SHUTDOWN");
        if let Some(unlike) = World::of(&mut self.branch).unlike(world, moves) {
            if self.monitor.attribute_to_slide(&unlike) {
                return;
            }
            self.mismatch = Some((
                format!("{verb} is finished, but {}", general(&unlike)),
                format!("tick {}: {command} is finished, but {unlike}", self.branch.at().0),
            ));
        }
    }

    pub(super) fn result(self, verdict: Verdict, end: &End, doing: Vec<String>) -> BranchResult {
        let (reason, detail) = self.why(verdict);
        let judged = self.judged();
        let outage = self.kind().outage().map(|_| OutageResult {
            attended: self.outages.has_released() || self.has_failed_line,
            late: (verdict == Verdict::Done).then(|| self.branch.at().since(self.parent.end_of(self.goal))),
        });
        let digest = (*self.kind() == Kind::None).then(|| self.branch.closed.digest().to_string());
        let line = match self.line.checked_sub(1) {
            None => "PAUSE".to_owned(),
            Some(at) => self
                .branch
                .facility()
                .job
                .steps
                .get(at)
                .map_or("the end", |line| line.text.as_str())
                .to_owned(),
        };
        BranchResult {
            at: self.begun_at.0,
            interruption: self.series.to_string(),
            smallest: None,
            verdict,
            reason,
            detail,
            line,
            met_command: self.operator.command_at(self.line).is_some(),
            doing,
            ended: self.ended.into_iter().map(|(_, text)| text).collect(),
            until: end.until.0,
            rest_after: self.motion.as_ref().map(Motion::ticks),
            untrue: self.untrue,
            judged,
            remedied: self.remedied || self.operator.has_remedied(),
            whole: self.until == Until::Job,
            outage,
            state: end.state.to_string(),
            digest,
        }
    }

    fn why(&self, verdict: Verdict) -> (String, String) {
        match verdict {
            Verdict::Done => (String::new(), String::new()),
            Verdict::False => {
                let first = self.untrue.iter().find(|confirmation| confirmation.is_false());
                first.map_or_else(Default::default, |first| {
                    let verb = first.command.split_whitespace().next().unwrap_or_default();
                    let cause = format!("{} {verb}: {}", first.level, general(&first.truth));
                    (cause, format!("tick {}: {first}", first.tick))
                })
            }
            Verdict::Hurt | Verdict::Apart => {
                if let Some(mismatch) = &self.mismatch {
                    return mismatch.clone();
                }
                let stranded =
                    self.operator.stranded().map_or_else(String::new, |why| format!("; stranded: {why}"));
                self.monitor.worst().map_or_else(Default::default, |harm| {
                    (harm.kind.clone(), format!("tick {}: {}{stranded}", harm.tick.0, harm.what))
                })
            }
            Verdict::Stranded if self.motion.is_some() => {
                let reason = "something still moves after 300 s".to_owned();
                (reason.clone(), reason)
            }
            Verdict::Stranded => {
                let reason = match self.operator.stranded() {
                    Some(reason) => reason.to_owned(),
                    None => "the robot overlaps another body".to_owned(),
                };
                let known = self.branch.closed.course().watch().failure(Ladder::processes());
                let emergency = self.branch.closed.workstation.emergency();
                let detail = known.map(|known| format!("tick {}: {}", known.tick.0, known.text));
                let detail = detail.or(emergency).unwrap_or_else(|| reason.clone());
                (reason, detail)
            }
        }
    }
}

fn general(text: &str) -> String {
    let number = |word: &str| word.parse::<f64>().is_ok() && word.contains('.');
    text.split(' ').map(|word| if number(word) { "some" } else { word }).collect::<Vec<_>>().join(" ")
}
