//! Text in columns: every character is one column wide.

/// Text of exactly `width` columns. An ellipsis ends a text that is too long.
pub fn fit(text: &str, width: usize) -> String {
    let length = text.chars().count();
    if length <= width {
        return format!("{text:<width$}");
    }
    let mut cut: String = text.chars().take(width.saturating_sub(1)).collect();
    if width > 0 {
        cut.push('…');
    }
    cut
}

/// Text in lines of at most `width` columns. Further lines are indented two columns more.
pub fn wrap(text: &str, width: usize) -> Vec<String> {
    let indent = text.chars().take_while(|sign| " >~!".contains(*sign)).count() + 2;
    let mut lines = Vec::new();
    let mut rest = text;
    let mut front = String::new();
    loop {
        let room = width.saturating_sub(front.chars().count()).max(1);
        if rest.chars().count() <= room {
            lines.push(front + rest);
            return lines;
        }
        let end = rest.char_indices().nth(room).map_or(rest.len(), |(at, _)| at);
        let spaces = rest.get(..=end).unwrap_or(rest);
        let text_begins = rest.len() - rest.trim_start().len();
        let cut = spaces.rfind(' ').filter(|at| *at > text_begins).unwrap_or(end);
        let (line, more) = rest.split_at(cut);
        lines.push(front + line.trim_end());
        front = " ".repeat(indent.min(width / 2));
        rest = more.trim_start();
    }
}

pub fn rule(title: &str, width: usize) -> String {
    let head = if title.is_empty() { String::new() } else { format!("─ {} ", fit_short(title, width)) };
    let rest = width.saturating_sub(head.chars().count());
    head + &"─".repeat(rest)
}

fn fit_short(title: &str, width: usize) -> String {
    let room = width.saturating_sub(4);
    if title.chars().count() > room { fit(title, room) } else { title.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cut_text_ends_with_an_ellipsis() {
        assert_eq!(fit("MOVE", 6), "MOVE  ");
        assert_eq!(fit("TRANSFER", 5), "TRAN…");
        assert_eq!(fit("x", 0), "");
    }

    #[test]
    fn long_lines_are_broken_at_spaces() {
        assert_eq!(wrap(" short", 20), [" short"]);
        assert_eq!(wrap("  one two three", 9), ["  one two", "    three"]);
        assert_eq!(wrap("~ 7 one two", 9), ["~ 7 one", "    two"]);
        assert_eq!(wrap("abcdefghij", 4), ["abcd", "  ef", "  gh", "  ij"]);
        assert!(wrap("a long sentence that goes on and on", 7).iter().all(|line| line.chars().count() <= 7));
    }

    #[test]
    fn a_rule_has_the_width() {
        assert_eq!(rule("link", 10), "─ link ───");
        assert_eq!(rule("", 3), "───");
        assert_eq!(rule("a title that is long", 12).chars().count(), 12);
    }
}
