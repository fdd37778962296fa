use diagnostics::At;
use rcs_core::name::Name16;

use super::super::lex::Word;

pub(super) struct Fields<'a, 'w> {
    pub(super) words: &'w [Word<'a>],
    pub(super) next: usize,
}

impl<'a, 'w> Fields<'a, 'w> {
    pub(super) const fn new(words: &'w [Word<'a>]) -> Self {
        Self { words, next: 0 }
    }

    pub(super) const fn more(&self) -> bool {
        self.next < self.words.len()
    }

    pub(super) fn take(&mut self) -> Option<Word<'a>> {
        let word = self.words.get(self.next).copied();
        self.next += 1;
        word
    }

    pub(super) fn take_if(&mut self, text: &str) -> Option<Word<'a>> {
        let word = self.words.get(self.next).copied().filter(|word| word.text == text)?;
        self.next += 1;
        Some(word)
    }

    pub(super) fn at(&self) -> At {
        self.words.get(self.next).or_else(|| self.words.last()).map_or_else(At::default, |w| w.at)
    }
}

#[derive(Clone, Copy)]
pub(super) struct Number {
    pub(super) value: i32,
    pub(super) at: At,
}

#[derive(Clone, Copy)]
pub(super) struct Field {
    pub(super) name: Name16,
    pub(super) at: At,
}

impl Field {
    pub(super) fn given(&self) -> bool {
        !self.name.is_empty()
    }

    pub(super) fn named(&self) -> Option<Name16> {
        self.given().then_some(self.name)
    }
}

impl Number {
    pub(super) fn given(&self) -> Option<i32> {
        Some(self.value).filter(|value| *value != 0)
    }
}
