//! `rcs-run tables`: every decision table as Markdown.

use std::{
    fmt::Write as _,
    io::{self, ErrorKind, Write as _},
    process::ExitCode,
};

use executive::failure;
use levels::ladder::Ladder;
use rcs_core::table::Table;

use crate::error::Error;

/// Print all tables.
pub fn tables() -> Result<ExitCode, Error> {
    let mut text = String::from("# Decision tables\n");
    for process in Ladder::processes() {
        let _ = write!(text, "\n## {}\n", process.name);
        for (number, table) in (1..).zip(process.tables) {
            append(&mut text, number, table);
        }
    }
    match io::stdout().write_all(text.as_bytes()) {
        // A reader that has seen enough, such as `head`, is no failure.
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(ExitCode::SUCCESS),
        other => Ok(other.map(|()| ExitCode::SUCCESS)?),
    }
}

fn append(text: &mut String, number: usize, table: &Table) {
    // Writing to a String cannot fail.
    let _ = write!(text, "\n### {number}. {}\n\n", table.name);
    for line in table.doc {
        let _ = writeln!(text, "{}", line.trim());
    }
    let _ = writeln!(text, "\nSource: `{}:{}`\n", table.file, table.line);
    let columns = table.columns.iter().map(|column| format!(" {column} |")).collect::<String>();
    let _ = writeln!(text, "| row |{columns} action | next |");
    let _ = writeln!(text, "|---:|{} --- | --- |", " --- |".repeat(table.columns.len()));
    for row in table.rows {
        let cells: String = failure::cells(row).iter().map(|cell| format!(" {cell} |")).collect();
        let _ = writeln!(text, "| {} |{cells} {} | {} |", row.number, failure::action(row), row.next);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_row_of_every_table_has_as_many_cells_as_columns() {
        let mut rows = 0;
        for table in Ladder::processes().iter().flat_map(|process| process.tables) {
            for row in table.rows {
                assert_eq!(
                    failure::cells(row).len(),
                    table.columns.len(),
                    "{} row {}",
                    table.name,
                    row.number
                );
                rows += 1;
            }
        }
        assert!(rows > 0);
    }
}
