//! The nearest known name, for messages about an unknown name.

/// The candidate with the least edit distance, if the difference can be a typing error. Of equal candidates, the first.
#[must_use]
pub fn nearest<'a>(wanted: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let limit = (wanted.len() / 3).max(1);
    let folded = wanted.to_ascii_uppercase();
    let mut best: Option<(usize, &str)> = None;
    for candidate in candidates {
        if candidate.len().abs_diff(wanted.len()) > limit {
            continue;
        }
        let distance = distance(&folded, &candidate.to_ascii_uppercase());
        if distance <= limit && best.is_none_or(|(least, _)| distance < least) {
            best = Some((distance, candidate));
        }
    }
    best.map(|(_, name)| name)
}

/// Help for an unknown name: `the nearest is NAME`, or all known names after `listing`, such as `there are`.
#[must_use]
pub fn alternatives<'a>(wanted: &str, known: impl IntoIterator<Item = &'a str>, listing: &str) -> String {
    let known: Vec<_> = known.into_iter().collect();
    match nearest(wanted, known.iter().copied()) {
        Some(near) => format!("the nearest is {near}"),
        None if known.is_empty() => format!("{listing} none"),
        None => format!("{listing} {}", known.join(", ")),
    }
}

/// Edit distance of two words: number of characters inserted, deleted, replaced, or swapped with the next.
#[must_use]
pub fn distance(one: &str, other: &str) -> usize {
    strsim::osa_distance(one, other)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slips_are_recognised() {
        let known = ["LK-GRP-1", "LK-GRP-FX1", "LK-GRP-FX2", "HOME", "SAFE"];
        let near = |name: &str| nearest(name, known);
        assert_eq!(near("LK-GPR-1"), Some("LK-GRP-1"));
        assert_eq!(near("lk-grp-fx3"), Some("LK-GRP-FX1"));
        assert_eq!(near("HONE"), Some("HOME"));
        assert_eq!(near("PFIXTURE"), None);
    }

    #[test]
    fn help_is_the_nearest_name_or_all_names() {
        let help = |name| alternatives(name, ["clevis", "linkbar"], "there are");
        assert_eq!(help("linkbr"), "the nearest is linkbar");
        assert_eq!(help("drum"), "there are clevis, linkbar");
        assert_eq!(alternatives("drum", [], "there are"), "there are none");
    }
}
