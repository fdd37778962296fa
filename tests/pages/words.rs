//! No page and no comment uses a phrase of docs/words.toml.

use std::{fs, path::Path};

use serde::Deserialize;
use whole_system_tests::root;

use super::{pages, prose};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Words {
    word: Vec<Word>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Word {
    avoid: Vec<String>, // whole words in lower case
    better: String,
    why: String,
    #[serde(default)]
    pages_only: bool,
}

/// Words in lower case, separated and enclosed by single spaces. A `-` belongs to a word.
fn normalized(text: &str) -> String {
    let is_of_word = |c: char| c.is_alphanumeric() || matches!(c, '\'' | '-' | '_');
    let words = text.split(|c| !is_of_word(c)).filter(|word| !word.is_empty()).map(str::to_lowercase);
    words.fold(String::from(" "), |all, word| all + &word + " ")
}

fn without_code(text: &str) -> String {
    text.split('`').step_by(2).collect::<Vec<_>>().join("CODE")
}

/// The comments of a source, including the text after `//` in a string literal.
fn comments(source: &str) -> String {
    let texts = source.lines().filter_map(|line| line.split_once("//").map(|(_, comment)| comment));
    texts.collect::<Vec<_>>().join("\n")
}

impl Word {
    fn in_text<'a>(&'a self, path: &'a Path, text: &'a str) -> impl Iterator<Item = String> + 'a {
        let found = self.avoid.iter().filter(move |phrase| text.contains(&format!(" {phrase} ")));
        found.map(move |phrase| {
            format!("{}: {phrase:?}; better: {} ({})", path.display(), self.better, self.why)
        })
    }
}

#[test]
fn pages_and_comments_avoid_the_phrases_of_the_word_list() {
    assert_eq!(normalized("Is  led,\nand-so `on`"), " is led and-so on ");
    assert_eq!(comments("let a; // one\n/// two\nb"), " one\n/ two");
    let text = fs::read_to_string(root().join("docs/words.toml")).expect("the word list can be read");
    let words: Words = toml::from_str(&text).expect("the word list is valid");
    let mut found = Vec::new();
    // Entries of earlier versions keep their words.
    for path in pages().into_iter().filter(|path| !path.ends_with("CHANGELOG.md")) {
        let text =
            normalized(&without_code(&prose(&fs::read_to_string(&path).expect("the page can be read"))));
        found.extend(words.word.iter().flat_map(|word| word.in_text(&path, &text)));
    }
    for path in super::sources() {
        let text =
            normalized(&without_code(&comments(&fs::read_to_string(&path).expect("the source can be read"))));
        found.extend(
            words.word.iter().filter(|word| !word.pages_only).flat_map(|word| word.in_text(&path, &text)),
        );
    }
    assert!(found.is_empty(), "see docs/words.toml:\n{}", found.join("\n"));
}
