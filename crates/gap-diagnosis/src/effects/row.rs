//! The row of an effect: every field is given, so that none is forgotten.

use diagnostic::Text;

/// What is known of an effect, whatever its axes and the data.
pub(crate) struct Effect {
    /// In Russian; in English its id.
    pub(crate) name: &'static str,
    /// What it does, as a metrologist would say it.
    pub(crate) words: fn(&Size<'_>) -> Text,
    /// One sentence for the shop floor.
    pub(crate) remedy: Text,
    pub(crate) search: Search,
}

/// How the search treats it.
pub(crate) struct Search {
    pub(crate) along: Along,
    /// How large its coefficients usually are, in their unit: what assembly leaves between axes, and what an instrument's
    /// temperature does to a scale, is hundreds of µrad and µm/m; an angle of a carriage changes by tens of µrad on its way (20
    /// arc seconds are a bad one), and a screw errs by some µm within a turn. Infinite where it looks like no other.
    pub(crate) usual: f64,
    /// Coefficients that no machine has, far beyond what wear, crashes and bad assembly do, and why.
    pub(crate) most: Option<(f64, Why)>,
    pub(crate) searched: Searched,
}

/// Why a cause cannot be meant, in English and in Russian.
pub(crate) type Why = [&'static str; 2];

/// How an effect lies along [`machine_model::effects::EffectKind::axis`].
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Along {
    /// In proportion to its place.
    Line,
    /// A curve.
    Curve,
    /// A curve, through a lever that other axes change.
    Angle,
    /// A curve, its slope through a lever.
    Droop,
    /// By the direction from which its place was approached.
    Reversal,
    /// At a place.
    Place,
    /// By something else, or by more.
    Elsewhere,
}

/// What the search may change of an effect's shape.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Searched {
    Nothing,
    Period,
    TimeConstants,
    Moment,
    Centre,
    CentreAndWidth,
    /// Over which a spike fades.
    Way,
}

/// How large an effect is, and where.
pub(crate) struct Size<'a> {
    /// What stands behind the point of its id, without the E of a symbol.
    pub(crate) of: &'a str,
    /// `X` of one axis, `X` and `Y` of two, `Y` and `X` of what shows along Y as X moves.
    pub(crate) a: &'a str,
    pub(crate) b: &'a str,
    /// The first number, and the same without its sign: whole, a tenth, twice.
    pub(crate) first: f64,
    pub(crate) size: f64,
    pub(crate) per_100_mm: f64,
    pub(crate) twice: f64,
    /// From the least to the most that it displaces, µm.
    pub(crate) swing: f64,
    pub(crate) pitch_mm: f64,
    pub(crate) tau_min: f64,
    /// When it came: at a time, or from a line of the file on.
    pub(crate) moment: &'a Text,
    pub(crate) centre_mm: f64,
    pub(crate) width_mm: f64,
    /// Until a spike is gone.
    pub(crate) way_mm: f64,
}
