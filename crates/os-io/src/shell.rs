//! Words of a command line that a person pastes into a shell.

use std::{ffi::OsStr, os::unix::ffi::OsStrExt as _};

use crate::text::is_control_or_mark;

/// An argument as one word of a shell. Control characters, marks that reverse text, and bytes that are not text become
/// numbers in `$'...'`, so that a terminal shows the real word.
#[must_use]
pub fn word(argument: impl AsRef<OsStr>) -> String {
    let bytes = argument.as_ref().as_bytes();
    match str::from_utf8(bytes) {
        Ok(text) if !text.is_empty() && text.chars().all(is_plain) => text.to_owned(),
        Ok(text) if !text.chars().any(is_control_or_mark) => format!("'{}'", text.replace('\'', r"'\''")),
        _ => numbered(bytes),
    }
}

/// A path as one word of a shell. It is never read as an option.
#[must_use]
pub fn path(path: impl AsRef<OsStr>) -> String {
    let path = path.as_ref();
    let is_option = path.as_bytes().first() == Some(&b'-');
    let word = |path: &OsStr| word(path);
    if is_option {
        let mut here = OsStr::new("./").to_owned();
        here.push(path);
        return word(&here);
    }
    word(path)
}

fn is_plain(character: char) -> bool {
    character.is_alphanumeric() || "/._-+=:,@%".contains(character)
}

fn numbered(bytes: &[u8]) -> String {
    let mut out = String::from("$'");
    for chunk in bytes.utf8_chunks() {
        for character in chunk.valid().chars() {
            match character {
                '\n' => out.push_str(r"\n"),
                '\t' => out.push_str(r"\t"),
                '\'' | '\\' => out.extend(['\\', character]),
                _ if is_control_or_mark(character) => {
                    octal(&mut out, character.encode_utf8(&mut [0; 4]).as_bytes());
                }
                _ => out.push(character),
            }
        }
        octal(&mut out, chunk.invalid());
    }
    out.push('\'');
    out
}

fn octal(out: &mut String, bytes: &[u8]) {
    for byte in bytes {
        out.push_str(&format!(r"\{byte:03o}"));
    }
}

#[cfg(test)]
mod tests {
    use std::{ffi::OsString, os::unix::ffi::OsStringExt as _, process::Command};

    use super::*;

    const WORDS: [(&[u8], &str); 10] = [
        (b"runs/linkbar-2.mcap", "runs/linkbar-2.mcap"),
        (b"it's $HOME", r"'it'\''s $HOME'"),
        (b"", "''"),
        (b"a b", "'a b'"),
        (b"a\nb\tc", r"$'a\nb\tc'"),
        (b"\x1b[31m7'\\", r"$'\033[31m7\'\\'"),
        ("a\u{202e}b".as_bytes(), r"$'a\342\200\256b'"),
        ("ä\u{9b}2".as_bytes(), r"$'ä\302\2332'"),
        (b"\xff0", r"$'\3770'"),
        (b"=x:~", "'=x:~'"),
    ];

    #[test]
    fn bash_reads_each_word_as_the_argument() {
        for (argument, expected) in WORDS {
            let argument = OsString::from_vec(argument.to_vec());
            let word = word(&argument);
            assert_eq!(word, expected);
            let read = Command::new("bash").args(["-c", &format!("printf %s {word}")]).output().unwrap();
            assert_eq!(OsString::from_vec(read.stdout), argument, "{word}");
        }
    }

    #[test]
    fn a_path_is_never_an_option() {
        assert_eq!(path("-x.mcap"), "./-x.mcap");
        assert_eq!(path("x.mcap"), "x.mcap");
    }
}
