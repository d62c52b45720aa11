//! Between the wings: corrected pieces become edits of words.

use correction::{Centre, Goal, PieceKind, Stated};
use nc_dialect::{Action, Dialect};
use nc_emit::{Piece, WordEdit, WordEdits};
use nc_program::{Context, DirectionWords};
use nc_syntax::{Block, GCode, Letters};
use smallvec::SmallVec;
use toolpath::{Feed, Hole, Motion, PeckRetreats, RotaryChain, Shape};
use units::decimal::{self, Decimal, Spelling};

/// The dialect's own codes for the motions that correction writes.
#[derive(Debug, Clone, Copy)]
pub(crate) struct MotionCodes {
    rapid: GCode,
    line: GCode,
    clockwise: GCode,
    counter_clockwise: GCode,
    dwell: GCode,
}

impl MotionCodes {
    /// G1.
    pub(crate) const fn line(&self) -> GCode {
        self.line
    }

    /// G2, G3.
    pub(crate) fn is_arc(&self, code: GCode) -> bool {
        [self.clockwise, self.counter_clockwise].contains(&code)
    }

    /// From the dialect's table; codes it lacks keep their usual numbers and are never written.
    pub(crate) fn of(dialect: &Dialect) -> Self {
        let find = |action: Action, usual: u16| dialect.row_of(&action).map_or(GCode(usual), |row| row.code);
        Self {
            rapid: find(Action::Rapid, 0),
            line: find(Action::Line, 10),
            clockwise: find(Action::ArcClockwise, 20),
            counter_clockwise: find(Action::ArcCounterClockwise, 30),
            dwell: find(Action::Dwell, 40),
        }
    }
}

/// A word with its point, without zeros behind the last figure that counts: `X10.`, `P0.05`.
pub(crate) fn word(letter: u8, Decimal { mantissa, decimals }: Decimal) -> String {
    let mut text = vec![letter];
    decimal::write(&mut text, mantissa, decimals, Spelling { trailing_zeros: false, ..Spelling::FIXED });
    String::from_utf8_lossy(&text).into_owned()
}

/// The letters of a block's words; those of the axes also where U or W stands for them.
pub(crate) fn letters(block: &Block<'_>, context: &Context) -> Letters {
    let own = block.words().filter(|word| word.letter.is_ascii_uppercase());
    own.fold(Letters::of_axes(context.by_increment), |letters, word| letters.or(Letters::of(&[word.letter])))
}

/// What these letters state.
pub(crate) fn stated(letters: Letters) -> Stated {
    let each = |names: &[u8; 3]| names.map(|letter| letters.contains(letter));
    Stated {
        axes: each(b"XYZ"),
        rotary: each(b"ABC"),
        centre: each(b"IJK"),
        radius: letters.contains(b'R'),
        turns: letters.contains(b'P'),
    }
}

/// P and Q of a hole whose cycle is not the code in force in the output, those apart that its block says.
pub(crate) fn lost(
    dialect: &Dialect,
    in_force: Option<GCode>,
    motion: &Motion,
    (context, letters): (&Context, Letters),
) -> WordEdits {
    /// Of a peck, so that inches are what they were.
    const DECIMALS: u8 = 4;
    let row = in_force.and_then(|code| dialect.code(code));
    let Motion::Hole(Hole { cycle, plane, .. }) = motion else { return WordEdits::new() };
    if row.is_some_and(|row| matches!(row.action, Action::Cycle(_))) {
        return WordEdits::new();
    }
    let peck = cycle.peck_mm.filter(|_| cycle.kind.takes_q()).map(|mm| {
        let steps = mm / context.word_mm(plane.axes()[2]) * f64::from(10u32.pow(DECIMALS.into()));
        Decimal { mantissa: units::decimal::round(steps), decimals: DECIMALS }
    });
    let said_before =
        [(b'P', cycle.dwell), (b'Q', peck)].into_iter().filter(|(letter, _)| !letters.contains(*letter));
    let edit = |word: Decimal| WordEdit::Write { counts: word.mantissa, decimals: word.decimals };
    said_before.filter_map(|(letter, word)| Some((letter, edit(word?)))).collect()
}

/// How the control's pecks go back.
pub(crate) fn retreats(dialect: &Dialect) -> PeckRetreats {
    let output = &dialect.output;
    PeckRetreats { clearance_mm: output.peck_clearance_mm, chip_mm: output.chip_retreat_mm }
}

/// What a block made the axes do, as far as its words have a meaning of their own.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Original {
    Straight,
    Arc,
    /// By control points.
    Curve,
    Cycle,
}

impl Original {
    pub(crate) fn of(motion: &Motion) -> Self {
        match motion {
            Motion::Feed(Feed { shape: Shape::Arc(_), .. }) => Self::Arc,
            Motion::Feed(Feed { shape: Shape::Bezier(_), .. }) => Self::Curve,
            Motion::Hole(_) => Self::Cycle,
            _ => Self::Straight,
        }
    }
}

/// Decimals of a direction that is written as a vector: a tenth of a microradian.
pub(crate) const VECTOR_DECIMALS: u8 = 7;

/// The words of a direction that stand for rotary words of a piece.
///
/// * `goals` – of A, B, C, of which `at_deg` is where they stand, and then where the piece leads
/// * `own` – where the block's own direction leads, degrees, and which of its words are written
fn direction_goals(
    chain: &RotaryChain,
    goals: [Goal; 3],
    block: &correction::Block,
    at_deg: &mut [f64; 3],
    own: ([f64; 3], [bool; 3]),
) -> [Goal; 3] {
    let (own_deg, written) = own;
    for axis in 0..3 {
        let step_deg = 1.0 / f64::from(10u32.pow(u32::from(block.rotary_decimals[axis].min(9))));
        at_deg[axis] = match goals[axis] {
            Goal::Stays => at_deg[axis],
            Goal::AsStated => own_deg[axis],
            Goal::Steps(counts) if block.incremental == [true; 3] => at_deg[axis] + counts as f64 * step_deg,
            Goal::Steps(counts) => counts as f64 * step_deg,
        };
    }
    if goals.contains(&Goal::AsStated) && !goals.iter().any(|goal| matches!(goal, Goal::Steps(_))) {
        return written.map(|written| if written { Goal::AsStated } else { Goal::Stays });
    }
    if goals == [Goal::Stays; 3] {
        return goals;
    }
    let scale = f64::from(10u32.pow(u32::from(VECTOR_DECIMALS)));
    chain.tool_direction(*at_deg).map(|part| Goal::Steps(units::decimal::round(part * scale)))
}

/// What stands for a block; a hole written as moves has four.
pub(crate) type Pieces = SmallVec<[Piece; 4]>;

/// Writes pieces of one motion as edits of its block.
#[derive(Debug, Clone)]
pub(crate) struct Editing<'a> {
    pub codes: &'a MotionCodes,
    pub context: &'a Context,
    /// Letters of the block the pieces come from.
    pub letters: Letters,
    /// What the block made the axes do.
    pub original: Original,
    /// Decimals of X, Y, Z in program units.
    pub decimals: [u8; 3],
    /// Those of A, B, C words that a piece has of its own.
    pub rotary_decimals: [u8; 3],
    /// What stands for the rotary words where the block says where the tool points by a vector.
    pub direction: Option<(DirectionWords, [Goal; 3])>,
    /// F under G93 and the decimals it is written with.
    pub inverse_time: Option<f64>,
    /// The same where the program's F is a speed.
    pub by_time: Option<f64>,
    pub decimals_feed: u8,
    /// P of the cycle, where a dwell must be written.
    pub dwell: Option<Decimal>,
    /// Words of a cycle that the output has left for moves, and that hold no longer there.
    pub lost: WordEdits,
}

/// How a piece stands for its block.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Stands {
    /// Nothing else does.
    Alone,
    /// It is the block itself, whose other words are still there.
    First,
    /// Behind others.
    Further,
}

impl Stands {
    /// Of one of several pieces.
    pub(crate) const fn at(index: usize) -> Self {
        if index == 0 { Self::First } else { Self::Further }
    }
}

impl Editing<'_> {
    pub(crate) fn edit(&self, piece: &correction::Piece, stands: Stands) -> Piece {
        let mut edited = Piece { motion: None, words: WordEdits::new() };
        let mut push = |letter: u8, word: Goal, decimals: u8| {
            let edit = match word {
                Goal::Stays if stands != Stands::Further && self.letters.contains(letter) => WordEdit::Remove,
                Goal::Stays => return,
                Goal::AsStated => WordEdit::Keep,
                Goal::Steps(counts) => WordEdit::Write { counts, decimals },
            };
            edited.words.push((letter, edit));
        };
        if piece.kind != PieceKind::Dwell {
            for axis in 0..3 {
                let names = if self.context.by_increment[axis] { b"UVW" } else { b"XYZ" };
                push(names[axis], piece.axes[axis], self.decimals[axis]);
            }
        }
        if let Some((named, goals)) = self.direction.filter(|_| piece.rotary.is_some()) {
            for (letter, goal) in named.letters().into_iter().zip(goals) {
                push(letter, goal, VECTOR_DECIMALS);
            }
        } else {
            for (axis, word) in piece.rotary.into_iter().flatten().enumerate() {
                push(b"ABC"[axis], word, self.rotary_decimals[axis]);
            }
        }
        let [u, v, n] = self.context.plane.axes();
        edited.motion = match piece.kind {
            PieceKind::Rapid | PieceKind::Line => {
                // The words of the arc or cycle that this was have no meaning on a straight move.
                let own: &[u8] = match self.original {
                    Original::Straight => b"",
                    Original::Arc => b"IJKRP",
                    Original::Curve => b"IJKLPQR",
                    Original::Cycle => b"IJKRQPL",
                };
                own.iter().for_each(|letter| push(*letter, Goal::Stays, 0));
                match piece.kind {
                    PieceKind::Rapid => Some(self.codes.rapid),
                    _ if self.context.thread => self.context.motion_code,
                    _ => Some(self.codes.line),
                }
            }
            PieceKind::Arc { clockwise, centre } => {
                match centre {
                    Centre::Offsets(offsets) => {
                        push(b"IJK"[u], offsets[0], self.decimals[u]);
                        push(b"IJK"[v], offsets[1], self.decimals[v]);
                        push(b'R', Goal::Stays, 0);
                    }
                    Centre::Radius(radius) => push(b'R', radius, self.decimals[u]),
                }
                if stands != Stands::Alone {
                    // P counts whole turns, which the pieces now make themselves.
                    push(b'P', Goal::Stays, 0);
                }
                Some(if clockwise { self.codes.clockwise } else { self.codes.counter_clockwise })
            }
            PieceKind::Cycle { r } => {
                push(b'R', r, self.decimals[n]);
                edited.words.extend(self.lost.iter().copied());
                self.context.motion_code
            }
            PieceKind::AsStated => self.context.motion_code,
            PieceKind::Dwell => {
                push(b'G', Goal::Steps(i64::from(self.codes.dwell.0 / 10)), 0);
                self.dwell.iter().for_each(|p| push(b'P', Goal::Steps(p.mantissa), p.decimals));
                None
            }
        };
        let rate = self.by_time.or(self.inverse_time.filter(|_| stands != Stands::Alone));
        if let (Some(rate), PieceKind::Line | PieceKind::Arc { .. }) = (rate, piece.kind) {
            let steps = f64::from(10u32.pow(u32::from(self.decimals_feed)));
            let counts = units::decimal::counts(rate / piece.share.max(1e-9), steps).unwrap_or(i64::MAX);
            edited.words.push((b'F', WordEdit::Write { counts, decimals: self.decimals_feed }));
        }
        edited
    }

    /// The pieces of the only motion of a block.
    ///
    /// * `at_deg` – where the rotary axes stand before each
    pub(crate) fn edit_only(
        mut self,
        pieces: &[correction::Piece],
        motion: &Motion,
        info: &correction::Block,
        chain: &RotaryChain,
        at_deg: &mut [f64; 3],
    ) -> Pieces {
        let edit = |(k, piece): (usize, &correction::Piece)| {
            if let (Some(named), Some(goals)) = (self.context.direction, piece.rotary) {
                let written = named.letters().map(|letter| self.letters.contains(letter));
                let own = (rotary_end_deg(motion), written);
                self.direction = Some((named, direction_goals(chain, goals, info, at_deg, own)));
            }
            self.edit(piece, if pieces.len() == 1 { Stands::Alone } else { Stands::at(k) })
        };
        pieces.iter().enumerate().map(edit).collect()
    }
}

/// Words of rotary axes may be finer than the output step: what is left of them behind a split is too.
pub(crate) fn finer_than_words(info: &mut correction::Block, feed: &Feed) {
    /// No angle is programmed finer.
    const MOST: u8 = 9;
    for axis in 0..3 {
        let [from, to] = [feed.start, feed.end].map(|place| place.rotary_deg[axis]);
        let word = if info.incremental == [true; 3] { to - from } else { to };
        let whole = |decimals: u8| {
            let steps = word * f64::from(10u32.pow(u32::from(decimals)));
            (steps - steps.round()).abs() < 1e-9 * steps.abs().max(1.0)
        };
        while from != to && info.rotary_decimals[axis] < MOST && !whole(info.rotary_decimals[axis]) {
            info.rotary_decimals[axis] += 1;
            info.rotary_step[axis] *= 10;
        }
    }
}

/// Where the rotary axes stand behind a motion by the program, degrees.
fn rotary_end_deg(motion: &Motion) -> [f64; 3] {
    match motion {
        Motion::Feed(feed) => feed.end.rotary_deg,
        Motion::Hole(hole) => hole.at_r.rotary_deg,
        Motion::Rapid { end, .. } | Motion::Uncorrected { end, .. } => end.rotary_deg,
    }
}
