//! Products of every column that was ever asked about, over all equations of a file.
//!
//! A search runs several times on nearly the same equations: outliers are left out, and some come back. The products of all
//! equations are made once, and those of the few rows left out are taken off.

use crate::columns::Kept;
use crate::gram::{Gram, Source};
use crate::term::Term;

/// All columns so far and their products.
pub(crate) struct Pool<'a> {
    source: Source<'a>,
    gram: Gram,
    kept: Kept<'a>,
}

impl<'a> Pool<'a> {
    /// No columns yet.
    #[must_use]
    pub(crate) fn new(source: &Source<'a>) -> Self {
        Self { source: *source, gram: Gram::new(Vec::new(), source), kept: Kept::default() }
    }

    /// Where the equations come from: all of them.
    #[must_use]
    pub(crate) fn source(&self) -> &Source<'a> {
        &self.source
    }

    /// Positions of some columns; those that are not known yet are taken in.
    #[must_use]
    pub(crate) fn positions(&mut self, terms: &[Term]) -> Vec<usize> {
        let known = self.gram.terms.len();
        let mut new: Vec<Term> = Vec::new();
        let positions = terms
            .iter()
            .map(|term| {
                let all = self.gram.terms.iter().chain(&new);
                all.into_iter().position(|t| t == term).unwrap_or_else(|| {
                    new.push(*term);
                    known + new.len() - 1
                })
            })
            .collect();
        if !new.is_empty() {
            self.gram.extend(new, &self.source, &mut self.kept);
        }
        positions
    }

    /// Products of the columns at some positions.
    #[must_use]
    pub(crate) fn select(&self, positions: &[usize]) -> Gram {
        self.gram.select(positions)
    }
}
