//! Words of drawings on a lathe: corners (`,R2.`, `,C1.`) and angles (`,A160.`), written out as lines and arcs.
//!
//! B-64304EN-1, "Direct drawing dimension programming", in the plane of radius and Z. `,A` is the angle of a line from
//! +Z towards +X; with X or Z it gives the other one, alone it needs a next line with `,A`, X and Z, and both meet
//! where their lines cross. `,R` rounds the corner to the next line, `,C` cuts it off by as much along each. Lines
//! alone (G1) have them, between the blocks that P and Q of a cycle name too. What is written has six decimals.
//!
//! A contour's lines are drawn when its cycle reads them.

use diagnostic::{Text, both};
use nc_dialect::{Action, CornerForm, Turning};
use nc_program::modal::{Modal, MotionMode};
use nc_syntax::{Block, Item, ItemKind, Span, Value};
use units::math;

use super::place::{AXES, Code, MILLION, Point, Spot, diameters, plane, spot, standing};
use super::writer::cycle_of;
use crate::came::{Came, Fault};
use crate::known::{Known, Rewriting};
use crate::refusals::drawings;
use crate::shorthand::{Shape, Words, add, number, shown};

/// Two lines whose directions differ by less have no certain crossing, rad.
const PARALLEL_RAD: f64 = 1e-3;

/// True where a block may have words of a drawing: a line's it has, what R of other blocks is their codes say.
pub(super) fn may_draw(block: &Block<'_>, turning: &Turning) -> bool {
    block.items.iter().any(|item| drawn(item, turning.cycles.plain_drawing).is_some())
}

/// Letter and value of a drawing's word; `plain`: without a comma too.
fn drawn(item: &Item, plain: bool) -> Option<(u8, Value)> {
    match item.kind {
        ItemKind::CommaWord { letter, value } => Some((letter, value)),
        ItemKind::Word { letter: letter @ (b'A' | b'C' | b'R'), value } if plain => Some((letter, value)),
        _ => None,
    }
}

/// Writes the lines of drawings among blocks.
pub(super) struct Drawing<'w, 'b, 'a, 'd> {
    blocks: &'b [Came<'a>],
    out: &'w mut Rewriting<'d>,
    /// No motion code in force reaches here.
    open: bool,
    /// The last block of a contour.
    last: Option<usize>,
    /// A, C and R of lines need no comma.
    plain: bool,
}

/// A corner to the next line.
#[derive(Clone, Copy)]
struct Corner {
    round: bool,
    size: f64,
    span: Span,
}

/// A line of a drawing, radius and Z.
#[derive(Clone, Copy)]
struct Line {
    block: usize,
    to: Point,
    angle_rad: Option<f64>,
    /// It leads to where its line meets the next one.
    open: bool,
    corner: Option<Corner>,
    /// G90 is in force.
    absolute: bool,
}

impl<'w, 'b, 'a, 'd> Drawing<'w, 'b, 'a, 'd> {
    pub(super) fn new(blocks: &'b [Came<'a>], out: &'w mut Rewriting<'d>, open: bool) -> Self {
        let plain = out.dialect.turning.as_ref().is_some_and(|turning| turning.cycles.plain_drawing);
        Self { blocks, out, open, last: None, plain }
    }

    /// Writes the blocks of a contour.
    pub(super) fn contour(mut self) -> Result<(), Fault> {
        self.last = self.blocks.len().checked_sub(1);
        let mut at = 0;
        while at < self.blocks.len() {
            let words = self.words(at);
            at = match self.first_drawn(&words) {
                Some(span) => self.lines(at, span)?,
                None => {
                    self.out.block(&self.blocks[at]);
                    at + 1
                }
            };
            self.open &= words.motion().is_none();
        }
        Ok(())
    }

    fn words(&self, at: usize) -> Words<'b, 'a>
    where
        'd: 'b,
    {
        Words::of(&self.blocks[at], self.out.dialect)
    }

    fn drawn<'i>(&self, block: &'i Block<'_>) -> impl Iterator<Item = (&'i Item, u8, Value)> + use<'i> {
        let plain = self.plain;
        block
            .items
            .iter()
            .filter_map(move |item| drawn(item, plain).map(|(letter, value)| (item, letter, value)))
    }

    /// Where the first word of a drawing stands: behind a comma anywhere, without one in a line.
    pub(super) fn first_drawn(&self, words: &Words<'_, '_>) -> Option<Span> {
        if !self.out.dialect.flow.corner_words {
            return None;
        }
        let (first, ..) = self.drawn(words.block).next()?;
        let behind_a_comma =
            self.drawn(words.block).any(|(item, ..)| matches!(item.kind, ItemKind::CommaWord { .. }));
        let is_line = || self.is_line(words, self.out.known.modal()) && cycle_of(words).is_none();
        (behind_a_comma || is_line()).then_some(first.span)
    }

    /// True where a block is a line, in the state behind the codes before it.
    fn is_line(&self, words: &Words<'_, '_>, modal: &Modal) -> bool {
        match words.motion() {
            Some(code) => code == Code::Line,
            None => !self.open && matches!(modal.motion, MotionMode::Line(_)),
        }
    }

    /// Lines that hang on one another, from the block `first` on.
    pub(super) fn lines(&mut self, first: usize, comma: Span) -> Result<usize, Fault> {
        // Where a block was refused, what is known behind it is not what the line starts from.
        if let Some(refused) = self.out.known.refused() {
            return Err(refused);
        }
        let words = self.words(first);
        let [Some(x), Some(z)] = standing(self.out.known.modal()) else {
            return Err(words.fault(drawings::START_NOT_KNOWN, comma));
        };
        if diameters(self.out.known.modal()).is_none() {
            return Err(words.fault(drawings::DIAMETER_OR_RADIUS, comma));
        }
        let start = plane(self.out.known.modal(), [x, z]);
        let mut ahead = self.out.known.clone();
        let mut lines: Vec<Line> = Vec::new();
        let mut at = first;
        loop {
            if at >= self.blocks.len() {
                return Err(refusal(
                    &words,
                    comma,
                    both!("a next line was expected behind it", "за ним ожидалась следующая прямая"),
                ));
            }
            let words = self.words(at);
            at += 1;
            if !words.block.acts() {
                continue;
            }
            let line = self.line(&words, &mut ahead, at - 1, start, &lines)?;
            if let Some(before) = lines.last_mut().filter(|before| before.open) {
                // `open` has an angle, and so has the line behind it.
                let stands = before.to;
                before.to = crossing(stands, before.angle_rad, line.to, line.angle_rad).ok_or_else(|| {
                    refusal(
                        &words,
                        words.whole(),
                        both!("two lines that do not cross", "две прямые, которые не пересекаются"),
                    )
                })?;
                before.open = false;
            }
            let waits = line.open || line.corner.is_some();
            lines.push(line);
            if waits && self.last == Some(at - 1) {
                return Err(refusal(
                    &words,
                    words.whole(),
                    both!("a corner in the last block of a contour", "сопряжение в последнем кадре контура"),
                ));
            }
            if !waits {
                break;
            }
        }
        // A contour's lines stay increments: its G91 must not outlive it.
        let increments = self.last.is_none() && lines.iter().any(|line| !line.absolute);
        if increments {
            if !self.out.known.modal().says_places() {
                self.out.line(b"G90", words.from);
            }
            for line in &mut lines {
                line.absolute = true;
            }
        }
        self.write(start, &lines, first, at)?;
        if increments && !ahead.modal().says_places() {
            self.out.line(b"G91", self.blocks[at - 1].from);
        }
        Ok(at)
    }

    /// One line, with what holds for its block.
    fn line(
        &mut self,
        words: &Words<'_, '_>,
        ahead: &mut Known<'_>,
        block: usize,
        start: Point,
        lines: &[Line],
    ) -> Result<Line, Fault> {
        let span = self.drawn(words.block).next().map_or_else(|| words.whole(), |(item, ..)| item.span);
        let refuse = |label: Text| Err(refusal(words, span, label));
        let before = lines.last();
        let stands = before.map_or(start, |line| line.to);
        let open_before = before.is_some_and(|line| line.open);
        let fits = |action: &Action| {
            matches!(
                action,
                Action::Line
                    | Action::FeedPerMinute
                    | Action::FeedPerRevolution
                    | Action::Absolute
                    | Action::Incremental
                    | Action::Pass { takes_words: false }
            )
        };
        let other = words.actions().any(|(action, _)| !fits(action));
        ahead.written(&words.codes(fits), words.from);
        let modal = ahead.modal();
        if !self.is_line(words, modal) || other {
            return refuse(both!(
                "G1 was expected on both sides, and no other code in the block",
                "по обе стороны ожидалось G1 и никаких других функций в кадре"
            ));
        }
        self.open = false;
        let strange: &[u8] = if self.plain { b"IKT" } else { b"IKRT" };
        if words.skipped() || strange.iter().any(|letter| words.number(*letter).is_some()) {
            return refuse(both!(
                "block delete, T, or a word of an arc stands beside it",
                "рядом с ним пропуск кадра, T или слово дуги"
            ));
        }
        let (mut angle_rad, mut corner) = (None, None);
        for (item, letter, value) in self.drawn(words.block) {
            let Value::Number(number) = value else {
                return refuse(both!("a number was expected", "ожидалось число"));
            };
            let size = words.lengthy(number, modal.units);
            match letter {
                b'A' if angle_rad.is_none() => angle_rad = Some(number.to_f64().to_radians()),
                b'R' | b'C' if corner.is_none() && size > 0.0 => {
                    corner = Some(Corner { round: letter == b'R', size, span: item.span });
                }
                _ => {
                    return refuse(both!(
                        "one angle `,A` and one corner, `,R` or `,C` above zero, can be written out",
                        "развернуть можно один угол `,A` и одно сопряжение: `,R` или `,C` больше нуля"
                    ));
                }
            }
        }
        let named = [[b'X', b'U'], [b'Z', b'W']]
            .map(|letters| letters.iter().any(|letter| words.number(*letter).is_some()));
        let increments = b"UW".iter().any(|letter| words.number(*letter).is_some()) || !modal.says_places();
        let [Some(x), Some(z)] = words.target(modal, spot(modal, stands).map(Some)) else {
            return refuse(both!("where it leads is not known", "неизвестно, куда она ведёт"));
        };
        let place = plane(modal, [x, z]);
        let absolute = modal.says_places();
        let line = |to: Point, open: bool| Ok(Line { block, to, angle_rad, open, corner, absolute });
        if open_before {
            return match (angle_rad, named) {
                (Some(_), [true, true]) if !increments => line(place, false),
                _ => refuse(both!(
                    "behind a line with an angle alone, `,A`, X and Z were expected",
                    "за прямой, заданной одним углом, ожидались `,A`, X и Z"
                )),
            };
        }
        match (angle_rad, named) {
            (None, [false, false]) => refuse(both!("a line was expected", "ожидалась прямая")),
            (None, _) => line(place, false),
            (Some(_), [true, true]) => refuse(both!(
                "an angle beside X and Z: one of the three is too many",
                "угол рядом с X и Z: одно из трёх лишнее"
            )),
            (Some(_), [false, false]) => line(stands, true),
            (Some(angle), [x_named, _]) => {
                let (sin, cos) = math::sin_cos(angle);
                let (given, other) = if x_named { (0, 1) } else { (1, 0) };
                let direction = [sin, cos];
                if direction[given].abs() < PARALLEL_RAD {
                    return refuse(both!(
                        "at this angle the line never gets to that place",
                        "под этим углом прямая туда не приходит"
                    ));
                }
                let mut to = place;
                to[other] =
                    stands[other] + (place[given] - stands[given]) / direction[given] * direction[other];
                line(to, false)
            }
        }
    }

    fn spot(&self, place: Point) -> Spot {
        spot(self.out.known.modal(), place)
    }

    /// Writes the lines and their corners, and the blocks between them.
    fn write(&mut self, start: Point, lines: &[Line], first: usize, behind: usize) -> Result<(), Fault> {
        let mut stands = start;
        let mut says_line = false;
        let mut lines_ahead = lines.iter().zip(lines.iter().skip(1).map(Some).chain([None])).peekable();
        for index in first..behind {
            let block = &self.blocks[index];
            let Some((line, next)) = lines_ahead.next_if(|(line, _)| line.block == index) else {
                self.out.block(block);
                continue;
            };
            let words = self.words(index);
            let behind = |stands: Point| if line.absolute { None } else { Some(self.spot(stands)) };
            let (Some(corner), Some(next)) = (line.corner, next) else {
                self.replaced(block, behind(stands), line.to, says_line);
                (stands, says_line) = (line.to, false);
                continue;
            };
            // First Z, then X: so turns the plane of G18.
            let turn = |p: Point| [p[1], p[0]];
            let form = if corner.round { CornerForm::Round } else { CornerForm::Chamfer };
            let shape = Shape::of(turn(stands), turn(line.to), turn(next.to), form, corner.size);
            let Some(shape) = shape else {
                return Err(refusal(
                    &words,
                    corner.span,
                    both!(
                        "the lines are too short for it, or go straight on or back",
                        "прямые для него слишком коротки или идут прямо вперёд или назад"
                    ),
                ));
            };
            let [begins, ends, centre] = [shape.from, shape.to, shape.centre].map(turn);
            let (from_stands, from_begins) = (behind(stands), behind(begins));
            self.replaced(block, from_stands, begins, says_line);
            let mut text = if !corner.round {
                b"G1".to_vec()
            } else if shape.left {
                b"G3".to_vec()
            } else {
                b"G2".to_vec()
            };
            self.place(&mut text, from_begins, ends);
            if corner.round {
                let here = plane(self.out.known.modal(), self.spot(begins));
                for (letter, k) in [(b'I', 0), (b'K', 1)] {
                    number(&mut text, letter, centre[k] - here[k]);
                }
            }
            self.out.line(&text, block.from);
            (stands, says_line) = (ends, true);
        }
        Ok(())
    }

    /// The words of a place: under G91 counted from another.
    fn place(&self, text: &mut Vec<u8>, counted_from: Option<Spot>, to: Point) {
        let (to, zero) = (self.spot(to), counted_from.unwrap_or_default());
        for axis in 0..2 {
            number(text, AXES[axis], (to[axis] - zero[axis]) as f64 / MILLION);
        }
    }

    /// The block as a comment, then the block with a place instead of its own words.
    fn replaced(&mut self, came: &Came<'_>, counted_from: Option<Spot>, to: Point, says_line: bool) {
        let block = &came.block;
        self.out.comment(shown(block), came.from);
        let own = |item: &&Item| match item.kind {
            _ if drawn(item, self.plain).is_some() => true,
            ItemKind::Word { letter: b'X' | b'Z' | b'U' | b'W', .. } => true,
            ItemKind::Word { letter: b'G', value: Value::Number(_) } => {
                let words = Words::of(came, self.out.dialect);
                let own = |action: &Action| {
                    *action == Action::Line || (counted_from.is_none() && *action == Action::Incremental)
                };
                words.actions().any(|(action, span)| span == item.span && own(action))
            }
            _ => false,
        };
        let of_block = Words::of(came, self.out.dialect);
        let is_line = of_block.actions().any(|(action, _)| *action == Action::Line);
        let kept: Vec<&[u8]> =
            block.items.iter().filter(|item| !own(item)).map(|item| block.text(item.span)).collect();
        let (numbered, rest): (Vec<&[u8]>, Vec<&[u8]>) =
            kept.into_iter().partition(|text| text[0].eq_ignore_ascii_case(&b'N'));
        let mut text = numbered.join(&b' ');
        add(&mut text, if is_line || says_line { b"G1" } else { b"" });
        self.place(&mut text, counted_from, to);
        for part in rest {
            add(&mut text, part);
        }
        self.out.line(&text, came.from);
    }
}

/// Where two lines through points under angles cross.
fn crossing(a: Point, a_rad: Option<f64>, b: Point, b_rad: Option<f64>) -> Option<Point> {
    let direction = |angle: f64| {
        let (sin, cos) = math::sin_cos(angle);
        [sin, cos]
    };
    let (u, v) = (direction(a_rad?), direction(b_rad?));
    let sine = u[0] * v[1] - u[1] * v[0];
    if sine.abs() < PARALLEL_RAD {
        return None;
    }
    let share = ((b[0] - a[0]) * v[1] - (b[1] - a[1]) * v[0]) / sine;
    Some([a[0] + share * u[0], a[1] + share * u[1]])
}

fn refusal(words: &Words<'_, '_>, span: Span, label: Text) -> Fault {
    words.fault(drawings::drawing(label), span)
}
