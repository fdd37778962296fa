//! Macros of the RCS-II/T3 controller, used through `rcs_core`.
//!
//! * [`Plain`](macro@Plain): fixed-size data with a byte image and a schema;
//! * [`Variables`]: the state variables of a decision table;
//! * [`macro@state_variables`]: methods that sense state variables; each table senses only the variables that it tests;
//! * [`Actions`]: the actions of a decision table's rows;
//! * [`decision_table!`]: a decision table as one exhaustive `match`;
//! * [`commands!`]: the commands of a process and the tables that decide about them.
//!
//! They are procedural so that lints reach the rows: the compiler underlines a misspelt, missing or dead row, value or
//! step in the table. It misses dead rows in a `macro_rules!` macro of another crate.

mod actions;
mod commands;
mod names;
mod plain;
mod senses;
mod table;
mod variables;

use proc_macro::TokenStream;
use syn::{DeriveInput, Error, ItemImpl, parse_macro_input};

fn finish(result: syn::Result<proc_macro2::TokenStream>) -> TokenStream {
    result.unwrap_or_else(Error::into_compile_error).into()
}

/// Derive `rcs_core::Plain` for a struct of plain fields, or for an enum.
///
/// Both get `Default`: all fields zero, or the first variant.
///
/// An enum without data is one byte, the position of its variant from 0. It also gets `ALL`, `text`, `code`,
/// `from_code`, `from_text` and `Display`. The text of a variant is its name in lower case with hyphens, or the value
/// of `#[text = "..."]`. On the enum, `#[text(upper)]` selects upper case, and `#[text(doc)]` the doc comment as part
/// of a sentence. An enum with data is a byte for the variant, then at most one field, filled with zeros up to the
/// largest variant.
#[proc_macro_derive(Plain, attributes(text))]
pub fn plain(input: TokenStream) -> TokenStream {
    finish(plain::derive(&parse_macro_input!(input as DeriveInput)))
}

/// Describes a struct of plain enums as state variables: [`decision_table!`] finds their values by field names.
#[proc_macro_derive(Variables)]
pub fn variables(input: TokenStream) -> TokenStream {
    finish(variables::derive(&parse_macro_input!(input as DeriveInput)))
}

/// Describes methods as state variables: the struct of a [`decision_table!`] with `struct of super::Senses` has those
/// that its rows name. `#[passed]` marks the one that a table above passes on; its method returns the initial value.
#[proc_macro_attribute]
pub fn state_variables(_: TokenStream, input: TokenStream) -> TokenStream {
    finish(senses::expand(parse_macro_input!(input as ItemImpl)))
}

/// Describes an enum as actions, bare or with one plain enum, so that [`decision_table!`] finds their arguments.
#[proc_macro_derive(Actions)]
pub fn actions(input: TokenStream) -> TokenStream {
    finish(actions::derive(&parse_macro_input!(input as DeriveInput)))
}

/// Write a decision table; described in `rcs_core::table`.
#[proc_macro]
pub fn decision_table(input: TokenStream) -> TokenStream {
    finish(table::expand(input.into()))
}

/// List the tables of a process and the commands that select them; described in `rcs_core::table`.
#[proc_macro]
pub fn commands(input: TokenStream) -> TokenStream {
    finish(commands::expand(input.into()))
}
