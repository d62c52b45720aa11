//! The output as it grows: the mark of the correction in its place, its hash, and whether it differs from the input.

use std::io::{self, Read, Write};

/// Takes the output of a program, chunk after chunk.
pub(crate) struct Sink<W> {
    out: W,
    hasher: Option<blake3::Hasher>,
    /// Bytes that were written.
    bytes: u64,
    /// Leading bytes of the input that came out as they went in: they are not written before one differs, since
    /// a program that comes out as it went in gets no mark.
    same: u64,
    changed: bool,
    /// The mark, and the bytes of output before it.
    mark: Option<(u64, Vec<u8>)>,
}

/// What was written.
pub(crate) struct Written {
    pub(crate) bytes: u64,
    pub(crate) hash: Option<blake3::Hash>,
    pub(crate) changed: bool,
}

impl<W: Write> Sink<W> {
    pub(crate) fn new(out: W, hasher: Option<blake3::Hasher>, mark: (u64, Vec<u8>)) -> Self {
        Self { out, hasher, bytes: 0, same: 0, changed: false, mark: Some(mark) }
    }

    /// The next part of the program and what became of it; `input` opens the program anew.
    pub(crate) fn put<R: Read>(
        &mut self,
        before: &[u8],
        after: &[u8],
        input: impl FnOnce() -> io::Result<R>,
    ) -> io::Result<()> {
        if !self.changed {
            if before == after {
                self.same += before.len() as u64;
                return Ok(());
            }
            self.changed = true;
            self.copy(input)?;
        }
        self.write(after)
    }

    /// Ends the output; where nothing was changed it is all the `length` bytes of the input.
    pub(crate) fn finish<R: Read>(
        mut self,
        input: impl FnOnce() -> io::Result<R>,
        length: u64,
    ) -> io::Result<Written> {
        if !self.changed {
            (self.mark, self.same) = (None, length);
            self.copy(input)?;
        }
        if let Some((_, line)) = self.mark.take() {
            self.write(&line)?;
        }
        self.out.flush()?;
        let hash = self.hasher.map(|hasher| hasher.finalize());
        Ok(Written { bytes: self.bytes, hash, changed: self.changed })
    }

    /// Writes the part of the input that came out as it went in.
    fn copy<R: Read>(&mut self, input: impl FnOnce() -> io::Result<R>) -> io::Result<()> {
        if self.same == 0 {
            return Ok(());
        }
        let mut input = input()?.take(self.same);
        let mut part = vec![0; 1 << 16];
        loop {
            match input.read(&mut part)? {
                0 => return Ok(()),
                read => self.write(&part[..read])?,
            }
        }
    }

    fn write(&mut self, mut bytes: &[u8]) -> io::Result<()> {
        if let Some((at, _)) = self.mark
            && at <= self.bytes + bytes.len() as u64
            && let Some((_, line)) = self.mark.take()
        {
            let (head, rest) = bytes.split_at((at - self.bytes) as usize);
            self.write(head)?;
            self.write(&line)?;
            bytes = rest;
        }
        if let Some(hasher) = &mut self.hasher {
            hasher.update(bytes);
        }
        self.bytes += bytes.len() as u64;
        self.out.write_all(bytes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn put(parts: &[(&[u8], &[u8])]) -> (Vec<u8>, bool) {
        let input: Vec<u8> = parts.iter().flat_map(|part| part.0.to_vec()).collect();
        let mut out = Vec::new();
        let mut sink = Sink::new(&mut out, None, (3, b"(M)\n".to_vec()));
        for (before, after) in parts {
            sink.put(before, after, || Ok(&input[..])).unwrap();
        }
        let written = sink.finish(|| Ok(&input[..]), input.len() as u64).unwrap();
        assert_eq!(written.bytes, out.len() as u64);
        (out, written.changed)
    }

    #[test]
    fn the_mark_stands_in_its_place_wherever_the_first_change_is() {
        assert_eq!(put(&[(b"%1\nX1\n", b"%1\nX2\n")]), (b"%1\n(M)\nX2\n".to_vec(), true));
        assert_eq!(put(&[(b"%1\n", b"%1\n"), (b"X1\n", b"X2\n")]), (b"%1\n(M)\nX2\n".to_vec(), true));
        assert_eq!(put(&[(b"%", b"%"), (b"1\nX1\n", b"1\nX2\n"), (b"M2", b"M2")]).0, b"%1\n(M)\nX2\nM2");
    }

    #[test]
    fn what_comes_out_as_it_went_in_has_no_mark() {
        assert_eq!(put(&[(b"%1\n", b"%1\n"), (b"X1\n", b"X1\n")]), (b"%1\nX1\n".to_vec(), false));
    }
}
