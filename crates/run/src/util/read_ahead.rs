//! A source that a thread of its own reads ahead: a file is then unpacked while the reader is busy.

use std::io::{BufRead, Error, ErrorKind, Read, Result};
use std::sync::mpsc::{Receiver, sync_channel};
use std::thread;

/// Bytes that are handed over at once.
const BLOCK: usize = 1 << 17;
/// Blocks that may wait for the reader.
const WAITING: usize = 4;

/// A source of bytes that are read ahead.
#[derive(Debug)]
pub(crate) struct ReadAhead {
    blocks: Receiver<Result<Vec<u8>>>,
    block: Vec<u8>,
    /// How many bytes of the block were read.
    read: usize,
    has_ended: bool,
}

impl ReadAhead {
    /// Begins to read the source.
    ///
    /// # Errors
    /// Where the system gives no thread.
    pub fn new(mut source: impl Read + Send + 'static) -> Result<Self> {
        let (sender, blocks) = sync_channel(WAITING);
        let read = move || {
            loop {
                let mut block = Vec::with_capacity(BLOCK);
                let found = source.by_ref().take(BLOCK as u64).read_to_end(&mut block);
                let is_last = block.is_empty() || found.is_err();
                // What came before an error is handed over first; an empty block is the end.
                let block = (found.is_ok() || !block.is_empty()).then_some(Ok(block));
                let mut messages = block.into_iter().chain(found.err().map(Err));
                if !messages.all(|message| sender.send(message).is_ok()) || is_last {
                    return;
                }
            }
        };
        thread::Builder::new().spawn(read)?;
        Ok(Self { blocks, block: Vec::new(), read: 0, has_ended: false })
    }
}

impl BufRead for ReadAhead {
    fn fill_buf(&mut self) -> Result<&[u8]> {
        if self.read == self.block.len() && !self.has_ended {
            // The last block is empty: without one, the thread has not come to the end.
            let lost = |_| Err(Error::new(ErrorKind::BrokenPipe, "the thread that reads it has ended"));
            self.block = self.blocks.recv().unwrap_or_else(lost)?;
            self.read = 0;
            self.has_ended = self.block.is_empty();
        }
        Ok(&self.block[self.read..])
    }

    fn consume(&mut self, bytes: usize) {
        self.read = (self.read + bytes).min(self.block.len());
    }
}

impl Read for ReadAhead {
    fn read(&mut self, buffer: &mut [u8]) -> Result<usize> {
        let bytes = self.fill_buf()?;
        let many = bytes.len().min(buffer.len());
        buffer[..many].copy_from_slice(&bytes[..many]);
        self.consume(many);
        Ok(many)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Bytes, then an error.
    struct Failing(usize);

    impl Read for Failing {
        fn read(&mut self, buffer: &mut [u8]) -> Result<usize> {
            if self.0 == 0 {
                return Err(Error::other("the disk is gone"));
            }
            let many = self.0.min(buffer.len());
            buffer[..many].fill(7);
            self.0 -= many;
            Ok(many)
        }
    }

    #[test]
    fn all_bytes_arrive_in_their_order() {
        for length in [0, 1, BLOCK - 1, BLOCK, 5 * BLOCK + 3] {
            let bytes = (0..length).map(|place| (place % 251) as u8).collect::<Vec<_>>();
            let mut read = Vec::new();
            ReadAhead::new(std::io::Cursor::new(bytes.clone())).unwrap().read_to_end(&mut read).unwrap();
            assert!(read == bytes, "{length} bytes");
        }
    }

    #[test]
    fn what_was_read_before_an_error_arrives_too() {
        let mut source = ReadAhead::new(Failing(BLOCK + 5)).unwrap();
        let mut read = Vec::new();
        let error = source.read_to_end(&mut read).unwrap_err();
        assert_eq!(error.to_string(), "the disk is gone");
        assert_eq!(read, [7; BLOCK + 5]);
    }

    #[test]
    fn nobody_waits_for_a_reader_that_is_gone() {
        drop(ReadAhead::new(std::io::repeat(1)).unwrap());
    }
}
