//! Inserts the form of a pose or a movetable into the text of a file of blocks.

use os_io::text::amount;
use taskdata::load::{
    Source,
    source::{BLOCK_LINES, blocks},
};

#[derive(Debug, PartialEq, Eq)]
pub struct Changed {
    pub text: String,
    /// First changed line, from 1.
    pub line: usize,
    pub removed: Vec<String>,
    pub added: Vec<String>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A pose (VII.1).
    Pose,
    /// A movetable (VII.2).
    Movetable,
}

impl Kind {
    /// The compiling word, in the last line of the form.
    const fn word(self) -> &'static str {
        match self {
            Self::Pose => "-pose-",
            Self::Movetable => "-mtb-",
        }
    }

    /// Number of lines of the form that ends with line `last`.
    fn lines(self, lines: &[String], last: usize) -> usize {
        match self {
            Self::Pose => 3,
            Self::Movetable => {
                let before = lines.get(..last).unwrap_or_default().iter().rev();
                let is_of_it = |line: &&String| line.trim_end().ends_with("----");
                before.take_while(is_of_it).count() + 1
            }
        }
    }
}

/// Insert a form: in place of the form of that name, or after the last line of the block.
pub fn put(
    text: &str,
    block: Option<u32>,
    kind: Kind,
    name: &str,
    form: Vec<String>,
) -> Result<Changed, String> {
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    let of_name =
        |line: &String| line.contains(kind.word()) && line.split_whitespace().next_back() == Some(name);
    let (at, removed) = match lines.iter().position(of_name) {
        Some(last) => {
            let old = kind.lines(&lines, last);
            let first = (last + 1).checked_sub(old);
            (
                first
                    .ok_or_else(|| format!("the form of that name does not have {}", amount(old, "line")))?,
                old,
            )
        }
        None => (end_of(text, block, form.len())?, 0),
    };
    let mut added = form;
    if removed == 0
        && at.checked_sub(1).and_then(|before| lines.get(before)).is_some_and(|line| !line.is_empty())
    {
        added.insert(0, String::new());
    }
    let removed = lines.splice(at..at + removed, added.clone()).collect();
    Ok(Changed { text: lines.join("\n") + "\n", line: at + 1, removed, added })
}

/// Number of lines up to the end of the block's text, if a form of `form` lines and a blank line fit after it.
fn end_of(text: &str, block: Option<u32>, form: usize) -> Result<usize, String> {
    let block = block.ok_or("there is no form of that name: name its block with --block")?;
    let source = Source { name: String::new(), text: text.into() };
    let (blocks, _) = blocks(0, &source);
    let known: Vec<_> = blocks.iter().map(|block| block.number.number.to_string()).collect();
    let there =
        if known.is_empty() { "it has none".to_owned() } else { format!("it has {}", known.join(", ")) };
    let found = blocks.iter().find(|found| found.number.number == block);
    let found = found.ok_or_else(|| format!("there is no block {block} in the file; {there}"))?;
    let used = found.lines.len();
    if used + form + 1 > BLOCK_LINES {
        return Err(format!(
            "block {block} has {used} of {BLOCK_LINES} lines: {form} and a blank one have no room"
        ));
    }
    let last = found.lines.last().map_or(found.header, |line| line.at);
    let before = usize::try_from(last.start).ok().and_then(|start| text.get(..start)).unwrap_or(text);
    Ok(before.lines().count() + 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use geometry::pose::Pose;
    use paths::stand::pose_form;

    fn put_pose(text: &str, block: Option<u32>, name: &str, movetable: &str) -> Result<Changed, String> {
        put(text, block, Kind::Pose, name, pose_form(name, movetable, &POSE))
    }

    const POSE: Pose = Pose { wrist: [1, -2, 3], tool: [40_000, 5, 6], finger: [7, 8, -9] };
    const TEXT: &str = "\
%% Poses.
BLOCK# 610 OFFSET 21000
( HOME )
       0    -5022      636
       0    -7145    -1483
    3000    -7145    -1483   -pose-   ...         HOME-POS

BLOCK# 612 OFFSET 21000
";

    #[test]
    fn new_form_follows_the_block() {
        let changed = put_pose(TEXT, Some(610), "NEW-P", "...").unwrap();
        assert_eq!(changed.line, 7);
        assert!(changed.removed.is_empty());
        let form = "\n\n       1       -2        3\n   40000        5        6\n       7        8       -9   -pose-   ...         NEW-P\n";
        assert!(changed.text.contains(&format!("HOME-POS{form}\nBLOCK# 612")), "{}", changed.text);
        let source = Source { name: String::new(), text: changed.text.as_str().into() };
        assert!(blocks(0, &source).1.is_empty());
        let in_an_empty_block = put_pose(TEXT, Some(612), "NEW-P", "...").unwrap();
        assert!(in_an_empty_block.text.ends_with("NEW-P\n"), "{}", in_an_empty_block.text);
    }

    #[test]
    fn form_of_the_same_name_is_replaced() {
        let changed = put_pose(TEXT, None, "HOME-POS", "M-1").unwrap();
        assert_eq!((changed.line, changed.removed.len(), changed.added.len()), (4, 3, 3));
        assert_eq!(changed.removed[0], "       0    -5022      636");
        assert!(!changed.text.contains("5022"));
        assert!(changed.text.contains("-pose-   M-1         HOME-POS\n\nBLOCK# 612"), "{}", changed.text);
    }

    #[test]
    fn form_without_a_valid_block_is_refused() {
        let refused = |block| put_pose(TEXT, block, "NEW-P", "...").unwrap_err();
        assert!(refused(None).contains("--block"));
        assert!(refused(Some(99)).contains("it has 610, 612"));
        assert!(put_pose("", Some(1), "NEW-P", "...").unwrap_err().contains("it has none"));
        let full = TEXT.replace("( HOME )", &"(x)\n".repeat(9));
        assert!(put_pose(&full, Some(610), "NEW-P", "...").unwrap_err().contains("no room"));
    }

    #[test]
    fn movetable_replaces_all_old_lines() {
        let text = "BLOCK# 1 OFFSET 21000\n    1    t 1 2 3  -mtb-   A\n    1    t 1 2 3  ----\n    2    ro 5  -mtb-   B\n";
        let form = vec!["    1    t 9 9 9      -mtb-   B".to_owned()];
        let changed = put(text, None, Kind::Movetable, "B", form).unwrap();
        assert_eq!((changed.removed.len(), changed.line), (2, 3));
        assert!(changed.text.contains("-mtb-   A\n    1    t 9 9 9      -mtb-   B\n"), "{}", changed.text);
    }
}
