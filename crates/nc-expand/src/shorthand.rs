//! Shorthand of drawings: polar words (G16), a rotation about the tool (`G68 R30.`) and corners (`,R5.`, `,C2.`;
//! `RND=5`, `CHR=2`, `CHF=2`) written out as plain blocks.
//!
//! Both say where the tool goes by something that only the control works out. What they mean is told by the
//! manuals for the plain case, and only that is written out; the rest is refused:
//!
//! * Polar: in G90, about the program's zero, both words named once, then each held until it is named again:
//!   first axis = radius · cos angle, second = radius · sin angle.
//! * Corner between two lines of the plane, in G90, the next line in the next block. With u and v the unit vectors from
//!   the corner along the two lines and θ the angle between them, a chamfer of c goes from c·u to c·v, and a rounding
//!   of r from t·u to t·v with t = r / tan(θ/2), about the tangent point's r to the inside. A chamfer of length l has c
//!   = l / (2 sin(θ/2)).
//!
//! The numbers written have 6 decimals; what that neglects is half a nanometre.

use diagnostic::{Refusal, Text, both};
use nc_dialect::{Action, Called, CornerForm, Dialect};
use nc_program::Owner;
use nc_program::modal::{Modal, Units};
use nc_syntax::{Block, GCode, Item, ItemKind, Number, Span, Value};
use units::math;

use crate::came::{Came, Fault, From, Held, Refused};
use crate::known::{Known, Motion, Rewriting, motion};
use crate::output::{Style, word};
use crate::refusals::drawings as refusal;

/// X, Y, Z.
pub(crate) const AXES: [u8; 3] = *b"XYZ";
/// Below this the two lines of a corner are one line, or run back on each other, rad. Controls treat such a corner
/// as none.
const STRAIGHT_RAD: f64 = 0.0175;
/// By so much a tangent point may lie behind the start of its line, in units of the program: rounded ends.
const BEHIND: f64 = 1e-6;

/// True where the block has shorthand that this dialect writes out.
pub(crate) fn needed(block: &Block<'_>, dialect: &Dialect) -> bool {
    if !(dialect.flow.corner_words || dialect.flow.polar_words || dialect.flow.called) {
        return false;
    }
    block.items.iter().any(|item| match item.kind {
        ItemKind::CommaWord { .. } => dialect.flow.corner_words,
        ItemKind::BracketCommand => corner_form(block.text(item.span), dialect).is_some(),
        ItemKind::Word { letter: b'G', value: Value::Number(number) } => match action(number, dialect) {
            Some(Action::PolarOn) => true,
            Some(Action::RotationOn) => turns_about_the_tool(block, dialect),
            _ => false,
        },
        _ => false,
    })
}

/// `G68 R30.`: the rotation's centre is where the tool stands.
fn turns_about_the_tool(block: &Block<'_>, dialect: &Dialect) -> bool {
    dialect.frames.rotation_about_tool
        && !block.words().any(|word| AXES.contains(&word.letter) || b"IJK".contains(&word.letter))
}

/// The form of a corner that a command names.
fn corner_form(command: &[u8], dialect: &Dialect) -> Option<CornerForm> {
    match dialect.command(command)?.action {
        Some(Action::Called(Called::Corner(form))) => Some(form),
        _ => None,
    }
}

pub(crate) fn action(number: Number, dialect: &Dialect) -> Option<&Action> {
    number.tenths().and_then(|tenths| dialect.code(GCode(tenths))).map(|entry| &entry.action)
}

/// What the G codes of a block say.
pub(crate) fn actions<'b>(
    block: &'b Block<'_>,
    dialect: &'b Dialect,
) -> impl Iterator<Item = (&'b Action, Span)> {
    block.items.iter().filter_map(|item| match item.kind {
        ItemKind::Word { letter: b'G', value: Value::Number(number) } => {
            Some((action(number, dialect)?, item.span))
        }
        _ => None,
    })
}

/// A line that ends in a corner, waiting for the next one.
#[derive(Debug)]
struct Corner<'d> {
    block: Held,
    from: [f64; 2],
    to: [f64; 2],
    form: CornerForm,
    size: f64,
    place: Span,
    /// The arc of an earlier corner stands before it, so that it must say that it is a line.
    behind_corner: bool,
    /// What is known behind it, its corner apart.
    behind: Known<'d>,
}

/// Words and codes of a block.
#[derive(Clone, Copy)]
pub(crate) struct Words<'b, 'a> {
    pub(crate) block: &'b Block<'a>,
    pub(crate) dialect: &'b Dialect,
    /// Whom the block stands for.
    pub(crate) from: From,
}

impl<'b, 'a> Words<'b, 'a> {
    pub(crate) const fn of(came: &'b Came<'a>, dialect: &'b Dialect) -> Self {
        Self { block: &came.block, dialect, from: came.from }
    }
}

impl Words<'_, '_> {
    pub(crate) fn number(&self, letter: u8) -> Option<(Number, Span)> {
        self.block.items.iter().find_map(|item| match item.kind {
            ItemKind::Word { letter: found, value: Value::Number(number) } if found == letter => {
                Some((number, item.span))
            }
            _ => None,
        })
    }
    pub(crate) fn length(&self, letter: u8, units: Units) -> Option<f64> {
        self.number(letter).map(|(number, _)| self.lengthy(number, units))
    }
    pub(crate) fn lengthy(&self, number: Number, units: Units) -> f64 {
        self.dialect.numbers.length(number, units == Units::Inch).to_f64()
    }
    /// The words of some letters, as they stand.
    pub(crate) fn texts(&self, letters: &[u8]) -> Vec<u8> {
        let mut text = Vec::new();
        for (_, span) in letters.iter().filter_map(|letter| self.number(*letter)) {
            add(&mut text, self.block.text(span));
        }
        text
    }
    /// Where the words of a motion lead from where the axes stand.
    pub(crate) fn end(&self, modal: &Modal) -> [Option<f64>; 3] {
        let stands = modal.places();
        [0, 1, 2].map(|axis| match self.length(AXES[axis], modal.units) {
            None => stands[axis],
            Some(value) if modal.says_places() => Some(value),
            Some(value) => stands[axis].map(|at| at + value),
        })
    }
    pub(crate) fn actions(&self) -> impl Iterator<Item = (&Action, Span)> {
        actions(self.block, self.dialect)
    }
    /// `,R5.`, `RND=5`
    pub(crate) fn corner(&self) -> Option<&Item> {
        self.block.items.iter().find(|item| self.is_corner(item))
    }
    fn is_corner(&self, item: &Item) -> bool {
        match item.kind {
            ItemKind::CommaWord { .. } => self.dialect.flow.corner_words,
            ItemKind::BracketCommand => corner_form(self.block.text(item.span), self.dialect).is_some(),
            _ => false,
        }
    }
    /// Its form and size, in units of the program, where they are plain.
    fn corner_size(&self, item: &Item, units: Units) -> Option<(CornerForm, f64)> {
        match item.kind {
            ItemKind::CommaWord { letter, value: Value::Number(size) } => {
                let form = match letter {
                    b'R' => CornerForm::Round,
                    b'C' => CornerForm::Chamfer,
                    _ => return None,
                };
                Some((form, self.lengthy(size, units)))
            }
            ItemKind::BracketCommand => {
                let text = self.block.text(item.span);
                let value = &text[text.iter().position(|byte| *byte == b'=')? + 1..];
                let value = crate::siemens::plain_number(std::str::from_utf8(value).ok()?.trim())?;
                Some((corner_form(text, self.dialect)?, value))
            }
            _ => None,
        }
    }
    pub(crate) fn skipped(&self) -> bool {
        self.block.items.iter().any(|item| item.kind == ItemKind::Skip)
    }
    /// Nothing but names and comments.
    pub(crate) fn idle(&self) -> bool {
        self.block.items.iter().all(|item| matches!(item.kind, ItemKind::Comment | ItemKind::Name))
    }
    pub(crate) fn whole(&self) -> Span {
        whole(self.block)
    }
    pub(crate) fn fault(&self, refusal: Refusal, span: Span) -> Fault {
        let place = self.from.place(u64::from(span.start)..u64::from(span.end));
        Box::new(Refused { diagnostic: refusal.at(place), file: self.from.file })
    }
}

const NOT_KNOWN: Text = Text::pair(
    "where the line starts or ends is not known",
    "неизвестно, где начинается или кончается прямая",
);

/// Writes drawings' words out, block by block.
#[derive(Debug)]
pub(crate) struct Corners<'d> {
    out: Rewriting<'d>,
    /// G16: radius and angle in degrees, once named.
    polar: Option<[Option<f64>; 2]>,
    /// A line with a corner, and what stands between it and the next line.
    waiting: Option<Corner<'d>>,
    between: Vec<Held>,
}

impl<'d> Corners<'d> {
    pub(crate) const fn new(out: Rewriting<'d>) -> Self {
        Self { out, polar: None, waiting: None, between: Vec::new() }
    }

    pub(crate) const fn dialect(&self) -> &'d Dialect {
        self.out.dialect
    }

    /// What is known behind what came, a corner that waits apart.
    pub(crate) fn known(&self) -> &Known<'d> {
        self.waiting.as_ref().map_or(&self.out.known, |corner| &corner.behind)
    }

    /// First and second axis of the plane, and its normal.
    fn plane(&self) -> [usize; 3] {
        self.out.known.modal().plane.axes()
    }

    pub(crate) const fn out(&mut self) -> &mut Rewriting<'d> {
        &mut self.out
    }

    pub(crate) fn came(&mut self, came: &Came<'_>) -> Result<(), Fault> {
        let words = Words::of(came, self.dialect());
        match self.waiting.take() {
            Some(corner) if words.idle() => {
                self.between.push(Held::of(came));
                self.waiting = Some(corner);
            }
            Some(corner) => self.waiting = self.next_line(&corner, came)?,
            None if self.polar.is_none() && !needed(&came.block, self.dialect()) => self.out.block(came),
            None => {
                self.out.wake();
                self.waiting = self.block(came)?;
            }
        }
        Ok(())
    }

    pub(crate) fn fresh_line(&mut self) {
        let waits = self.waiting.as_mut().map(|corner| &mut corner.block);
        match self.between.last_mut().or(waits) {
            Some(held) => held.end_line(self.out.marks.line_ending),
            None => self.out.fresh_line(),
        }
    }

    /// Text that stands for a block that came, as the next one.
    pub(crate) fn write(&mut self, text: &[u8], from: From) -> Result<(), Fault> {
        for came in Came::all(text, self.dialect(), From { exact: false, ..from }) {
            self.came(&came)?;
        }
        Ok(())
    }

    /// The same on a line of its own.
    pub(crate) fn line(&mut self, text: &[u8], from: From) -> Result<(), Fault> {
        self.fresh_line();
        self.write(&[text, self.out.marks.line_ending].concat(), from)
    }

    /// A comment on a line of its own.
    pub(crate) fn comment(&mut self, text: &[u8], from: From) -> Result<(), Fault> {
        let Some(comment) = self.out.marks.comment(text) else { return Ok(()) };
        self.fresh_line();
        self.write(&comment, from)
    }

    pub(crate) fn end(self) -> (Rewriting<'d>, Result<(), Fault>) {
        let ended = self.waiting.map_or(Ok(()), |corner| {
            let came = corner.block.came();
            let words = Words::of(&came, self.out.dialect);
            let label = both!("nothing follows", "дальше ничего нет");
            Err(words.fault(refusal::without_next_line(label), corner.place))
        });
        (self.out, ended)
    }

    /// A block that follows no corner.
    fn block(&mut self, came: &Came<'_>) -> Result<Option<Corner<'d>>, Fault> {
        let words = Words::of(came, self.dialect());
        if words.corner().is_some() {
            let known = self.out.known.clone();
            let [first, second, _] = known.modal().plane.axes();
            let start = [first, second].map(|axis| known.modal().places()[axis]);
            return self.corner(came, start, known).map(Some);
        }
        let rotates = words.actions().find(|(action, _)| **action == Action::RotationOn);
        if let Some((_, span)) = rotates.filter(|_| turns_about_the_tool(&came.block, self.dialect())) {
            return self.rotation(&words, span).map(|()| None);
        }
        let turns_on = words.actions().find(|(action, _)| **action == Action::PolarOn);
        if self.polar.is_some() || turns_on.is_some() {
            self.polar(came, turns_on.map(|(_, span)| span))?;
            return Ok(None);
        }
        self.out.block(came);
        Ok(None)
    }

    /// A rotation about where the tool stands: the control would take the corrected place for it.
    fn rotation(&mut self, words: &Words<'_, '_>, span: Span) -> Result<(), Fault> {
        let ([first, second, _], at) = (self.plane(), self.out.known.modal().places());
        let [Some(u), Some(v)] = [at[first], at[second]] else {
            return Err(words.fault(refusal::ROTATION_WITHOUT_CENTRE, span));
        };
        let block = words.block;
        let mut centre = b" ".to_vec();
        self.point(&mut centre, [u, v]);
        let end = span.end as usize;
        let text = [&block.bytes[..end], &centre, &block.bytes[end..]].concat();
        self.out.comment(shown(block), words.from);
        self.out.write(&text, words.from);
        Ok(())
    }

    /// A line with a corner from a place that is known, to be written once the next one is known.
    ///
    /// `known`: what is known before it, the corner of another line apart.
    fn corner(
        &self,
        came: &Came<'_>,
        start: [Option<f64>; 2],
        known: Known<'d>,
    ) -> Result<Corner<'d>, Fault> {
        let (block, words) = (&came.block, Words::of(came, self.dialect()));
        let Some(item) = words.corner() else {
            return Err(words.fault(refusal::without_next_line(Text::EMPTY), Span { start: 0, end: 0 }));
        };
        let span = item.span;
        let refuse = |label: Text| words.fault(refusal::corner(label), span);
        let mut behind = known;
        let here = behind.codes(block).map(|(modal, _)| modal);
        let Some((form, size)) = words.corner_size(item, behind.modal().units) else {
            return Err(refuse(both!(
                "only a rounding or a chamfer with a number can, one in a block",
                "развернуть можно только скругление или фаску с числом, одно в кадре"
            )));
        };
        if block.items.iter().filter(|item| words.is_corner(item)).count() > 1 {
            return Err(refuse(both!("two corners in one block", "два сопряжения в одном кадре")));
        }
        if let Some(here) = &here {
            self.plain_line(&words, here, span)?;
            let [Some(_), Some(_)] = start else {
                return Err(refuse(both!(
                    "where the line starts is not known: name both axes of the plane before it, in G90",
                    "неизвестно, откуда начинается прямая: назовите до неё обе оси плоскости при G90"
                )));
            };
        }
        if size <= 0.0 {
            return Err(refuse(both!("its size must be above zero", "размер должен быть больше нуля")));
        }
        behind.block(came);
        let (Some(here), None) = (here, behind.refused()) else {
            return Err(behind.refused().unwrap_or_else(|| refuse(NOT_KNOWN)));
        };
        let (target, plane) = (words.end(&here), here.plane.axes());
        let place = |[u, v]: [Option<f64>; 2]| Some([u?, v?]);
        let ends = place(start).zip(place([target[plane[0]], target[plane[1]]]));
        let Some((from, to)) = ends else { return Err(refuse(NOT_KNOWN)) };
        Ok(Corner { block: Held::of(came), from, to, form, size, place: span, behind_corner: false, behind })
    }

    /// Refuses what is no line of the plane in G90; `span` says where.
    fn plain_line(&self, words: &Words<'_, '_>, here: &Modal, span: Span) -> Result<(), Fault> {
        let plane = here.plane.axes();
        let normal = AXES[plane[2]];
        let command = |item: &Item| item.kind == ItemKind::BracketCommand && !words.is_corner(item);
        let others = words.block.items.iter().any(command)
            || words.actions().any(|(action, _)| !matches!(action, Action::Line | Action::Absolute));
        let moves = plane[..2].iter().any(|axis| words.number(AXES[*axis]).is_some());
        let label = if motion(here) != Motion::Line {
            both!("G1 was expected on both sides of a corner", "по обе стороны сопряжения ожидалось G1")
        } else if !here.says_places() {
            both!("under G91; write G90", "при G91; напишите G90")
        } else if self.polar.is_some() {
            both!("under G16; write the points in X and Y", "при G16; напишите точки в X и Y")
        } else if words.skipped() {
            both!("behind block delete there are two corners", "в кадре с пропуском сопряжений два")
        } else if others {
            both!("another code stands in a block of the corner", "в кадре сопряжения стоит другая функция")
        } else if words.number(normal).is_some() || b"ABCUVWIJKR".iter().any(|l| words.number(*l).is_some()) {
            both!(
                "a word that leaves the plane, or belongs to an arc",
                "слово, которое уводит из плоскости или относится к дуге"
            )
        } else if !moves {
            both!("a line in the plane was expected", "ожидалась прямая в плоскости")
        } else {
            return Ok(());
        };
        Err(words.fault(refusal::corner(label), span))
    }

    /// Writes the line with the corner, what lies between, the corner, and this line.
    fn next_line(&mut self, corner: &Corner<'d>, came: &Came<'_>) -> Result<Option<Corner<'d>>, Fault> {
        let (block, words) = (&came.block, Words::of(came, self.dialect()));
        let held = corner.block.came();
        let at = Words::of(&held, self.dialect());
        let further = words.corner().is_some();
        let whole = block.items.first().map_or(Span { start: 0, end: 0 }, |item| item.span);
        let whole = words.corner().map_or(whole, |item| item.span);
        let Some((here, _)) = corner.behind.codes(block) else {
            let mut behind = corner.behind.clone();
            behind.block(came);
            return Err(behind.refused().unwrap_or_else(|| words.fault(refusal::corner(NOT_KNOWN), whole)));
        };
        self.plain_line(&words, &here, whole)?;
        let [first, second, _] = here.plane.axes();
        let target = words.end(&here);
        let next = [(first, 0), (second, 1)].map(|(axis, k)| target[axis].unwrap_or(corner.to[k]));
        let shape = Shape::of(corner.from, corner.to, next, corner.form, corner.size);
        let Some(shape) = shape else {
            let label = both!(
                "the lines are too short for it, or go straight on or back",
                "прямые для него слишком коротки или идут прямо вперёд или назад"
            );
            return Err(at.fault(refusal::corner(label), corner.place));
        };
        let mut line = if corner.behind_corner { b"G1 ".to_vec() } else { Vec::new() };
        self.point(&mut line, shape.from);
        self.rewritten(&held, &line);
        for between in std::mem::take(&mut self.between) {
            self.out.block(&between.came());
        }
        let round = corner.form == CornerForm::Round;
        let mut line: Vec<u8> = match (round, shape.left) {
            (true, true) => b"G3 ".to_vec(),
            (true, false) => b"G2 ".to_vec(),
            (false, _) => b"G1 ".to_vec(),
        };
        self.point(&mut line, shape.to);
        if round {
            for (axis, k) in [(first, 0), (second, 1)] {
                number(&mut line, b"IJK"[axis], shape.centre[k] - rounded(shape.from[k]));
            }
        }
        self.out.line(&line, at.from);
        if further {
            // The next line starts where this corner ends.
            let start = shape.to.map(|value| Some(rounded(value)));
            let waiting = self.corner(came, start, corner.behind.clone())?;
            return Ok(Some(Corner { behind_corner: true, ..waiting }));
        }
        let mut line = b"G1 ".to_vec();
        self.point(&mut line, next);
        self.rewritten(came, &line);
        Ok(None)
    }

    /// A block under G16, or the one that switches it on.
    fn polar(&mut self, came: &Came<'_>, on: Option<Span>) -> Result<(), Fault> {
        let words = &Words::of(came, self.dialect());
        let refuse = |span: Span, label: Text| words.fault(refusal::polar(label), span);
        let plane = self.plane();
        let axis_word =
            |axes: &[usize]| axes.iter().find_map(|axis| words.number(AXES[*axis])).map(|(_, span)| span);
        let off = words.actions().any(|(action, _)| *action == Action::PolarOff);
        let switches = on.is_some() || off;
        let differs = words.actions().find(|(action, _)| {
            matches!(
                action,
                Action::Reference | Action::Probe | Action::Inch | Action::Millimetre | Action::Plane(_)
            )
        });
        const DIFFERS: Text = Text::pair(
            "what its words mean under G16 differs from control to control",
            "что значат её слова при G16, у стоек по-разному",
        );
        if let (Some((_, span)), true) = (differs, self.polar.is_some()) {
            return Err(refuse(span, DIFFERS));
        }
        if switches && words.skipped() {
            return Err(refuse(
                whole(words.block),
                both!(
                    "behind block delete: two programs in one",
                    "в кадре с пропуском: две программы в одной"
                ),
            ));
        }
        let plane_word = axis_word(&plane[..2]).or_else(|| axis_word(&[0, 1, 2]).filter(|_| switches));
        if let (Some(span), true) = (plane_word, switches) {
            return Err(refuse(
                span,
                both!(
                    "motion in the block that switches G16: are its words polar?",
                    "движение в кадре, который включает G16: полярны ли его слова?"
                ),
            ));
        }
        if switches {
            let held = self.polar.unwrap_or_default();
            self.polar = (!off).then_some(held);
        }
        let (Some(span), Some(held)) = (plane_word, self.polar) else {
            self.unswitched(came, on);
            return Ok(());
        };
        let Some((here, owner)) = self.out.known.codes(words.block) else {
            self.out.block(came);
            return Ok(());
        };
        match owner {
            Owner::Motion | Owner::DwellP => {}
            Owner::Dwell | Owner::DwellBySetting | Owner::Arguments => {
                self.out.block(came);
                return Ok(());
            }
            _ => return Err(refuse(span, DIFFERS)),
        }
        if words.skipped() || !here.says_places() {
            return Err(refuse(
                span,
                both!(
                    "in G90, and not behind block delete: else the pole is where the tool stands",
                    "ожидалось G90 и без пропуска кадра: иначе полюс там, где стоит инструмент"
                ),
            ));
        }
        let radius_of_arc = words.number(b'R').is_some();
        if motion(&here) == Motion::None {
            return Err(refuse(span, both!("no motion code is in force", "функция движения не действует")));
        }
        let centred = b"IJK".iter().any(|letter| words.number(*letter).is_some());
        if motion(&here) == Motion::Arc && (centred || !radius_of_arc) {
            return Err(refuse(span, both!("an arc under G16 takes R", "дуга при G16 принимает R")));
        }
        let radius = words.length(AXES[plane[0]], here.units).or(held[0]);
        let angle = words.length(AXES[plane[1]], Units::Millimetre).or(held[1]);
        let (Some(radius), Some(angle)) = (radius, angle) else {
            return Err(refuse(
                span,
                both!(
                    "radius and angle were expected, until each has been named once under G16",
                    "ожидались радиус и угол, пока каждый не назван при G16 хотя бы раз"
                ),
            ));
        };
        if radius < 0.0 {
            return Err(refuse(span, both!("a radius below zero", "радиус меньше нуля")));
        }
        self.polar = Some([Some(radius), Some(angle)]);
        let (sin, cos) = math::sin_cos_deg(angle);
        let mut line = Vec::new();
        self.point(&mut line, [radius * cos, radius * sin]);
        self.rewritten(came, &line);
        Ok(())
    }

    /// The block without its G16, which the output is not under.
    fn unswitched(&mut self, came: &Came<'_>, on: Option<Span>) {
        match on {
            None => self.out.block(came),
            Some(span) => {
                let block = &came.block;
                self.out.comment(shown(block), came.from);
                let bytes = [&block.bytes[..span.start as usize], &block.bytes[span.end as usize..]].concat();
                if bytes.iter().any(|byte| byte.is_ascii_alphanumeric()) {
                    self.out.write(&bytes, came.from);
                }
            }
        }
    }

    /// First and second axis' words.
    fn point(&self, line: &mut Vec<u8>, point: [f64; 2]) {
        let [first, second, _] = self.plane();
        let mut both = [(first, point[0]), (second, point[1])];
        both.sort_by_key(|(axis, _)| *axis);
        numbers(line, both.map(|(axis, value)| (AXES[axis], value)));
    }

    /// The block as a comment, then the block with `words` in place of its words of the plane, its corner and,
    /// where `words` has one, its motion code.
    fn rewritten(&mut self, came: &Came<'_>, words: &[u8]) {
        let block = &came.block;
        self.out.comment(shown(block), came.from);
        let [first, second, _] = self.plane();
        let replaces_motion = words.starts_with(b"G");
        let of_block = Words::of(came, self.dialect());
        let taken = |item: &Item| match item.kind {
            ItemKind::CommaWord { .. } => true,
            ItemKind::BracketCommand => of_block.is_corner(item),
            ItemKind::Word { letter, .. } if letter == AXES[first] || letter == AXES[second] => true,
            ItemKind::Word { letter: b'G', value: Value::Number(number) } => {
                replaces_motion && action(number, self.dialect()) == Some(&Action::Line)
            }
            _ => false,
        };
        let (mut text, mut done, mut placed) = (Vec::new(), 0, false);
        for item in block.items.iter().filter(|item| taken(item)) {
            let (start, end) = (item.span.start as usize, item.span.end as usize);
            let kept = &block.bytes[done..start];
            if placed {
                text.extend_from_slice(kept.trim_ascii_end());
            } else {
                text.extend_from_slice(kept);
                text.extend_from_slice(words);
                placed = true;
            }
            done = end;
            let behind = block.bytes.get(done).copied();
            if behind.is_some_and(|byte| byte.is_ascii_alphabetic()) {
                text.push(b' ');
            }
        }
        text.extend_from_slice(&block.bytes[done..]);
        self.out.write(&text, came.from);
    }
}

/// A corner's ends and centre in the plane.
pub(crate) struct Shape {
    pub(crate) from: [f64; 2],
    pub(crate) to: [f64; 2],
    pub(crate) centre: [f64; 2],
    /// The path turns towards the second axis from the first.
    pub(crate) left: bool,
}

impl Shape {
    /// Of the corner between two lines, from one place by `corner` to the `next`.
    pub(crate) fn of(
        start: [f64; 2],
        corner: [f64; 2],
        next: [f64; 2],
        form: CornerForm,
        size: f64,
    ) -> Option<Self> {
        let away = |p: [f64; 2]| {
            let d = [p[0] - corner[0], p[1] - corner[1]];
            let length = math::hypot(d[0], d[1]);
            ([d[0] / length, d[1] / length], length)
        };
        let ((u, before), (v, after)) = (away(start), away(next));
        let (cross, dot) = (u[0] * v[1] - u[1] * v[0], u[0] * v[0] + u[1] * v[1]);
        let inside = math::atan2(cross.abs(), dot);
        if !(inside > STRAIGHT_RAD && inside < std::f64::consts::PI - STRAIGHT_RAD) {
            return None;
        }
        let cut = match form {
            CornerForm::Round => size / math::tan(0.5 * inside),
            CornerForm::Chamfer => size,
            CornerForm::ChamferLength => 0.5 * size / math::sin(0.5 * inside),
        };
        if cut > before + BEHIND || cut > after + BEHIND {
            return None;
        }
        let along = |d: [f64; 2], by: f64| [corner[0] + by * d[0], corner[1] + by * d[1]];
        // The centre lies on the line that halves the angle.
        let half = [u[0] + v[0], u[1] + v[1]];
        let reach = size / math::sin(0.5 * inside) / math::hypot(half[0], half[1]);
        // Coming along -u and leaving along v.
        Some(Self { from: along(u, cut), to: along(v, cut), centre: along(half, reach), left: cross < 0.0 })
    }
}

/// As it will be read back.
pub(crate) fn rounded(value: f64) -> f64 {
    (value * 1e6).round() / 1e6
}

/// Adds text to a line, with a blank before it where something stands.
pub(crate) fn add(line: &mut Vec<u8>, text: &[u8]) {
    if !text.is_empty() && line.last().is_some_and(|byte| *byte != b' ') {
        line.push(b' ');
    }
    line.extend_from_slice(text);
}

/// Adds a word to a line.
pub(crate) fn number(line: &mut Vec<u8>, letter: u8, value: f64) {
    let mut text = Vec::new();
    // Fifteen digits hold whatever a program's own numbers make.
    let _ = word(&mut text, letter, value, Style::Decimals(6));
    add(line, &text);
}

/// Adds words to a line.
pub(crate) fn numbers(line: &mut Vec<u8>, words: impl IntoIterator<Item = (u8, f64)>) {
    words.into_iter().for_each(|(letter, value)| number(line, letter, value));
}

/// A code and its words.
pub(crate) fn line_of(code: &[u8], words: impl IntoIterator<Item = (u8, f64)>) -> Vec<u8> {
    let mut line = code.to_vec();
    numbers(&mut line, words);
    line
}

/// The block without its end.
pub(crate) fn shown<'a>(block: &Block<'a>) -> &'a [u8] {
    let text = block.bytes.trim_ascii_end();
    text.strip_suffix(b";").unwrap_or(text)
}

fn whole(block: &Block<'_>) -> Span {
    crate::statement::whole(block)
}
