//! The file to which a log is written.
//!
//! Flushed data survive the end of the program, but not a power failure. A run in real time therefore waits for the
//! disk with every flush, once per second, in the thread of the log.

use std::{
    fs::File,
    io::{self, BufWriter, Seek, SeekFrom, Write},
};

const BUFFER: usize = 64 * 1024;

pub struct Sink {
    file: BufWriter<Whole>,
    durable: bool,
}

/// A file that must not become shorter than the data written to it. After a truncation it would contain zeros.
struct Whole {
    file: File,
    length: u64, // bytes
}

impl Write for Whole {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let found = self.file.metadata()?.len();
        if found < self.length {
            let length = self.length;
            return Err(io::Error::other(format!(
                "another program cut the file to {found} bytes, it had {length}"
            )));
        }
        let written = self.file.write(bytes)?;
        self.length = self.length.max(self.file.stream_position()?);
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

impl Seek for Whole {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.file.seek(to)
    }
}

impl Sink {
    /// A sink into `file`. In a durable sink, flushed data are on the disk.
    #[must_use]
    pub fn new(file: File, durable: bool) -> Self {
        Self { file: BufWriter::with_capacity(BUFFER, Whole { file, length: 0 }), durable }
    }
}

impl Write for Sink {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()?;
        if self.durable { self.file.get_ref().file.sync_data() } else { Ok(()) }
    }
}

impl Seek for Sink {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.file.seek(to)
    }

    /// The default implementation would flush, which is not necessary for the position.
    fn stream_position(&mut self) -> io::Result<u64> {
        self.file.stream_position()
    }
}
