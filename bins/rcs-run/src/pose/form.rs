//! The form of a pose (VII.1) in the text of a file of blocks.

use geometry::pose::Pose;
use taskdata::load::{
    Source,
    source::{BLOCK_LINES, blocks},
};

/// A text with a form in it.
#[derive(Debug, PartialEq, Eq)]
pub struct Changed {
    /// The whole text.
    pub text: String,
    /// First line that has changed, from 1.
    pub line: usize,
    /// Lines that are gone.
    pub removed: Vec<String>,
    /// Lines that are new.
    pub added: Vec<String>,
}

/// Put the form of a pose into a text: in the place of the form of that name, or behind the last line of the block.
///
/// # Errors
/// What is missing: no block of that number, or no room in it.
pub fn put(
    text: &str,
    block: Option<u32>,
    name: &str,
    movetable: &str,
    pose: &Pose,
) -> Result<Changed, String> {
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    let form = form(name, movetable, pose);
    let of_name =
        |line: &String| line.contains("-pose-") && line.split_whitespace().next_back() == Some(name);
    let (at, removed) = match lines.iter().position(of_name) {
        Some(last) => (last.checked_sub(2).ok_or("the form of that name has no three lines")?, 3),
        None => (end_of(text, block)?, 0),
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

/// The three lines of the form.
fn form(name: &str, movetable: &str, pose: &Pose) -> Vec<String> {
    let [wrist, tool, finger] =
        [pose.wrist, pose.tool, pose.finger].map(|[x, y, z]| format!("{x:>8} {y:>8} {z:>8}"));
    vec![wrist, tool, format!("{finger}   -pose-   {movetable:<11} {name}")]
}

/// The number of lines up to the end of what stands in a block, where a form of three lines and a blank one have room.
fn end_of(text: &str, block: Option<u32>) -> Result<usize, String> {
    let block = block.ok_or("there is no form of that name: say with --block where it is to stand")?;
    let source = Source { name: String::new(), text: text.into() };
    let (blocks, _) = blocks(0, &source);
    let known: Vec<_> = blocks.iter().map(|block| block.number.number.to_string()).collect();
    let there =
        if known.is_empty() { "it has none".to_owned() } else { format!("it has {}", known.join(", ")) };
    let found = blocks.iter().find(|found| found.number.number == block);
    let found = found.ok_or_else(|| format!("there is no block {block} in the file; {there}"))?;
    let used = found.lines.len();
    if used + 4 > BLOCK_LINES {
        return Err(format!(
            "block {block} has {used} of {BLOCK_LINES} lines: three and a blank one have no room"
        ));
    }
    let last = found.lines.last().map_or(found.header, |line| line.at);
    let before = usize::try_from(last.start).ok().and_then(|start| text.get(..start)).unwrap_or(text);
    Ok(before.lines().count() + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

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
    fn a_new_form_stands_behind_the_block() {
        let changed = put(TEXT, Some(610), "NEW-P", "...", &POSE).unwrap();
        assert_eq!(changed.line, 7);
        assert!(changed.removed.is_empty());
        let form = "\n\n       1       -2        3\n   40000        5        6\n       7        8       -9   -pose-   ...         NEW-P\n";
        assert!(changed.text.contains(&format!("HOME-POS{form}\nBLOCK# 612")), "{}", changed.text);
        let source = Source { name: String::new(), text: changed.text.as_str().into() };
        assert!(blocks(0, &source).1.is_empty());
        let in_an_empty_block = put(TEXT, Some(612), "NEW-P", "...", &POSE).unwrap();
        assert!(in_an_empty_block.text.ends_with("NEW-P\n"), "{}", in_an_empty_block.text);
    }

    #[test]
    fn a_form_of_that_name_is_replaced() {
        let changed = put(TEXT, None, "HOME-POS", "M-1", &POSE).unwrap();
        assert_eq!((changed.line, changed.removed.len(), changed.added.len()), (4, 3, 3));
        assert_eq!(changed.removed[0], "       0    -5022      636");
        assert!(!changed.text.contains("5022"));
        assert!(changed.text.contains("-pose-   M-1         HOME-POS\n\nBLOCK# 612"), "{}", changed.text);
    }

    #[test]
    fn what_has_no_place_is_refused() {
        let refused = |block| put(TEXT, block, "NEW-P", "...", &POSE).unwrap_err();
        assert!(refused(None).contains("--block"));
        assert!(refused(Some(99)).contains("it has 610, 612"));
        assert!(put("", Some(1), "NEW-P", "...", &POSE).unwrap_err().contains("it has none"));
        let full = TEXT.replace("( HOME )", &"(x)\n".repeat(9));
        assert!(put(&full, Some(610), "NEW-P", "...", &POSE).unwrap_err().contains("no room"));
    }
}
