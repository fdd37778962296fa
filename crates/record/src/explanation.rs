//! Data with which a log explains itself, also to a program with other tables: decision tables, and reasons of
//! failures with their remedies, as JSON. MCAP does not compress attachments, so zstd does.

use std::io::Read as _;

use interfaces::Reason;
use levels::ladder::Ladder;
use rcs_core::{
    Plain as _,
    plain::{EnumSchema, Schema, VariantSchema},
    table::{ActionText, Row, Table, Variable},
};
use serde_json::{Value, json};

use crate::{Attachment, Log};

pub const TABLES: &str = "tables.json.zst"; // name of the attachment with the decision tables
pub const REASONS: &str = "reasons.json.zst";
/// Name of the attachment with the first failure and its consequences; only in the log of a failed run.
pub const FAILURE: &str = "failure.json";

/// Level of the compression. At level 19 the tables would be an eighth smaller, but a run would start 0.13 s later.
const COMPRESSION: i32 = 6;
/// Greatest size of a decompressed file, bytes. It is limited because a damaged file can state any size.
const LARGEST: u64 = 16 << 20;

#[must_use]
pub fn attachments() -> [Attachment; 2] {
    [(TABLES, tables()), (REASONS, reasons())].map(|(name, value)| {
        // Compression into memory cannot fail.
        let data = zstd::encode_all(value.to_string().as_bytes(), COMPRESSION).unwrap_or_default();
        Attachment { name: name.into(), media_type: "application/zstd".into(), data }
    })
}

/// An attachment by its name. `None` if it is damaged, or the log is older.
#[must_use]
pub fn of_log(log: &Log, name: &str) -> Option<Value> {
    let data = &log.attachment(name)?.data;
    let mut text = Vec::new();
    zstd::Decoder::new(data.as_slice()).ok()?.take(LARGEST).read_to_end(&mut text).ok()?;
    serde_json::from_slice(&text).ok()
}

/// The decision tables of all processes: `[{process, tables: [{name, doc, source, steps, variables, digits, actions, rows}]}]`.
#[must_use]
pub fn tables() -> Value {
    let process = |process: &levels::ladder::ProcessInfo| {
        let tables: Vec<Value> = process.tables.iter().map(|it| table(it)).collect();
        json!({ "process": process.name, "tables": tables })
    };
    Ladder::processes().iter().map(process).collect()
}

/// The remedy of a reason in a log, or in this program. `None` if PAUSE and the same command may be enough.
#[must_use]
pub fn remedy(log: &Log, reason: &str) -> Option<String> {
    let reasons = of_log(log, REASONS).unwrap_or_else(reasons);
    let known = reasons.as_array()?.iter().find(|known| known["text"] == reason)?;
    known["remedy"].as_str().map(str::to_owned)
}

/// The reasons of failures: `[{code, text, remedy}]`; without a remedy if PAUSE and the same command may be enough.
#[must_use]
pub fn reasons() -> Value {
    let Schema::Enum(schema) = Reason::SCHEMA else { return Value::Array(Vec::new()) };
    let reason = |code: u8, text: &str| {
        let remedy = rcs_core::plain::from_bytes::<Reason>(&[code]).ok().and_then(Reason::remedy);
        json!({ "code": code, "text": text, "remedy": remedy })
    };
    let named = schema.variants.iter().filter(|variant| !variant.text.is_empty());
    named.map(|variant| reason(variant.code, variant.text)).collect()
}

fn table(table: &'static Table) -> Value {
    json!({
        "name": table.name,
        "doc": prose(table.doc.iter().copied()),
        "source": format!("{}:{}", table.file, table.line),
        "steps": table.steps.map_or(Value::Array(Vec::new()), |of| of.variants.iter().map(step).collect()),
        "variables": table.asked().map(variable).collect::<Value>(),
        "digits": table.variables.iter().map(digit).collect::<Value>(),
        "actions": table.actions.iter().filter_map(|it| action(it, table.rows)).collect::<Value>(),
        "rows": table.rows.iter().map(row).collect::<Value>(),
    })
}

fn variable(variable: &'static Variable) -> Value {
    json!({ "name": variable.name, "doc": prose([variable.doc]), "values": values(variable.values) })
}

/// An action with its arguments in the rows; `None` if the rows do not use it.
fn action(action: &ActionText, rows: &[Row]) -> Option<Value> {
    let naming: Vec<&Row> = rows.iter().filter(|row| row.action == action.name).collect();
    let given = |name: &str| naming.iter().any(|row| row.argument == Some(name));
    let arguments = action.argument.iter().flat_map(|of| of.variants).filter(|it| given(it.name)).map(value);
    let arguments: Value = arguments.collect();
    let named = json!({ "name": action.name, "doc": prose([action.doc]), "arguments": arguments });
    (!naming.is_empty()).then_some(named)
}

fn step(variant: &VariantSchema) -> Value {
    json!({ "name": variant.name, "doc": prose([variant.doc]), "code": variant.code })
}

/// A digit of [`rcs_core::table::Variables::code`], even of a variable that no row tests.
fn digit(variable: &'static Variable) -> Value {
    json!({ "name": variable.name, "values": variable.values.variants.len() })
}

fn values(of: &EnumSchema) -> Value {
    of.variants.iter().map(value).collect()
}

fn value(variant: &VariantSchema) -> Value {
    json!({ "name": variant.name, "doc": prose([variant.doc]) })
}

fn row(row: &Row) -> Value {
    let when: serde_json::Map<String, Value> =
        row.when.iter().map(|condition| (condition.variable.to_owned(), json!(condition.values))).collect();
    json!({ "steps": row.steps, "when": when, "action": row.call().to_string(), "next": row.next })
}

/// Lines of a doc comment as one text, without the marks of Rust's documentation.
fn prose<'a>(lines: impl IntoIterator<Item = &'a str>) -> String {
    let text: Vec<&str> = lines.into_iter().flat_map(str::lines).map(str::trim).collect();
    text.join(" ").replace(['`', '[', ']'], "").trim().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_contain_every_row_of_every_process() {
        let tables = tables();
        for (process, shown) in Ladder::processes().iter().zip(tables.as_array().unwrap()) {
            assert_eq!(shown["process"], process.name);
            for (table, shown) in process.tables.iter().zip(shown["tables"].as_array().unwrap()) {
                assert_eq!(shown["name"], table.name);
                assert_eq!(shown["rows"].as_array().unwrap().len(), table.rows.len());
            }
        }
    }

    #[test]
    fn attachments_are_small() {
        let [tables, reasons] = attachments().map(|file| file.data.len());
        assert!((1..64 << 10).contains(&tables), "{tables}");
        assert!((1..16 << 10).contains(&reasons), "{reasons}");
    }

    #[test]
    fn reasons_have_their_remedies() {
        let reasons = reasons();
        let find =
            |text: &str| reasons.as_array().unwrap().iter().find(|it| it["text"] == text).cloned().unwrap();
        assert_eq!(find("vision sees no object")["remedy"], Value::Null);
        assert_eq!(find("the joystick box is on")["remedy"], "switch the frame at the joystick box off");
    }
}
