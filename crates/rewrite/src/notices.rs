//! What is said of a program: warnings that are told once, and why a motion cannot be corrected.

use std::ops::Range;

use correction::CorrectionError;
use diagnostic::{Code, Diagnostic};
use machine_model::SolveError;
use nc_program::Context;
use nc_syntax::Block;
use toolpath::{AXIS_NAMES, Motion};

use crate::job::{
    COMPENSATED, DIRECTION, LEANING_CYCLE, MUST_NOT_SPLIT, NO_BOUNDS_FOR_TURNS, NOT_CONVERGED,
    NOT_WITHIN_TOLERANCE, OTHER_TOOL, OUTSIDE, RAPID_OUTSIDE, SIDEWAYS, SPIRAL, TOO_MANY_PECKS, UNKNOWN_SIDE,
    UNNAMED,
};

/// Things that happen more than once and are told once.
#[derive(Debug, Clone, Default)]
pub(crate) struct Notices {
    pub(crate) clamped: Notice,
    pub(crate) leaning: Notice,
    pub(crate) compensated: Notice,
    pub(crate) unknown_side: Notice,
    pub(crate) spirals: Notice,
}

/// One kind of them.
#[derive(Debug, Clone, Default)]
pub(crate) struct Notice {
    count: u64,
    /// Where it happened first, and that line.
    first: Option<(Range<u64>, u64)>,
    largest_mm: f64,
    /// Where that was.
    at_largest: Option<(Range<u64>, u64)>,
}

/// What is to be said, and the line it is said of.
pub(crate) type Warning = (Diagnostic, u64);

impl Notice {
    pub(crate) fn see(&mut self, span: &Range<u64>, line: u64, size_mm: f64) {
        self.count += 1;
        self.first.get_or_insert_with(|| (span.clone(), line));
        if self.at_largest.is_none() || size_mm > self.largest_mm {
            self.largest_mm = size_mm;
            self.at_largest = Some((span.clone(), line));
        }
    }

    fn add(&mut self, later: &Self) {
        self.count += later.count;
        if self.first.is_none() {
            self.first.clone_from(&later.first);
        }
        if self.at_largest.is_none() || later.largest_mm > self.largest_mm {
            self.largest_mm = later.largest_mm;
            self.at_largest.clone_from(&later.at_largest);
        }
    }

    /// What is to be said where it happened; the message is made of how often, and of the largest, um.
    fn warning(
        &self,
        code: Code,
        message: impl FnOnce(u64, f64) -> String,
        label: &'static str,
        help: &'static str,
    ) -> Option<Warning> {
        let (first, line) = self.first.clone()?;
        let message = message(self.count, self.largest_mm * 1e3);
        Some((Diagnostic::warning(code, message).at(first, label).help(help), line))
    }
}

impl Notices {
    pub(crate) fn add(&mut self, later: &Self) {
        self.clamped.add(&later.clamped);
        self.leaning.add(&later.leaning);
        self.compensated.add(&later.compensated);
        self.unknown_side.add(&later.unknown_side);
        self.spirals.add(&later.spirals);
    }

    pub(crate) fn warnings(&self) -> Vec<Warning> {
        let clamped = self.clamped.warning(
            RAPID_OUTSIDE,
            |count, _| format!("{count} rapid motion(s) end outside the calibrated volume"),
            "the first; it takes the correction of the volume's nearest point",
            "nothing is cut there; calibrate a larger volume if the place matters",
        );
        let leaning = self.leaning.warning(
            LEANING_CYCLE,
            |count, um| format!("{count} hole(s) are off by up to {um:.1} um along their depth"),
            "this cycle is bound to the spindle and cannot be written as moves; its middle was put in place",
            "the machine's drilling axis leans; thread by milling where that matters",
        );
        let compensated = self.compensated.warning(
            COMPENSATED,
            |count, _| format!("{count} motion(s) under cutter compensation"),
            "the programmed contour was corrected, not the path of the tool's centre",
            "between the two lies the tool radius times the error's change per mm (1 um per mm of radius at 1 mrad); post with compensation computed in CAM where that matters, or give a turning tool its nose in the profile",
        );
        let unknown_side = self.unknown_side.warning(
            UNKNOWN_SIDE,
            |count, um| format!("{count} motion(s) with an axis on an unknown side of its play, off by up to {um:.1} um"),
            "the first; the middle of the play was taken, since nothing before tells from where the axis came",
            "say with `--start-at X,Y,Z` where the axes stand at the start; behind a reference return, a tool change (M6) or `/`, feed the axis to its place from one side first",
        );
        let largest = Notice { first: self.spirals.at_largest.clone(), ..self.spirals.clone() };
        let spirals = largest.warning(
            SPIRAL,
            |count, um| format!("{count} arc(s) end off their circle, the largest by {:.3} mm", um * 1e-3),
            "the largest; the control cuts a spiral from the one radius to the other, and that is the path",
            "post with more decimals where that matters",
        );
        [clamped, leaning, compensated, unknown_side, spirals].into_iter().flatten().collect()
    }
}

/// A corrected hole under block delete: what it says would hold for the next holes only where it is executed.
pub(crate) fn hole_skipped(block: &Block<'_>) -> Diagnostic {
    let whole = block.file_range();
    Diagnostic::error(nc_program::codes::BLOCK_DELETE, "a hole that may be skipped has levels of its own after correction")
        .at(whole, "its Z and R differ from those of the holes before, and the next holes would inherit them only where it is executed")
        .help("delete the `/`, or post a program without this hole")
}

/// The word that says where an axis stands before a motion, as `X12.5`.
fn stands_at(axis: usize, motion: &Motion, context: &Context) -> String {
    let start_mm = match motion {
        Motion::Feed(feed) => feed.start.linear_mm,
        Motion::Hole(hole) => hole.start.linear_mm,
        Motion::Rapid { start, .. } | Motion::Uncorrected { end: start } => {
            start.linear_mm.map(Option::unwrap_or_default)
        }
    };
    let place = context.frame.to_program(start_mm)[axis] / context.word_mm(axis);
    let number = format!("{place:.4}");
    let number = number.trim_end_matches('0');
    format!("{}{}", AXIS_NAMES[axis], if number == "-0." { "0." } else { number })
}

/// What to say of a motion with a tool that a field knows nothing of.
pub(crate) fn other_tool(error: &SolveError, whole: std::ops::Range<u64>) -> Diagnostic {
    Diagnostic::error(OTHER_TOOL, error.to_string())
        .at(whole, "moved with this tool")
        .help("measure a field with this tool's length, or use `--engine rigid-body` with tables of angles; before G43 the tool vector is default_mm of the profile")
}

/// What to say of a motion that cannot be corrected.
pub(crate) fn refusal(
    error: &CorrectionError,
    motion: &Motion,
    block: &Block<'_>,
    context: &Context,
) -> Vec<Diagnostic> {
    let whole = block.file_range();
    let word = |letter: u8| block.word(letter).map(|word| block.file_span(word.span));
    let diagnostic = match error {
        CorrectionError::Solve(SolveError::OutsideVolume { axis, value_mm, low_mm, high_mm }) => {
            let span = word(*axis as u8).unwrap_or(whole);
            let what = if matches!(motion, Motion::Hole(_)) { "this hole" } else { "this feed motion" };
            Diagnostic::error(OUTSIDE, format!("{what} leaves the calibrated volume"))
                .at(span, format!("axis {axis} would be commanded to {value_mm:.3} mm, calibrated is {low_mm} to {high_mm} mm"))
                .help(format!(
                    "place the workpiece inside the volume: `--work-offset` with {axis} moved by {:+.3} mm or further, or accept the nearest point's correction with `--outside clamp`",
                    if value_mm < low_mm { low_mm - value_mm } else { high_mm - value_mm }
                ))
        }
        CorrectionError::Solve(error @ SolveError::OutsideVectors { .. }) => {
            Diagnostic::error(OUTSIDE, error.to_string())
                .at(whole, "no vector was measured near enough")
                .help("place the workpiece where vectors were measured with `--work-offset`, measure there, or accept the nearest place's correction with `--outside clamp`")
        }
        CorrectionError::Solve(error @ SolveError::OtherTool { .. }) => other_tool(error, whole),
        CorrectionError::Solve(error @ SolveError::NotConverged { .. }) => {
            Diagnostic::error(NOT_CONVERGED, error.to_string())
                .at(whole, "here")
                .help("an error table with steps this steep is no machine: run `vpost profile check`")
        }
        CorrectionError::Solve(error) => Diagnostic::error(NOT_CONVERGED, error.to_string())
            .at(whole, "here")
            .help("choose another engine with `--engine`"),
        CorrectionError::MustNotSplit { .. } if context.thread => {
            Diagnostic::error(MUST_NOT_SPLIT, error.to_string())
                .at(whole, "a thread must stay one block: it is cut in step with the spindle")
                .help("accept that much with `--tolerance`, or cut the thread uncorrected in a program of its own")
        }
        CorrectionError::MustNotSplit { .. } => Diagnostic::error(MUST_NOT_SPLIT, error.to_string())
            .at(whole, "this block must stay one, with none before it: cutter compensation is active")
            .help("post with compensation computed in CAM, or accept more with `--tolerance`; where an axis with play turns at the start-up, come to it from the side to which it goes on"),
        CorrectionError::TooManyPecks { .. } => Diagnostic::error(TOO_MANY_PECKS, error.to_string())
            .at(word(b'Q').unwrap_or(whole), "far below what a drill bites")
            .help("correct Q: it is the depth of one peck"),
        CorrectionError::Unnamed { axis, .. } => {
            let name = AXIS_NAMES[*axis];
            let since = context.unnamed[*axis].map_or_else(String::new, |lost| format!(" since {}", lost.since()));
            let all = (0..3).filter(|i| context.unnamed[*i].is_some() || i == axis);
            let words: Vec<String> = all.map(|i| stands_at(i, motion, context)).collect();
            Diagnostic::error(UNNAMED, error.to_string())
                .at(
                    whole,
                    format!("{name} is not named{since}; a word for it would rest on a guess of where its zero is"),
                )
                .help(if context.unnamed[*axis].is_some_and(|lost| lost.line == block.line) {
                    format!("write what changes {name} in a block of its own, and behind it a rapid that names {name}")
                } else {
                    let words = words.join(" ");
                    format!("before this block say once where the tool is to be, as in `G90 G0 {words}`")
                })
        }
        CorrectionError::TurnedFrame { .. } => Diagnostic::error(nc_program::codes::FRAME, error.to_string())
            .at(whole, "each word moves several axes here, so that none of them can be held where it stands")
            .help("let the CAM write the rotated coordinates, or accept more with `--tolerance`"),
        CorrectionError::Sideways { distance_um, .. } => Diagnostic::error(SIDEWAYS, error.to_string())
            .at(whole, "before this motion an axis turns")
            .help(format!(
                "no command undoes what changes at once: accept it with `--tolerance {:.1}` or more, or let the axis turn in a rapid above the part",
                (distance_um * 10.0).ceil() / 10.0
            )),
        CorrectionError::NoBoundsForTurns => Diagnostic::error(NO_BOUNDS_FOR_TURNS, error.to_string())
            .at(whole, "this motion")
            .help("use `--engine rigid-body`, and a profile without [[effect]] entries: both other engines and effects have bounds for rotary axes that stand only"),
        CorrectionError::Direction { .. } => Diagnostic::error(DIRECTION, error.to_string())
            .at(whole, "this motion")
            .help("give the rotary axes a finer `resolution_deg` in the profile, if the control takes it; or raise `orientation_urad` under [correction]"),
        CorrectionError::NotWithinTolerance { .. } => Diagnostic::error(NOT_WITHIN_TOLERANCE, error.to_string())
            .at(whole, "this motion")
            .help("the engine's model jumps here (interval methods do at their nodes) or the profile's minimum_segment_mm is too long: use `--engine rigid-body` or `tracker`, or raise `--tolerance`"),
    };
    vec![diagnostic]
}
