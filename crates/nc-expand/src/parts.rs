//! Shorthand written out part by part, for a program of any size.

use nc_dialect::Dialect;
use nc_program::Setup;
use nc_syntax::{Block, Envelope, Place, Reader};

use crate::came::{Came, From};
use crate::known::Rewriting;
use crate::lowering::Driver;
use crate::output::PlainPart;
use crate::statement::flows;

/// Writes the shorthand of a program out, part by part: what [`crate::expand`] writes of all of it at once.
pub struct Lowering<'d> {
    dialect: &'d Dialect,
    envelope: Envelope,
    driver: Driver<'d>,
    expects_name: bool,
}

/// The program has flow, or what cannot be written out: it is to be read as a whole, which says why.
#[derive(Debug)]
pub struct AsAWhole;

impl<'d> Lowering<'d> {
    /// Of a program that starts with `head` and lies in its `envelope`. `None` for lathes: their cycles name blocks
    /// anywhere in a program.
    #[must_use]
    pub fn new(dialect: &'d Dialect, setup: &'d Setup, head: &[u8], envelope: Envelope) -> Option<Self> {
        let mut driver = Driver::new(dialect, setup, head);
        driver.out()?.wake();
        Some(Self { dialect, envelope, driver, expects_name: false })
    }

    /// What the next whole lines stand for, as far as nothing behind them bears on it; they start so many bytes and
    /// lines into the program.
    ///
    /// # Errors
    /// [`AsAWhole`].
    pub fn part(&mut self, text: &[u8], offset: u64, line: u64) -> Result<PlainPart, AsAWhole> {
        let place = Place { offset, line, expects_name: self.expects_name };
        let mut reader = Reader::part(text, self.dialect, self.envelope, place);
        let mut block = Block::default();
        while reader.next(&mut block) {
            self.driver.block(&Came { from: From::of(&block), block: block.clone() });
            if self.driver.failed() || (!self.driver.closed && flows(&block, self.dialect)) {
                return Err(AsAWhole);
            }
        }
        self.expects_name = reader.expects_name();
        self.driver.out().map(Rewriting::take).ok_or(AsAWhole)
    }

    /// What the program ends with.
    ///
    /// # Errors
    /// [`AsAWhole`]: also where it had no shorthand.
    pub fn end(self) -> Result<PlainPart, AsAWhole> {
        let mut lowered = self.driver.end(0).map_err(|_| AsAWhole)?;
        if lowered.lowers { Ok(lowered.out.take_all()) } else { Err(AsAWhole) }
    }
}
