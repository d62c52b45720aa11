//! A search under way: the equations, the library as it grows, the model so far.

use machine_model::effects::EffectKind;

use crate::equations::columns::Source;
use crate::equations::gram::Gram;
use crate::equations::noise::quantum_um;
use crate::equations::observation::Measurements;
use crate::equations::pool::Pool;
use crate::equations::term::Term;
use crate::library::candidates::{Library, Part};
use crate::search::bounds::Bounds;
use crate::search::doubt::Setting;
use crate::search::explanation::{Explanation, Refused};
use crate::search::proposals::Pitches;
use crate::search::space::{Fit, Space};

/// A search under way.
pub(crate) struct State<'a, 'b> {
    pub(super) source: &'a Source<'a>,
    pub(super) without: &'a [EffectKind],
    pub(super) library: Library,
    pool: &'a mut Pool<'b>,
    /// The equations left out, and their products.
    lost: (Source<'a>, Gram),
    /// Where the columns of the library are in the pool.
    positions: Vec<usize>,
    pub(super) pitches: [Pitches; 3],
    pub(super) space: Space,
    pub(super) parts: Vec<Part>,
    pub(super) fit: Fit,
    pub(super) refused: Option<Refused>,
    pub(super) bounds: Bounds,
    /// What the search counts with beside the scatter of the rows kept.
    pub(super) setting: Setting,
    /// Least variance of a reading, µm²: that of the display's step.
    pub(super) floor: f64,
}

impl<'a, 'b> State<'a, 'b> {
    /// Begins with the model of `start`, or with nothing.
    pub(super) fn new(
        data: &'a Measurements,
        source: &'a Source<'a>,
        pool: &'a mut Pool<'b>,
        lost: Source<'a>,
        without: &'a [EffectKind],
        setting: Setting,
        start: Option<Explanation>,
    ) -> Self {
        let (library, parts, refused) = start.map_or_else(
            || (Library::new(data, without, setting.clamping), Vec::new(), None),
            |s| (s.library, s.parts, s.refused),
        );
        let gone = Gram::new(library.terms.clone(), &lost);
        let positions = pool.positions(&library.terms);
        let own = library.model_columns(&parts);
        pool.complete(&own.iter().map(|c| positions[*c]).collect::<Vec<usize>>());
        let space = Space::new(pool.select(&positions).without(&gone), library.nuisances);
        let fit = space.fit(&library, &parts);
        let pitches = [0, 1, 2].map(|axis| Pitches::new(source, axis));
        let lost = (lost, gone);
        let bounds = Bounds::new(data, source.scalars);
        let floor = (quantum_um(source.scalars).powi(2) / 12.0).max(1e-12);
        Self {
            source,
            without,
            library,
            pool,
            lost,
            positions,
            pitches,
            space,
            parts,
            fit,
            refused,
            bounds,
            setting,
            floor,
        }
    }

    /// New columns with their products, and those of the model with all, then everything whitened again.
    pub(super) fn grow(&mut self) {
        let known = self.space.gram.terms.len();
        self.complete(&self.parts.clone());
        if self.library.terms.len() > known {
            self.fit = self.space.fit(&self.library, &self.parts);
        }
    }

    /// The same for a model that is only tried.
    pub(super) fn complete(&mut self, parts: &[Part]) {
        let known = self.space.gram.terms.len();
        let new: Vec<Term> = self.library.terms[known..].to_vec();
        self.positions.extend(self.pool.positions(&new));
        let own = self.library.model_columns(parts);
        let completed = self.pool.complete(&own.iter().map(|c| self.positions[*c]).collect::<Vec<usize>>());
        if !new.is_empty() || completed {
            let (source, gone) = &mut self.lost;
            gone.extend(new, source);
            self.space.grow(self.pool.select(&self.positions).without(gone));
        }
    }

    pub(super) fn uses(&self, kind: EffectKind) -> bool {
        self.parts.iter().any(|p| self.library.kind(*p) == kind)
    }
}
