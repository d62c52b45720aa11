//! What parameters of a lathe's control say of its cycles.

/// Which depth of a thread's passes begins where its cycle starts; deeper ones begin further along the thread, by what
/// they are deeper times the tangent of half the tip's angle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FlankFrom {
    /// None: as if it had no depth.
    Start,
    /// That of the first pass.
    FirstPass,
    /// That of the last pass.
    LastPass,
}

/// How far a peck of a lathe's drilling cycle goes back.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DrillPecks {
    /// To R, out of the hole.
    Full,
    /// By the return alone: the chip breaks.
    Chip,
}

/// What R of a lathe's drilling cycle is in systems B and C.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DrillR {
    /// A place under G90, a way under G91.
    Place,
    /// A way from the start, always.
    Way,
}

/// Parameters of a lathe's control that decide how its cycles move; what is not said is not guessed.
///
/// ```
/// // Nobody has said any of them.
/// assert_eq!(toolpath::TurningParameters::default().roughing_escape_mm, None);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TurningParameters {
    /// Length of the chamfer at the end of a thread, in leads (Fanuc's parameter 5130 counts tenths).
    pub thread_chamfer_leads: Option<f64>,
    /// Angle of that chamfer to the axis, degrees (parameter 5131; 45 where not said).
    pub thread_chamfer_deg: Option<f64>,
    /// By how much G71 and G72 leave the contour behind a pass, radius, mm (parameter 5133).
    pub roughing_escape_mm: Option<f64>,
    /// By how much G74 and G75 go back behind a peck, mm (parameter 5139).
    pub groove_return_mm: Option<f64>,
    /// Finishing passes of a thread in one block (parameter 5142), a whole number.
    pub thread_finishing_passes: Option<f64>,
    /// Its least infeed, radius, mm (5140).
    pub thread_least_mm: Option<f64>,
    /// Its finishing allowance, radius, mm (5141).
    pub thread_allowance_mm: Option<f64>,
    /// From where passes move along the flank.
    pub thread_flank_from: Option<FlankFrom>,
    /// How far a peck of G83 goes back (parameter 5101.2).
    pub drill_pecks: Option<DrillPecks>,
    /// By how much it does, or stays off what is drilled, mm (parameter 5114).
    pub drill_return_mm: Option<f64>,
    /// What R of drilling cycles is (parameter 5102.6 of systems B and C; controls that follow Fanuc have theirs in A).
    pub drill_r: Option<DrillR>,
    /// Feed out of a hole that G85 bores, in per cent of F (parameter 5121; 0 there is 200).
    pub bore_return_percent: Option<f64>,
    /// G41 and G42 between P and Q hold in finishing alone: roughing leaves its allowance at the tip as programmed.
    pub nose_in_finishing: bool,
    /// A, C and R of a line are words of a drawing without a comma too (parameter 3405.4).
    pub plain_drawing: bool,
}
