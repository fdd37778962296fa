//! The lines of a job for the panel of the rotary table's controller (IV.1 step 3) and for the resolver electronics
//! (IV.3.3 step 11).

use super::{
    action::{ResolverPanel, TablePanel},
    fields::Fields,
    read::Reader,
    workstation::SWITCH,
};

#[derive(Clone, Copy)]
enum TableVerb {
    Power,
    Mode,
    Run { plus: bool },
    Step { plus: bool },
    Reset,
}

const TABLE_VERBS: &[(&str, TableVerb)] = &[
    ("power", TableVerb::Power),
    ("mode", TableVerb::Mode),
    ("run+", TableVerb::Run { plus: true }),
    ("run-", TableVerb::Run { plus: false }),
    ("step+", TableVerb::Step { plus: true }),
    ("step-", TableVerb::Step { plus: false }),
    ("reset", TableVerb::Reset),
];

const MODES: &[(&str, bool)] = &[("manual", true), ("prog", false)];

const RUN_FORM: &str = "** table run+|run- TICKS";
const TABLE_STEP_FORM: &str = "** table step+|step-, or with a COUNT behind it: a step is 0.01 degree";

#[derive(Clone, Copy)]
enum ResolverVerb {
    Manual(bool),
    Joint,
}

const RESOLVER_VERBS: &[(&str, ResolverVerb)] = &[
    ("manual", ResolverVerb::Manual(true)),
    ("auto", ResolverVerb::Manual(false)),
    ("joint", ResolverVerb::Joint),
];

/// The joints, from the base to the roll.
const JOINTS: &[(&str, u8)] = &[("0", 0), ("1", 1), ("2", 2), ("3", 3), ("4", 4), ("5", 5)];

impl Reader<'_, '_> {
    /// Read the words after `resolvers`.
    pub(super) fn resolvers(&mut self, fields: &mut Fields<'_, '_>) -> Option<ResolverPanel> {
        Some(match self.choice(fields, "switch or button of the resolver electronics", RESOLVER_VERBS)? {
            ResolverVerb::Manual(on) => ResolverPanel::Manual(on),
            ResolverVerb::Joint => ResolverPanel::Joint(self.choice(fields, "number of a joint", JOINTS)?),
        })
    }

    /// Read the words after `table`.
    pub(super) fn table(&mut self, fields: &mut Fields<'_, '_>) -> Option<TablePanel> {
        Some(match self.choice(fields, "key of the rotary table's controller", TABLE_VERBS)? {
            TableVerb::Power => {
                TablePanel::Power(self.choice(fields, "position of the power switch", SWITCH)?)
            }
            TableVerb::Mode => {
                TablePanel::Manual(self.choice(fields, "position of the mode switch", MODES)?)
            }
            TableVerb::Run { plus } => TablePanel::Run { plus, ticks: self.ticks(fields, RUN_FORM)? },
            TableVerb::Step { plus } => {
                let more = fields.more();
                let count = if more { self.count(fields, "a count", TABLE_STEP_FORM)? } else { 1 };
                TablePanel::Step { plus, count }
            }
            TableVerb::Reset => TablePanel::Reset,
        })
    }
}
