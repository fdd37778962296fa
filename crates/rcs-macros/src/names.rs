//! Spellings of a name, and doc comments.

use std::fmt::Display;

use syn::{Attribute, Expr, ExprLit, Lit, Meta};

/// Upper camel case to lower case with `separator`: `LettingGo` is `letting-go`.
pub fn words(name: &str, separator: char) -> String {
    let mut text = String::new();
    for letter in name.chars() {
        if letter.is_uppercase() && !text.is_empty() {
            text.push(separator);
        }
        text.extend(letter.to_lowercase());
    }
    text
}

/// Snake case to upper camel case: `get_object` is `GetObject`.
pub fn camel(name: &str) -> String {
    let upper = |word: &str| {
        let mut letters = word.chars();
        letters
            .next()
            .map(|first| first.to_uppercase().chain(letters).collect::<String>())
            .unwrap_or_default()
    };
    name.split('_').map(upper).collect()
}

/// The word `kind` gets the code as a suffix, because there is a field of this name.
pub fn identifier(text: &str, code: &impl Display) -> String {
    let name = text.replace(|letter: char| !letter.is_ascii_alphanumeric(), "_");
    match name.trim_matches('_') {
        "kind" => format!("kind_{code}"),
        name => name.to_owned(),
    }
}

/// `#[name = "value"]`.
fn text_of(attribute: &Attribute, name: &str) -> Option<String> {
    let Meta::NameValue(pair) = &attribute.meta else { return None };
    let Expr::Lit(ExprLit { lit: Lit::Str(text), .. }) = &pair.value else { return None };
    pair.path.is_ident(name).then(|| text.value())
}

pub fn text(attributes: &[Attribute]) -> Option<String> {
    attributes.iter().find_map(|attribute| text_of(attribute, "text"))
}

/// The word in `#[text(doc)]` or `#[text(upper)]`; empty for none.
pub fn text_style(attributes: &[Attribute]) -> String {
    let style = attributes.iter().find_map(|attribute| match &attribute.meta {
        Meta::List(list) if list.path.is_ident("text") => Some(list.tokens.to_string()),
        _ => None,
    });
    style.unwrap_or_default()
}

/// A doc comment in a sentence: `The fingers are stuck.` is `the fingers are stuck`.
pub fn clause(doc: &str) -> String {
    let mut letters = doc.trim_end_matches('.').chars();
    letters.next().map(|first| first.to_lowercase().chain(letters).collect()).unwrap_or_default()
}

pub fn doc(attributes: &[Attribute]) -> Vec<String> {
    attributes
        .iter()
        .filter_map(|attribute| text_of(attribute, "doc"))
        .map(|line| line.trim().to_owned())
        .collect()
}

#[cfg(test)]
mod tests {
    use super::{camel, clause, identifier, words};

    #[test]
    fn names_are_spelt_in_both_ways() {
        assert_eq!(words("LettingGo", '-'), "letting-go");
        assert_eq!(words("Start", '-'), "start");
        assert_eq!(camel("get_object"), "GetObject");
        assert_eq!(camel("goto"), "Goto");
        assert_eq!(identifier("MOVE-TO (slow)", &0), "MOVE_TO__slow");
        assert_eq!(identifier("kind", &2), "kind_2");
        assert_eq!(clause("The fingers are stuck."), "the fingers are stuck");
    }
}
