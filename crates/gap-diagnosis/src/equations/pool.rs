//! Products of every column that was ever asked about, over all equations of a file.
//!
//! A search runs several times on nearly the same equations: outliers are left out, and some come back. The products of all
//! equations are made once, and those of the few rows left out are taken off. A search asks for few of them: of the columns in
//! a model with all, and of columns of one kind with one another; two forms of different effects that are in no model never
//! meet.

use crate::equations::columns::Kept;
use crate::equations::columns::Source;
use crate::equations::gram::Gram;
use crate::equations::term::Term;

/// All columns so far and their products.
pub(crate) struct Pool<'a> {
    source: Source<'a>,
    gram: Gram,
    /// Columns that are or were in a model: their products with all others are known.
    core: Vec<bool>,
    kept: Kept<'a>,
}

impl<'a> Pool<'a> {
    /// No columns yet.
    pub(crate) fn new(source: &Source<'a>) -> Self {
        Self { source: *source, gram: Gram::new(Vec::new(), source), core: Vec::new(), kept: Kept::default() }
    }

    /// Where the equations come from: all of them.
    pub(crate) fn source(&self) -> &Source<'a> {
        &self.source
    }

    /// Positions of some columns; those that are not known yet are taken in.
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
        // The set-up is in every model.
        let (effects, set_up): (Vec<Term>, Vec<Term>) =
            new.into_iter().partition(|term| term.kind().is_some());
        debug_assert!(set_up.is_empty() || known == 0, "the set-up comes first");
        if !set_up.is_empty() {
            self.gram.extend(set_up, &self.source);
            self.core.resize(self.gram.terms.len(), true);
        }
        if !effects.is_empty() {
            self.gram.extend_beside(&self.core, effects, &self.source, &mut self.kept);
            self.core.resize(self.gram.terms.len(), false);
        }
        positions
    }

    /// Makes the products of some columns, as those of a model, with all others known; true where they were not.
    pub(crate) fn complete(&mut self, positions: &[usize]) -> bool {
        let new: Vec<usize> = positions.iter().copied().filter(|i| !self.core[*i]).collect();
        if !new.is_empty() {
            self.gram.complete(&new, &self.source, &mut self.kept);
            new.iter().for_each(|i| self.core[*i] = true);
        }
        !new.is_empty()
    }

    /// Products of the columns at some positions.
    pub(crate) fn select(&self, positions: &[usize]) -> Gram {
        self.gram.select(positions)
    }
}
