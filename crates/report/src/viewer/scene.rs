//! What a viewer draws.

/// A displacement, µm.
pub type Displacement = [f32; 3];

/// A place of the path, and where the tool really is when it should be there.
#[derive(Clone, Debug, PartialEq)]
pub struct Place {
    /// Where the tool should be, mm.
    pub at_mm: [f64; 3],
    /// Line of the motion that leads here, or the number of a row.
    pub line: u64,
    /// A stretch begins here: nothing leads from the place before to this one.
    pub begins: bool,
    /// A motion ends here.
    pub ends: bool,
    /// How far the tool leaves the motion at most, before and after, µm.
    pub off_um: [f32; 2],
    /// Where the tool is after, is not known.
    pub unknown_after: bool,
    /// Real place minus [`Place::at_mm`]: before, after, then what each cause makes of the first.
    pub displaced_um: Vec<Displacement>,
}

/// Displacements in front of those of the causes.
pub const BEFORE: usize = 0;
/// The second of them.
pub const AFTER: usize = 1;
/// The first cause.
pub const CAUSES: usize = 2;

/// A cause that can be switched off.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Cause {
    /// What kind: a key of `words.rs`.
    pub kind: &'static str,
    /// Which one, as in the profile: `EC0Y`, `X`, `thermal.X`.
    pub symbol: String,
    /// The same in Russian, where it is another word.
    pub russian: Option<String>,
}

/// Places in the order of the program, with what was left out of them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scene {
    /// Causes in the order of the displacements.
    pub causes: Vec<Cause>,
    /// What is drawn.
    pub places: Vec<Place>,
    /// How many places there were.
    pub of: usize,
    /// Every place that was left out lies no farther from what is drawn, µm.
    pub path_bound_um: f64,
    /// No displacement there is farther from that between the places that are drawn, µm.
    pub displaced_bound_um: f64,
    /// By how much the causes, each for itself, do not add up to the whole at most, µm.
    pub remainder_um: f64,
}

impl Scene {
    /// The box around the path, mm.
    #[must_use]
    pub fn ranges_mm(&self) -> [(f64, f64); 3] {
        self.places.iter().fold([(f64::INFINITY, f64::NEG_INFINITY); 3], |mut ranges, place| {
            for (range, mm) in ranges.iter_mut().zip(place.at_mm) {
                *range = (range.0.min(mm), range.1.max(mm));
            }
            ranges
        })
    }

    /// The largest displacement before, µm.
    #[must_use]
    pub fn largest_um(&self) -> f64 {
        let size = |d: &Displacement| d.iter().map(|um| f64::from(*um).powi(2)).sum::<f64>().sqrt();
        self.places.iter().map(|place| size(&place.displaced_um[BEFORE])).fold(0.0, f64::max)
    }

    /// How much larger than they are displacements are drawn at first: the largest as an eighth of the path's size, or
    /// less, 1, 2, 5, 10 … times.
    #[must_use]
    pub fn magnification(&self) -> f64 {
        let largest_um = self.largest_um();
        let square: f64 = self.ranges_mm().iter().map(|(low, high)| (high - low).powi(2)).sum();
        let wanted = square.sqrt() * 1e3 / 8.0 / largest_um;
        if !(wanted.is_finite() && wanted > 1.0) {
            return 1.0;
        }
        let above = crate::scale::nice(wanted);
        if above > 1.001 * wanted { crate::scale::nice(above / 2.5) } else { above }
    }
}
