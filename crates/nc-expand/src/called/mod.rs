//! Names of Siemens written out as plain blocks: cycles (CYCLE81 and its like, MCALL, HOLES1, HOLES2), `X=AC()` and
//! `X=IC()`, `TURN=`, `AR=`. Corners (`RND=`, `CHF=`, `CHR=`) are left to [`crate::shorthand`].
//!
//! * A cycle drills where the axes of the plane stand, along the axis upright on it: its moves as G0 and G1, in G90, the
//!   motion code in force behind them as before (G functions outlive a cycle's call).
//! * MCALL calls its cycle behind every block that moves, until MCALL alone.
//! * HOLES1 and HOLES2 are the points of a row or a circle, each followed by the cycle of MCALL.
//! * `AC(v)` is the place v, `IC(v)` the place v away from where the axis stands; of I, J, K from the arc's start.
//! * CYCLE85 ends with a feed of its own and CYCLE86 with a spindle that stands; what holds behind them the manual does
//!   not say, so that the program must.
//! * `AR=a`: an arc of a degrees, by its end or by its centre.
//! * `TURN=n`: n full circles, then the arc that the words say, the way along the axis shared by angle.
//!
//! Source: SINUMERIK 840D Programming Guide Cycles, chapter 2; Programming Manual Fundamentals, sections on AC, IC and
//! helices. The numbers written have 6 decimals.

mod angle;
mod arguments;
mod hole;

use diagnostic::{Diagnostic, Text, both};
use nc_syntax::dialect::{Action, Called};
use nc_syntax::{Block, Dialect, Item, ItemKind, Reader, Span, Value};
use units::math;

use crate::codes;
use crate::output::{Output, Segment};
use crate::shorthand::{AXES, Motion, State, Words, from, number, rounded, shown};
use crate::siemens;
use arguments::Arguments;
pub(crate) use arguments::number as plain_number;
use hole::{Hole, Move};

type Fault = Box<Diagnostic>;

/// Holes of one pattern; more are a wrong count.
const MOST_HOLES: f64 = 10_000.0;
/// Where HOLES1 may begin at either end, in units of the program.
const SAME: f64 = 1e-6;

/// True where the block has a name that this dialect writes out.
pub(crate) fn needed(block: &Block<'_>, dialect: &Dialect) -> bool {
    dialect.flow.called
        && block.items.iter().any(|item| match item.kind {
            ItemKind::BracketCommand => called(block, dialect, item).is_some(),
            ItemKind::Word { letter, value: Value::Expression } => {
                dimension(letter, block.text(item.span)).is_some()
            }
            _ => false,
        })
}

fn refuse_angle(words: &Words<'_, '_>, span: Span, label: Text) -> Fault {
    words.fault(
        codes::CALLED_CYCLE,
        span,
        both!("an arc by its angle that cannot be written out", "дуга по углу, которую нельзя расписать"),
        label,
        both!("write the arc with I, J, K", "напишите дугу словами I, J, K"),
    )
}

fn called(block: &Block<'_>, dialect: &Dialect, item: &Item) -> Option<Called> {
    match dialect.command(block.text(item.span))?.action {
        // Corners are shorthand of drawings, whatever they are called.
        Some(Action::Called(Called::Corner(_))) => None,
        Some(Action::Called(called)) if item.kind == ItemKind::BracketCommand => Some(called),
        _ => None,
    }
}

/// What is in the brackets of `X=AC(…)` or `X=IC(…)`, and whether it is an increment.
fn dimension(letter: u8, text: &[u8]) -> Option<(&str, bool)> {
    let (name, inside) = siemens::function_of(text).filter(|_| b"XYZIJK".contains(&letter))?;
    let inside = std::str::from_utf8(&text[inside]).ok()?.trim();
    match &name.to_ascii_uppercase()[..] {
        b"AC" => Some((inside, false)),
        b"IC" => Some((inside, true)),
        _ => None,
    }
}

/// The program with its names written out, and where each stretch of it comes from.
pub(crate) fn write_out(text: &[u8], dialect: &Dialect) -> Result<(Vec<u8>, Vec<Segment>), Fault> {
    let (out, state) = (Output::new(dialect, text), State::initial(dialect));
    let mut writer = Writer { dialect, out, state, modal: None, unsaid: Unsaid::default() };
    let mut reader = Reader::new(text, dialect);
    let mut block = Block::default();
    while reader.next(&mut block) {
        writer.block(&block)?;
    }
    Ok((writer.out.text, writer.out.segments))
}

struct Writer<'d> {
    dialect: &'d Dialect,
    out: Output,
    state: State,
    /// The cycle of MCALL.
    modal: Option<Hole>,
    unsaid: Unsaid,
}

/// What a cycle left in force that its manual does not say.
#[derive(Clone, Copy, Default)]
struct Unsaid {
    feed: bool,
    spindle: bool,
}

impl Writer<'_> {
    fn block(&mut self, block: &Block<'_>) -> Result<(), Fault> {
        let words = Words { block, dialect: self.dialect };
        self.said(&words)?;
        if !needed(block, self.dialect) {
            let before = self.state.at;
            let moves = self.state.step(&words) && names_axes(&words);
            self.out.copy(block.bytes, from(block));
            return self.behind(&words, moves, before);
        }
        if words.skipped() {
            return Err(words.fault(
                codes::BLOCK_DELETE,
                words.whole(),
                both!(
                    "a cycle or an increment behind block delete",
                    "цикл или приращение в кадре с пропуском"
                ),
                both!("two programs in one", "две программы в одной"),
                both!("remove the `/`, or the block", "уберите `/` или кадр"),
            ));
        }
        let calls: Vec<(Called, Span)> = block
            .items
            .iter()
            .filter_map(|item| Some((called(block, self.dialect, item)?, item.span)))
            .filter(|(called, _)| !matches!(called, Called::Turns | Called::ArcAngle))
            .collect();
        if calls.is_empty() {
            return self.dimensions(&words);
        }
        self.alone(&words)?;
        let comment = shown(block).to_vec();
        match calls.as_slice() {
            [(Called::Modal, span)] => {
                let more = words.block.text(*span).contains(&b'(');
                if more
                    || block
                        .items
                        .iter()
                        .any(|item| item.kind == ItemKind::BracketCommand && item.span != *span)
                {
                    return Err(words.fault(
                        codes::CALLED_CYCLE,
                        *span,
                        both!(
                            "a call that stays of something unknown",
                            "модальный вызов чего-то неизвестного"
                        ),
                        both!(
                            "a cycle from CYCLE81 to CYCLE83, CYCLE85 or CYCLE86 was expected behind MCALL",
                            "после MCALL ожидался цикл от CYCLE81 до CYCLE83, CYCLE85 или CYCLE86"
                        ),
                        both!(
                            "let the CAM write the holes as G0 and G1",
                            "выводите из CAM отверстия кадрами G0 и G1"
                        ),
                    ));
                }
                self.modal = None;
                self.out.comment(&comment, from(block));
            }
            [(Called::Modal, _), (cycle, span)] if self.drills(*cycle) => {
                self.modal = Some(self.hole(&words, *cycle, *span)?);
                self.out.comment(&comment, from(block));
            }
            [(Called::HolesRow | Called::HolesCircle, span)] => {
                let call = Arguments::read(&words, *span)?;
                let Some(hole) = self.modal.clone() else {
                    return Err(call.fault(
                        &words,
                        both!("{} without a cycle", "{} без цикла", call.name),
                        both!(
                            "MCALL and a cycle were expected before it",
                            "перед ней ожидались MCALL и цикл"
                        ),
                    ));
                };
                let places = if calls[0].0 == Called::HolesRow {
                    self.row(&words, &call)?
                } else {
                    circle(&words, &call)?
                };
                self.out.comment(&comment, from(block));
                for place in places {
                    let mut line = b"G0 ".to_vec();
                    self.point(&mut line, place);
                    self.out.line(&line, from(block));
                    for (axis, value) in self.state.plane.into_iter().zip(place) {
                        self.state.at[axis] = Some(rounded(value));
                    }
                    self.drill(&words, &hole)?;
                }
                self.restore(&words)?;
            }
            [(cycle, span)] if self.drills(*cycle) => {
                let hole = self.hole(&words, *cycle, *span)?;
                self.out.comment(&comment, from(block));
                self.drill(&words, &hole)?;
                self.restore(&words)?;
            }
            [.., (_, span)] => {
                return Err(words.fault(
                    codes::CALLED_CYCLE,
                    *span,
                    both!("two calls in one block", "два вызова в одном кадре"),
                    both!("in which order?", "в каком порядке?"),
                    both!("write them in two blocks", "напишите их двумя кадрами"),
                ));
            }
            [] => {}
        }
        Ok(())
    }

    fn drills(&self, cycle: Called) -> bool {
        matches!(
            cycle,
            Called::Drill
                | Called::DrillDwell
                | Called::DrillPecks
                | Called::BoreFeeds
                | Called::BoreOriented
        )
    }

    /// Feed and spindle behind a cycle that leaves them open: what the block says of them, or that it had to.
    fn said(&mut self, words: &Words<'_, '_>) -> Result<(), Fault> {
        let dwells = words.actions().any(|(action, _)| *action == Action::Dwell);
        self.unsaid.feed &= dwells || words.number(b'F').is_none();
        self.unsaid.spindle &= !words.block.words().any(|word| {
            let code = word.number().filter(|_| word.letter == b'M').and_then(|number| number.integer());
            matches!(code, Some(3..=5))
        });
        let mut here = self.state.clone();
        let moves = here.codes(words) && names_axes(words);
        if moves && matches!(here.motion, Motion::Line | Motion::Arc) {
            self.needs(words, true, true)?;
        }
        Ok(())
    }

    /// Refuses a cut at a feed or with a spindle that a cycle left open.
    fn needs(&self, words: &Words<'_, '_>, feed: bool, spindle: bool) -> Result<(), Fault> {
        let (message, help) = if self.unsaid.feed && feed {
            (
                both!("which feed holds behind CYCLE85", "какая подача действует после CYCLE85"),
                both!("write F in this block", "напишите в этом кадре F"),
            )
        } else if self.unsaid.spindle && spindle {
            (
                both!("whether the spindle turns behind CYCLE86", "вращается ли шпиндель после CYCLE86"),
                both!("write M3 or M4 before this block", "напишите M3 или M4 до этого кадра"),
            )
        } else {
            return Ok(());
        };
        Err(words.fault(
            codes::CALLED_CYCLE,
            words.whole(),
            both!("{message} is not known", "неизвестно, {message:#}"),
            both!("the cycle's manual does not say", "в руководстве цикла этого нет"),
            help,
        ))
    }

    fn hole(&self, words: &Words<'_, '_>, cycle: Called, span: Span) -> Result<Hole, Fault> {
        let call = Arguments::read(words, span)?;
        let unit_mm = if self.state.inch { 25.4 } else { 1.0 };
        Hole::read(words, cycle, &call, unit_mm, self.state.plane[2])
    }

    /// A call stands in a block of its own.
    fn alone(&self, words: &Words<'_, '_>) -> Result<(), Fault> {
        let other = words.block.items.iter().find(|item| match item.kind {
            ItemKind::Word { letter, .. } => letter != b'N',
            ItemKind::Comment | ItemKind::Name => false,
            _ => called(words.block, words.dialect, item).is_none(),
        });
        match other {
            None => Ok(()),
            Some(item) => Err(words.fault(
                codes::CALLED_CYCLE,
                item.span,
                both!("something beside the call of a cycle", "что-то рядом с вызовом цикла"),
                both!("before or behind the cycle?", "до цикла или после?"),
                both!("write it in a block of its own", "напишите отдельным кадром"),
            )),
        }
    }

    /// The moves of a hole where the axes stand.
    fn drill(&mut self, words: &Words<'_, '_>, hole: &Hole) -> Result<(), Fault> {
        if !self.state.absolute {
            return Err(words.fault(
                codes::CALLED_CYCLE,
                words.whole(),
                both!("a cycle under G91", "цикл при G91"),
                both!("its moves are places", "его ходы заданы местами"),
                both!("write G90 before it", "напишите перед ним G90"),
            ));
        }
        self.needs(words, hole.takes_feed, !hole.leaves_spindle)?;
        self.unsaid.feed |= hole.leaves_feed;
        self.unsaid.spindle |= hole.leaves_spindle;
        let plane = self.state.plane;
        let axis = plane[2];
        let (source, letter) = (from(words.block), AXES[axis]);
        let hole_at = self.state.at;
        for step in &hole.moves {
            let mut line = Vec::new();
            match *step {
                Move::Rapid(to) => {
                    line.extend_from_slice(b"G0 ");
                    number(&mut line, letter, to);
                }
                Move::Feed(to) => {
                    line.extend_from_slice(b"G1 ");
                    number(&mut line, letter, to);
                }
                Move::FeedAt(to, feed) => {
                    line.extend_from_slice(b"G1 ");
                    number(&mut line, letter, to);
                    line.push(b' ');
                    number(&mut line, b'F', feed);
                }
                Move::Spindle(code) => line.extend_from_slice(format!("M{code}").as_bytes()),
                Move::Orient(angle) => {
                    number(&mut line, b'=', angle);
                    line.splice(0..0, *b"SPOS");
                }
                Move::Aside(by) => {
                    line.extend_from_slice(b"G0");
                    for (axis, by) in plane.into_iter().zip(by).filter(|(_, by)| *by != 0.0) {
                        let at = self.place(words, axis)? + by;
                        line.push(b' ');
                        number(&mut line, AXES[axis], at);
                        self.state.at[axis] = Some(rounded(at));
                    }
                }
                Move::Over(to) => {
                    line.extend_from_slice(b"G0");
                    for axis in plane[..2].iter().filter(|axis| self.state.at[**axis] != hole_at[**axis]) {
                        line.push(b' ');
                        number(&mut line, AXES[*axis], hole_at[*axis].unwrap_or(f64::NAN));
                    }
                    line.push(b' ');
                    number(&mut line, letter, to);
                    (self.state.at, self.state.at[axis]) = (hole_at, None);
                }
                Move::Dwell(time) => {
                    line.extend_from_slice(b"G4 ");
                    number(&mut line, if time < 0.0 { b'S' } else { b'F' }, time.abs());
                }
            }
            self.out.line(&line, source);
            if let Move::Rapid(to) | Move::Feed(to) | Move::FeedAt(to, _) | Move::Over(to) = *step {
                self.state.at[axis] = Some(rounded(to));
            }
        }
        Ok(())
    }

    /// Where an axis stands.
    fn place(&self, words: &Words<'_, '_>, axis: usize) -> Result<f64, Fault> {
        self.state.at[axis].ok_or_else(|| {
            words.fault(
                codes::CALLED_CYCLE,
                words.whole(),
                both!("where {} stands is not known", "неизвестно, где стоит {}", AXES[axis] as char),
                both!("the cycle moves by increments from there", "цикл отходит оттуда на приращения"),
                both!("name it before the cycle, in G90", "назовите её до цикла, при G90"),
            )
        })
    }

    /// The motion code that was in force before a cycle.
    fn restore(&mut self, words: &Words<'_, '_>) -> Result<(), Fault> {
        match self.state.motion {
            Motion::Rapid | Motion::None => Ok(()),
            Motion::Line => {
                self.out.line(b"G1", from(words.block));
                Ok(())
            }
            Motion::Arc | Motion::Cycle => Err(words.fault(
                codes::CALLED_CYCLE,
                words.whole(),
                both!("a cycle while an arc is in force", "цикл, пока действует дуга"),
                both!(
                    "the words behind it would be an arc's again",
                    "слова после него снова относились бы к дуге"
                ),
                both!("write G0 before the cycle", "напишите G0 до цикла"),
            )),
        }
    }

    /// The hole behind a block that moves, while MCALL is in force.
    ///
    /// * `at` – the block of the source
    /// * `moves` – it has words of a motion
    /// * `before` – where the axes stood
    fn behind(&mut self, at: &Words<'_, '_>, moves: bool, before: [Option<f64>; 3]) -> Result<(), Fault> {
        let Some(hole) = self.modal.clone() else { return Ok(()) };
        if !moves && self.state.at == before {
            return Ok(());
        }
        if at.skipped() {
            return Err(at.fault(
                codes::BLOCK_DELETE,
                at.whole(),
                both!("a hole behind block delete", "отверстие в кадре с пропуском"),
                both!("two programs in one", "две программы в одной"),
                both!("remove the `/`, or the block", "уберите `/` или кадр"),
            ));
        }
        if !moves || !self.plane_known() {
            return Err(at.fault(
                codes::CALLED_CYCLE,
                at.whole(),
                both!("what MCALL drills here is not known", "неизвестно, что здесь сверлит MCALL"),
                both!(
                    "the frame, the tool or machine coordinates in a block under MCALL",
                    "в кадре при MCALL меняются система координат, инструмент или стоят координаты станка"
                ),
                both!(
                    "end the call with MCALL alone before it",
                    "закончите вызов до него: MCALL отдельным кадром"
                ),
            ));
        }
        self.drill(at, &hole)?;
        self.restore(at)
    }

    fn plane_known(&self) -> bool {
        self.state.plane[..2].iter().all(|axis| self.state.at[*axis].is_some())
    }

    /// `X=AC()`, `X=IC()` and `TURN=` in a block.
    fn dimensions(&mut self, words: &Words<'_, '_>) -> Result<(), Fault> {
        let block = words.block;
        let start = self.state.at;
        let mut here = self.state.clone();
        let owned = here.codes(words);
        let refuse = |span: Span, label: Text| {
            words.fault(
                codes::CALLED_CYCLE,
                span,
                both!("a dimension that cannot be written out", "размер, который нельзя расписать"),
                label,
                both!(
                    "write the word without AC or IC, in G90 or G91",
                    "напишите слово без AC и IC, при G90 или G91"
                ),
            )
        };
        let mut text: Vec<u8> = Vec::new();
        let mut done = 0;
        let mut turns = None;
        let mut angle = None;
        for item in &block.items {
            let (letter, place) = match item.kind {
                ItemKind::Word { letter, value: Value::Expression } => {
                    let Some((inside, by)) = dimension(letter, block.text(item.span)) else { continue };
                    let Some(value) = arguments::number(inside) else {
                        return Err(refuse(
                            item.span,
                            both!(
                                "a plain number was expected in the brackets",
                                "в скобках ожидалось простое число"
                            ),
                        ));
                    };
                    if !owned {
                        return Err(refuse(
                            item.span,
                            both!(
                                "beside a code that owns the words of its block",
                                "рядом с функцией, которой принадлежат слова кадра"
                            ),
                        ));
                    }
                    let Some(place) = place(&here, letter, value, by) else {
                        let label = both!(
                            "where the axis stands is not known: name it before, in G90",
                            "где стоит ось, неизвестно: назовите её раньше, при G90"
                        );
                        return Err(refuse(item.span, label));
                    };
                    (letter, place)
                }
                ItemKind::BracketCommand if called(block, self.dialect, item) == Some(Called::ArcAngle) => {
                    let written = block.text(item.span);
                    let value = written.iter().position(|byte| *byte == b'=').map(|at| &written[at + 1..]);
                    let value = value.and_then(|value| std::str::from_utf8(value).ok());
                    let Some(value) = value.and_then(|value| arguments::number(value.trim())) else {
                        return Err(refuse(
                            item.span,
                            both!(
                                "a plain number of degrees was expected",
                                "ожидалось простое число градусов"
                            ),
                        ));
                    };
                    angle = Some((value, item.span));
                    text.extend_from_slice(block.bytes[done..item.span.start as usize].trim_ascii_end());
                    done = item.span.end as usize;
                    continue;
                }
                ItemKind::BracketCommand if called(block, self.dialect, item) == Some(Called::Turns) => {
                    let written = String::from_utf8_lossy(block.text(item.span)).into_owned();
                    let count =
                        written.split_once('=').and_then(|(_, count)| count.trim().parse::<u32>().ok());
                    let Some(count) = count.filter(|count| *count <= 999) else {
                        return Err(refuse(
                            item.span,
                            both!(
                                "a whole number of turns up to 999 was expected",
                                "ожидалось целое число оборотов до 999"
                            ),
                        ));
                    };
                    turns = Some((count, item.span));
                    text.extend_from_slice(block.bytes[done..item.span.start as usize].trim_ascii_end());
                    done = item.span.end as usize;
                    continue;
                }
                _ => continue,
            };
            text.extend_from_slice(&block.bytes[done..item.span.start as usize]);
            number(&mut text, letter, place);
            done = item.span.end as usize;
        }
        text.extend_from_slice(&block.bytes[done..]);
        // As it reads now.
        let mut reader = Reader::new(&text, self.dialect);
        let mut plain_block = Block::default();
        if !reader.next(&mut plain_block) {
            return Ok(());
        }
        let plain_words = Words { block: &plain_block, dialect: self.dialect };
        if let Some((degrees, span)) = angle {
            if turns.is_some() {
                return Err(refuse(span, both!("beside TURN", "рядом с TURN")));
            }
            let line = angle::words(&self.state, &plain_words, degrees)
                .map_err(|label| refuse_angle(words, span, label))?;
            return self.arc_by_angle(words, &text, &line, start);
        }
        let moves = self.state.step(&plain_words) && names_axes(&plain_words);
        match turns {
            Some((count, span)) if count > 0 => self.helix(words, &plain_words, start, count, span)?,
            _ => self.out.write(&text, from(block)),
        }
        self.behind(words, moves, start)
    }

    /// An arc by its angle: the block without `AR=`, and the words that it stands for.
    fn arc_by_angle(
        &mut self,
        words: &Words<'_, '_>,
        text: &[u8],
        more: &[u8],
        start: [Option<f64>; 3],
    ) -> Result<(), Fault> {
        // Behind the last word, before what ends the block or comments on it.
        let stop = text.iter().position(|byte| *byte == b';').unwrap_or(text.len());
        let end = text[..stop].trim_ascii_end().len();
        let text = [&text[..end], more, &text[end..]].concat();
        self.out.comment(shown(words.block), from(words.block));
        let mut reader = Reader::new(&text, self.dialect);
        let mut block = Block::default();
        if reader.next(&mut block) {
            self.state.step(&Words { block: &block, dialect: self.dialect });
        }
        self.out.write(&text, from(words.block));
        self.behind(words, true, start)
    }

    /// Full circles and the rest of a helix.
    fn helix(
        &mut self,
        words: &Words<'_, '_>,
        plain: &Words<'_, '_>,
        start: [Option<f64>; 3],
        count: u32,
        span: Span,
    ) -> Result<(), Fault> {
        let refuse = |label: Text| {
            words.fault(
                codes::CALLED_CYCLE,
                span,
                both!("turns that cannot be written out", "обороты, которые нельзя расписать"),
                label,
                both!("let the CAM write each turn", "выводите из CAM каждый оборот"),
            )
        };
        if self.state.motion != Motion::Arc {
            return Err(refuse(both!("G2 or G3 was expected", "ожидалось G2 или G3")));
        }
        if !self.state.absolute {
            return Err(refuse(both!("under G91; write G90", "при G91; напишите G90")));
        }
        if plain.number(b'M').is_some()
            || plain.number(b'R').is_some()
            || !plain
                .block
                .items
                .iter()
                .all(|item| matches!(item.kind, ItemKind::Word { .. } | ItemKind::Comment))
        {
            return Err(refuse(both!(
                "beside M codes, a radius or commands",
                "рядом с функциями M, радиусом или командами"
            )));
        }
        let [u, v, n] = self.state.plane;
        let centre_letters = [b"IJK"[u], b"IJK"[v]];
        let (Some(a), Some(b), Some(h)) = (start[u], start[v], start[n]) else {
            return Err(refuse(both!(
                "where the helix starts is not known: name X, Y and Z before it, in G90",
                "неизвестно, откуда начинается винтовая линия: назовите до неё X, Y и Z при G90"
            )));
        };
        let end = [u, v, n].map(|axis| self.state.at[axis].unwrap_or(f64::NAN));
        let centre = centre_letters
            .map(|letter| plain.number(letter).map_or(0.0, |(value, _)| value.decimal.to_f64()));
        let clockwise = words.actions().any(|(action, _)| *action == Action::ArcClockwise);
        let counter = words.actions().any(|(action, _)| *action == Action::ArcCounterClockwise);
        if clockwise == counter {
            return Err(refuse(both!(
                "G2 or G3 was expected in the same block",
                "в том же кадре ожидалось G2 или G3"
            )));
        }
        let angle = |p: [f64; 2]| math::atan2(p[1] - (b + centre[1]), p[0] - (a + centre[0]));
        let (from_angle, to_angle) = (angle([a, b]), angle([end[0], end[1]]));
        let full = std::f64::consts::TAU;
        let turned = if clockwise { from_angle - to_angle } else { to_angle - from_angle };
        let rest = turned.rem_euclid(full);
        if rest < 1e-6 || full - rest < 1e-6 {
            return Err(refuse(both!(
                "the arc that is left ends where it starts: a turn more, or none?",
                "оставшаяся дуга кончается там, где начинается: ещё оборот или ни одного?"
            )));
        }
        let all = f64::from(count) * full + rest;
        let code: &[u8] = if clockwise { b"G2 " } else { b"G3 " };
        for turn in 1..=count {
            let mut line = if turn == 1 {
                kept(plain, [AXES[u], AXES[v], AXES[n], centre_letters[0], centre_letters[1]])
            } else {
                code.to_vec()
            };
            let level = h + (end[2] - h) * (f64::from(turn) * full / all);
            number(&mut line, AXES[u], a);
            line.push(b' ');
            number(&mut line, AXES[v], b);
            line.push(b' ');
            number(&mut line, AXES[n], level);
            for (letter, offset) in centre_letters.into_iter().zip(centre) {
                line.push(b' ');
                number(&mut line, letter, offset);
            }
            self.out.line(&line, from(words.block));
        }
        let mut line = code.to_vec();
        for (k, axis) in [u, v, n].into_iter().enumerate() {
            number(&mut line, AXES[axis], end[k]);
            line.push(b' ');
        }
        number(&mut line, centre_letters[0], centre[0]);
        line.push(b' ');
        number(&mut line, centre_letters[1], centre[1]);
        self.out.line(&line, from(words.block));
        Ok(())
    }

    fn point(&self, line: &mut Vec<u8>, place: [f64; 2]) {
        let [u, v, _] = self.state.plane;
        number(line, AXES[u], place[0]);
        line.push(b' ');
        number(line, AXES[v], place[1]);
    }

    /// HOLES1(SPCA, SPCO, STA1, FDIS, DBH, NUM): a row, begun at the end that is nearer to where the axes stand.
    fn row(&self, words: &Words<'_, '_>, call: &Arguments) -> Result<Vec<[f64; 2]>, Fault> {
        let count = count(words, call, 5)?;
        call.nothing_behind(words, 6)?;
        let (sin, cos) = math::sin_cos_deg(call.or_zero(2));
        let at = |k: usize| {
            let along = call.or_zero(3) + k as f64 * call.or_zero(4);
            [call.or_zero(0) + along * cos, call.or_zero(1) + along * sin]
        };
        let mut places: Vec<[f64; 2]> = (0..count).map(at).collect();
        let [u, v, _] = self.state.plane;
        let (Some(a), Some(b)) = (self.state.at[u], self.state.at[v]) else {
            return Err(call.fault(
                words,
                both!("HOLES1 from a place that is not known", "HOLES1 из неизвестного места"),
                both!(
                    "it begins at the nearer end: name both axes of the plane before it",
                    "он начинается с ближнего конца: назовите до него обе оси плоскости"
                ),
            ));
        };
        let far = |p: &[f64; 2]| math::hypot(p[0] - a, p[1] - b);
        if let [first, .., last] = places.as_slice() {
            let (to_first, to_last) = (far(first), far(last));
            if (to_first - to_last).abs() < SAME {
                return Err(call.fault(
                    words,
                    both!("HOLES1 whose ends are equally near", "HOLES1, концы которого одинаково близки"),
                    both!("it begins at the nearer one", "он начинается с ближнего"),
                ));
            }
            if to_last < to_first {
                places.reverse();
            }
        }
        Ok(places)
    }
}

/// HOLES2(CPA, CPO, RAD, STA1, INDA, NUM): a circle, from its first angle on; without INDA all around.
fn circle(words: &Words<'_, '_>, call: &Arguments) -> Result<Vec<[f64; 2]>, Fault> {
    let count = count(words, call, 5)?;
    call.nothing_behind(words, 6)?;
    let radius = call.or_zero(2).abs();
    let step = match call.or_zero(4) {
        0.0 => 360.0 / count as f64,
        step => step,
    };
    let at = |k: usize| {
        let (sin, cos) = math::sin_cos_deg(call.or_zero(3) + k as f64 * step);
        [call.or_zero(0) + radius * cos, call.or_zero(1) + radius * sin]
    };
    Ok((0..count).map(at).collect())
}

fn count(words: &Words<'_, '_>, call: &Arguments, place: usize) -> Result<usize, Fault> {
    let count = call.needed(words, place, &both!("a number of holes", "числа отверстий"))?;
    if !(1.0..=MOST_HOLES).contains(&count) || count.fract() != 0.0 {
        return Err(call.fault(
            words,
            both!("{} of {count} holes", "{}: отверстий {count}", call.name),
            both!("a whole number from 1 was expected", "ожидалось целое число от 1"),
        ));
    }
    Ok(count as usize)
}

/// The words of a block but for some letters, each with a blank behind it.
fn kept(words: &Words<'_, '_>, without: [u8; 5]) -> Vec<u8> {
    let mut line = Vec::new();
    for item in &words.block.items {
        if let ItemKind::Word { letter, .. } = item.kind
            && !without.contains(&letter)
        {
            line.extend_from_slice(words.block.text(item.span));
            line.push(b' ');
        }
    }
    line
}

/// The number that a word without AC and IC needs.
fn place(state: &State, letter: u8, value: f64, by: bool) -> Option<f64> {
    if let Some(axis) = AXES.iter().position(|axis| *axis == letter) {
        return match (by, state.absolute) {
            (false, true) | (true, false) => Some(value),
            (true, true) => Some(state.at[axis]? + value),
            (false, false) => Some(value - state.at[axis]?),
        };
    }
    let axis = usize::from(letter - b'I');
    if by { Some(value) } else { Some(value - state.at[axis]?) }
}

/// The block has words that a motion takes: rotary axes move too, and a full circle names its centre alone.
fn names_axes(words: &Words<'_, '_>) -> bool {
    b"XYZABCUVWIJK".iter().any(|letter| words.number(*letter).is_some())
}
