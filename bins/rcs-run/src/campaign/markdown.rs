//! The table of a page: made anew for the jobs that were run, kept for the others.

/// The line in front of the table.
const BEGIN: &str = "<!-- campaign: made by rcs-run campaign JOB... --markdown FILE -->";
/// The line behind it.
const END: &str = "<!-- end of the campaign -->";
/// Its head.
const HEAD: &str = "| job | interruption | branches | done | stranded | hurt | apart | done of those not apart |\n\
                    |---|---|---:|---:|---:|---:|---:|---:|\n";

/// The rows of a job.
pub struct Rows {
    /// The job.
    pub job: String,
    /// Its rows, a line each.
    pub text: String,
}

/// A page with the table: the table alone if there is no page yet.
///
/// # Errors
/// A sentence, if the page has no place for the table.
pub fn page(page: Option<&str>, tables: &[Rows]) -> Result<String, String> {
    let fresh: String = tables.iter().map(|rows| rows.text.as_str()).collect();
    let Some(page) = page else { return Ok(format!("{BEGIN}\n{HEAD}{fresh}{END}\n")) };
    let parts = page.split_once(BEGIN).and_then(|(before, rest)| Some((before, rest.split_once(END)?)));
    let Some((before, (table, after))) = parts else {
        return Err(format!("the page for the table needs the lines {BEGIN} and {END}, found not both"));
    };
    let is_other = |line: &&str| {
        let job = line.strip_prefix("| ").and_then(|line| line.split(' ').next());
        job.is_some_and(|job| tables.iter().all(|rows| rows.job != job))
    };
    // Behind the head.
    let rows = table.lines().skip_while(|line| !line.starts_with("|---")).skip(1);
    let kept: String = rows.filter(is_other).map(|line| format!("{line}\n")).collect();
    Ok(format!("{before}{BEGIN}\n{HEAD}{kept}{fresh}{END}{after}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows(job: &str, text: &str) -> Rows {
        Rows { job: job.to_owned(), text: format!("| {job} | {text} |\n") }
    }

    #[test]
    fn rows_of_other_jobs_and_the_text_around_the_table_stay() {
        let first = page(None, &[rows("linkbar", "1"), rows("shift", "2")]).expect("a new page");
        let around = format!("# Title\n\n{first}\nMore.\n");
        let second = page(Some(&around), &[rows("linkbar", "3")]).expect("it has a table");
        let table = format!("{BEGIN}\n{HEAD}| shift | 2 |\n| linkbar | 3 |\n{END}\n");
        assert_eq!(second, format!("# Title\n\n{table}\nMore.\n"));
        assert!(page(Some("# Title\n"), &[]).expect_err("no place").contains("found not both"));
    }
}
