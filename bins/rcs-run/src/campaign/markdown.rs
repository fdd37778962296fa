//! The Markdown table of a campaign, one column per job. Columns of the jobs that were run are replaced; others stay.

use std::fmt::Write as _;

const BEGIN: &str = "<!-- campaign: made by rcs-run campaign JOB... --markdown FILE -->";
const END: &str = "<!-- end of the campaign -->"; // the line after the table
const FIRST: &str = "interruption";

#[derive(Debug, PartialEq)]
pub struct Column {
    pub job: String,
    pub cells: Vec<(String, String)>,
}

/// The page with the table, or the table alone without a page. Fails if the page has no place for it.
pub fn page(page: Option<&str>, fresh: &[Column]) -> Result<String, String> {
    let parts = match page {
        None => Some(("", "", "\n")),
        Some(page) => page.split_once(BEGIN).and_then(|(before, rest)| {
            let (table, after) = rest.split_once(END)?;
            Some((before, table, after))
        }),
    };
    let Some((before, old, after)) = parts else {
        return Err(format!("the page for the table needs the lines {BEGIN} and {END}, and one is missing"));
    };
    let old = columns(old);
    let of = |job: &str, among: &[Column]| among.iter().position(|column| column.job == job);
    let replaced = old.iter().map(|column| of(&column.job, fresh).map_or(column, |at| &fresh[at]));
    let new = fresh.iter().filter(|column| of(&column.job, &old).is_none());
    Ok(format!("{before}{BEGIN}\n{}{END}{after}", table(&replaced.chain(new).collect::<Vec<_>>())))
}

/// The columns of a table in the form of [`table`]; empty if it has another form.
fn columns(table: &str) -> Vec<Column> {
    let mut rows = table.lines().filter_map(|line| {
        let line = line.trim().strip_prefix('|')?.strip_suffix('|')?;
        let mut cells = line.split('|').map(str::trim);
        Some((cells.next()?, cells.collect::<Vec<_>>()))
    });
    let Some((FIRST, jobs)) = rows.next() else { return Vec::new() };
    let rows: Vec<_> = rows.skip(1).collect();
    let column = |(at, job): (usize, &&str)| {
        let cells = rows.iter().filter_map(|(interruption, cells)| {
            let cell = cells.get(at).filter(|cell| !cell.is_empty())?;
            Some(((*interruption).to_owned(), (*cell).to_owned()))
        });
        Column { job: (*job).to_owned(), cells: cells.collect() }
    };
    jobs.iter().enumerate().map(column).collect()
}

/// A table of columns. The interruptions are in the order of their first occurrence.
fn table(columns: &[&Column]) -> String {
    let mut interruptions: Vec<&str> = Vec::new();
    for (interruption, _) in columns.iter().flat_map(|column| &column.cells) {
        if !interruptions.contains(&interruption.as_str()) {
            interruptions.push(interruption);
        }
    }
    let jobs: Vec<&str> = columns.iter().map(|column| column.job.as_str()).collect();
    let mut text = format!("| {FIRST} | {} |\n|---|{}\n", jobs.join(" | "), "---|".repeat(jobs.len()));
    for interruption in interruptions {
        let cells: Vec<&str> = columns
            .iter()
            .map(|column| {
                let cell = column.cells.iter().find(|(of, _)| of == interruption);
                cell.map_or("", |(_, cell)| cell.as_str())
            })
            .collect();
        let _ = writeln!(text, "| {interruption} | {} |", cells.join(" | "));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn column(job: &str, cells: &[(&str, &str)]) -> Column {
        let cells = cells.iter().map(|(of, cell)| ((*of).to_owned(), (*cell).to_owned()));
        Column { job: job.to_owned(), cells: cells.collect() }
    }

    #[test]
    fn table_update_keeps_other_columns_and_text() {
        let shift = column("shift", &[("pause", "2/2")]);
        let old = column("linkbar", &[("pause", "1/2, 1 stranded"), ("hold", "2/2")]);
        let first = page(None, &[old, shift]).expect("a new page");
        let around = format!("# Title\n\n{first}\nMore.\n");
        let second = page(Some(&around), &[column("linkbar", &[("hold", "3/3")])]).expect("it has a table");
        let rows =
            "| interruption | linkbar | shift |\n|---|---|---|\n| hold | 3/3 |  |\n| pause |  | 2/2 |\n";
        assert_eq!(second, format!("# Title\n\n{BEGIN}\n{rows}{END}\n\nMore.\n"));
        assert!(page(Some("# Title\n"), &[]).expect_err("no place").contains("one is missing"));
    }
}
