//! Decision tables (II.2.2.2): the state variables select one row, the row names one action and the next step.
//!
//! [`decision_table!`](crate::decision_table!) turns a table into one exhaustive `match`: the compiler proves that no
//! case is missing, and [`Table::dead_rows`] that no row is idle. Rows carry their number, so that a number in a log
//! is found in the source by reading, and the same source gives the table as text.

/// A decision table as text: what people read in logs, in `rcs-run tables` and in failure reports.
#[derive(Debug)]
pub struct Table {
    /// Function that decides, as the command it serves.
    pub name: &'static str,
    /// Doc comment of the table.
    pub doc: &'static [&'static str],
    /// State variables, in order.
    pub columns: &'static [&'static str],
    /// The rows, in order; row `n` is at `n - 1`.
    pub rows: &'static [RowText],
    /// Source file.
    pub file: &'static str,
    /// Line of the table in it.
    pub line: u32,
    /// Rows that fire for at least one combination of the state variables.
    pub live_rows: fn(&mut dyn FnMut(u8)),
}

/// A row as text.
#[derive(Debug, PartialEq, Eq)]
pub struct RowText {
    /// Number in the source, from 1.
    pub number: u8,
    /// Values of the state variables: `(Start, Held, _)`.
    pub conditions: &'static str,
    /// The action.
    pub action: &'static str,
    /// The step after it.
    pub next: &'static str,
}

/// What a table decided.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Decision<Action, Step> {
    /// Number of the row that fired.
    pub row: u8,
    /// What to do: sets outputs, computes nothing.
    pub action: Action,
    /// The reference action from now on.
    pub next: Step,
}

impl Table {
    /// The row with a number.
    #[must_use]
    pub fn row(&self, number: u8) -> Option<&RowText> {
        self.rows.iter().find(|row| row.number == number)
    }

    /// Calls `found` with the number of each row that no combination of the state variables reaches.
    pub fn dead_rows(&self, mut found: impl FnMut(u8)) {
        for row in self.rows {
            let mut alive = false;
            (self.live_rows)(&mut |number| alive |= number == row.number);
            if !alive {
                found(row.number);
            }
        }
    }
}

/// True if rows are numbered 1, 2, 3 …; checked at compile time for every table.
#[must_use]
pub const fn numbered_in_order(rows: &[RowText]) -> bool {
    let (mut rest, mut expected) = (rows, 1_u8);
    while let Some((row, more)) = rest.split_first() {
        if row.number != expected {
            return false;
        }
        (rest, expected) = (more, expected.saturating_add(1));
    }
    true
}

/// Write a decision table.
///
/// Cells hold variants of the column's enum, alternatives with `|`, or `_`. The action may carry one argument.
/// Column types are [`coded_enum!`](crate::coded_enum!)s.
///
/// ```
/// use rcs_core::{coded_enum, decision_table};
/// coded_enum! { pub enum Step { Start = "start", Wait = "wait", } }
/// coded_enum! { pub enum Door { Open = "open", Shut = "shut", Stuck = "stuck", } }
/// coded_enum! { pub enum Action { Stay = "stay", Close = "close", Report = "report", } }
/// decision_table! {
///     /// CLOSE-DOOR: for the example.
///     pub CLOSE_DOOR: fn close_door(step: Step, door: Door) -> (Action, Step) {
///         //   step   door             action  next
///         1: ( _    , Shut         ) => Report, Start;
///         2: ( Start, Open | Stuck ) => Close , Wait ;
///         3: ( Wait , Open         ) => Stay  , Wait ;
///         4: ( Wait , Stuck        ) => Close , Wait ;
///     }
/// }
/// let decision = close_door(Step::Wait, Door::Stuck);
/// assert_eq!((decision.row, decision.action), (4, Action::Close));
/// CLOSE_DOOR.dead_rows(|row| panic!("row {row} can never fire"));
/// assert_eq!(CLOSE_DOOR.row(2).unwrap().conditions, "(Start, Open | Stuck)");
/// ```
#[macro_export]
macro_rules! decision_table {
    (
        $(#[doc = $doc:literal])*
        $vis:vis $table:ident : fn $decide:ident $columns:tt -> ($action:ident, $step:ident) {
            $( $number:literal : $cells:tt => $act:ident $( ( $argument:path ) )? , $next:ident ; )+
        }
    ) => {
        $(#[doc = $doc])*
        $vis static $table: $crate::table::Table = $crate::table::Table {
            name: stringify!($decide),
            doc: &[ $( $doc, )* ],
            columns: $crate::decision_columns!(names $columns),
            rows: {
                const ROWS: &[$crate::table::RowText] = &[ $( $crate::table::RowText {
                    number: $number,
                    conditions: stringify!($cells),
                    action: stringify!($act $( ( $argument ) )?),
                    next: stringify!($next),
                }, )+ ];
                const { assert!($crate::table::numbered_in_order(ROWS), "rows are numbered from 1 in order") }
                ROWS
            },
            file: file!(),
            line: line!(),
            live_rows: |found| { $crate::decision_columns!(every $decide found $columns); },
        };

        $(#[doc = $doc])*
        #[must_use]
        $vis fn $decide $columns -> $crate::table::Decision<$action, $step> {
            match $crate::decision_columns!(values $columns) {
                $( $crate::decision_pattern!($columns $cells) => $crate::table::Decision {
                    row: $number,
                    action: $action::$act $( ( $argument ) )?,
                    next: $step::$next,
                }, )+
            }
        }
    };
}

/// Columns of a decision table as names, values, or a walk over all combinations.
#[doc(hidden)]
#[macro_export]
macro_rules! decision_columns {
    (names ( $( $column:ident : $type:ident ),+ $(,)? )) => { &[ $( stringify!($column), )+ ] };
    (values ( $( $column:ident : $type:ident ),+ $(,)? )) => { ( $( $column, )+ ) };
    (every $decide:ident $found:ident ( $( $column:ident : $type:ident ),+ $(,)? )) => {
        $crate::decision_columns!(walk $decide $found [ $( $column )+ ] $( $column $type )+)
    };
    (walk $decide:ident $found:ident [ $( $all:ident )+ ]) => { $found($decide($( $all, )+).row) };
    (walk $decide:ident $found:ident $all:tt $column:ident $type:ident $( $rest:ident )*) => {
        for &$column in $type::ALL {
            $crate::decision_columns!(walk $decide $found $all $( $rest )*)
        }
    };
}

/// Cells of a row as a pattern: `(Start, Open | Stuck)` becomes `(Step::Start, Door::Open | Door::Stuck)`.
#[doc(hidden)]
#[macro_export]
macro_rules! decision_pattern {
    (( $( $column:ident : $type:ident ),+ $(,)? ) ( $( $cells:tt )+ )) => {
        $crate::decision_pattern!(@ [ $( $type )+ ] [] $( $cells )+ ,)
    };
    (@ [] [ $( $done:tt )* ]) => { ( $( $done )* ) };
    (@ [ $type:ident $( $types:ident )* ] [ $( $done:tt )* ] _ , $( $rest:tt )*) => {
        $crate::decision_pattern!(@ [ $( $types )* ] [ $( $done )* _ , ] $( $rest )*)
    };
    (@ [ $type:ident $( $types:ident )* ] [ $( $done:tt )* ] $( $variant:ident )|+ , $( $rest:tt )*) => {
        $crate::decision_pattern!(@ [ $( $types )* ] [ $( $done )* $( $type::$variant )|+ , ] $( $rest )*)
    };
}
