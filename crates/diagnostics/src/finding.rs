//! A diagnostic field by field, for editors and scripts.

use serde::Serialize;

use crate::Diagnostic;

/// One finding.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct Finding {
    /// `error` or `warning`.
    pub severity: &'static str,
    /// Stable short name of the kind of problem.
    pub code: String,
    /// The file, relative to the data directory. A file that could not be read has its given path.
    pub file: String,
    /// `OFFSET`, if the finding is in a block.
    pub offset: Option<u32>,
    /// `BLOCK#`, if the finding is in a block.
    pub block: Option<u32>,
    /// Line of the block from 0, as the manual counts, or of the file from 1 where there is no block.
    pub line: Option<u32>,
    /// Column from 1.
    pub column: Option<u32>,
    /// Number of bytes of the underlined text.
    pub length: Option<u32>,
    /// File, block, line and column as text.
    pub place: String,
    /// The path of the entry in a TOML file.
    pub entry: Option<String>,
    /// One sentence that states the found and the expected value.
    pub message: String,
    /// What was expected.
    pub expected: Option<String>,
    /// The found value, if the message compares it with the expected one.
    pub found: Option<String>,
    /// The nearest known name.
    pub nearest: Option<String>,
    /// What to do.
    pub help: Option<String>,
}

impl From<&Diagnostic> for Finding {
    fn from(diagnostic: &Diagnostic) -> Self {
        let owned = |text: Option<&str>| text.map(str::to_owned);
        Self {
            severity: diagnostic.severity().text(),
            code: diagnostic.code().to_owned(),
            file: diagnostic.file().to_owned(),
            offset: diagnostic.block().map(|block| block.offset),
            block: diagnostic.block().map(|block| block.number),
            line: diagnostic.line(),
            column: diagnostic.column(),
            length: diagnostic.length(),
            place: diagnostic.place(),
            entry: owned(diagnostic.entry()),
            message: diagnostic.message().to_owned(),
            expected: owned(diagnostic.expected()),
            found: owned(diagnostic.found()),
            nearest: owned(diagnostic.nearest()),
            help: owned(diagnostic.help()),
        }
    }
}
