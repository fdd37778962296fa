//! Macros of the RCS-II/T3 controller, used through `rcs_core`.
//!
//! * [`Plain`](macro@Plain): fixed-size data with a byte image and a schema;
//! * [`Variables`]: the state variables of a decision table;
//! * [`macro@state_variables`]: methods that sense state variables, from which each table takes those that it tests;
//! * [`Actions`]: what the rows of a decision table can ask for;
//! * [`decision_table!`]: a decision table as one exhaustive `match`;
//! * [`commands!`]: which table decides on which command of a process.
//!
//! They are procedural, because the compiler's lints must reach the rows: a row, a value or a step that is misspelt, missing or dead
//! is underlined where it stands in the table. A `macro_rules!` macro of another crate hides dead rows from the lint.

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
/// Both get `Default`, which is the value before anything was written: all fields zero, or the first variant.
///
/// An enum without data is one byte in the image, the position of its variant from 0. It also gets `ALL`, `text`, `code`, `from_code`,
/// `from_text` and `Display`. The text of a variant is its name in lower case with hyphens, or what `#[text = "..."]` says. On the enum,
/// `#[text(upper)]` asks for upper case, and `#[text(doc)]` for the doc comment as part of a sentence.
///
/// An enum with data is a byte for the variant, then as many bytes as its largest variant needs, zero where a variant needs fewer. Each
/// variant has at most one field.
#[proc_macro_derive(Plain, attributes(text))]
pub fn plain(input: TokenStream) -> TokenStream {
    finish(plain::derive(&parse_macro_input!(input as DeriveInput)))
}

/// Derive the description of state variables for a struct whose fields all are plain enums, so that
/// [`decision_table!`] can look values up by the name of a field.
#[proc_macro_derive(Variables)]
pub fn variables(input: TokenStream) -> TokenStream {
    finish(variables::derive(&parse_macro_input!(input as DeriveInput)))
}

/// Describe the methods of an `impl` block as state variables, so that the head of a [`decision_table!`] can say
/// `struct of super::Senses`. The struct of that table has those variables that its rows name.
///
/// `#[passed]` marks the variable whose value a table above passes on; its method returns the value before that.
#[proc_macro_attribute]
pub fn state_variables(_: TokenStream, input: TokenStream) -> TokenStream {
    finish(senses::expand(parse_macro_input!(input as ItemImpl)))
}

/// Derive the description of actions for an enum whose variants are bare or carry one plain enum, so that
/// [`decision_table!`] can look arguments up by the name of an action.
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
