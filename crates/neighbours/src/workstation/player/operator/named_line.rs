//! The present line of a resumed job whose record does not show it (docs/design/resume.md "Not known").

use super::{Hwsc, OperatorError, State};

impl Hwsc {
    /// True if a person must name the line of a resumed job before it continues.
    #[must_use]
    pub const fn asks_line(&self) -> bool {
        self.intervention.asks_line
    }

    /// An operator names the present line of a resumed job, with which it then continues. Returns its text.
    pub fn name_line(&mut self, line: usize) -> Result<&str, OperatorError> {
        self.not_ended()?;
        let State::Waits { before_line, .. } = &mut self.intervention.state else {
            return Err(OperatorError::Plays);
        };
        if !self.intervention.asks_line {
            return Err(OperatorError::LineKnown);
        }
        let last = self.steps.len();
        let named = line.checked_sub(1).and_then(|at| self.steps.get(at));
        let named = named.ok_or(OperatorError::NoSuchLine { found: line, last })?;
        *before_line = true;
        (self.current, self.began, self.intervention.asks_line) = (line, None, false);
        self.later.clear();
        Ok(&named.text)
    }
}
