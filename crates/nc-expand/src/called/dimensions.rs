//! `X=AC()`, `X=IC()`, `TURN=` and `AR=` in a block, written out.

use diagnostic::{Text, both, refusal};
use nc_dialect::{Action, Called};
use nc_program::Owner;
use nc_program::modal::{Distance, Modal};
use nc_syntax::{Block, ItemKind, Reader, Span, Value};
use units::math;

use super::{Writer, angle, called, dimension, names_axes};
use crate::came::{Came, Fault};
use crate::codes;
use crate::known::{Motion, motion};
use crate::output::{Style, word};
use crate::refusals::called as refusal;
use crate::shorthand::{AXES, Words, add, line_of, numbers, shown};
use crate::siemens::plain_number;

impl Writer<'_> {
    /// `X=AC()`, `X=IC()` and `TURN=` in a block.
    pub(super) fn dimensions(&mut self, came: &Came<'_>) -> Result<(), Fault> {
        let (block, words) = (&came.block, &Words::of(came, self.dialect));
        let start = self.modal().places();
        let Some((here, owner)) = self.out.known().codes(block) else {
            // Its own codes are refused, before its words are asked for.
            return self.out.came(came);
        };
        let owned = matches!(owner, Owner::Motion | Owner::DwellP);
        let refuse = |span: Span, label: Text| {
            words.fault(
                refusal!(codes::CALLED_CYCLE;
                    "a dimension that cannot be written out", "размер, который нельзя расписать";
                    label;
                    "write the word without AC or IC, in G90 or G91",
                    "напишите слово без AC и IC, при G90 или G91"
                ),
                span,
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
                    let Some(value) = plain_number(inside) else {
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
                ItemKind::BracketCommand => {
                    let written = std::str::from_utf8(block.text(item.span)).unwrap_or_default();
                    let value = written.split_once('=').map(|(_, value)| value.trim());
                    match called(block, self.dialect, item) {
                        Some(Called::ArcAngle) => {
                            let label = both!(
                                "a plain number of degrees was expected",
                                "ожидалось простое число градусов"
                            );
                            let value = value.and_then(plain_number);
                            angle = Some((value.ok_or_else(|| refuse(item.span, label))?, item.span));
                        }
                        Some(Called::Turns) => {
                            let label = both!(
                                "a whole number of turns up to 999 was expected",
                                "ожидалось целое число оборотов до 999"
                            );
                            let count =
                                value.and_then(|value| value.parse().ok()).filter(|count| *count <= 999);
                            turns = Some((count.ok_or_else(|| refuse(item.span, label))?, item.span));
                        }
                        _ => continue,
                    }
                    text.extend_from_slice(block.bytes[done..item.span.start as usize].trim_ascii_end());
                    done = item.span.end as usize;
                    continue;
                }
                _ => continue,
            };
            text.extend_from_slice(&block.bytes[done..item.span.start as usize]);
            let _ = word(&mut text, letter, place, Style::Decimals(6));
            done = item.span.end as usize;
        }
        text.extend_from_slice(&block.bytes[done..]);
        // As it reads now.
        let mut reader = Reader::new(&text, self.dialect);
        let mut plain_block = Block::default();
        if !reader.next(&mut plain_block) {
            return Ok(());
        }
        let plain_words = Words { block: &plain_block, ..*words };
        if let Some((degrees, span)) = angle {
            if turns.is_some() {
                return Err(refuse(span, both!("beside TURN", "рядом с TURN")));
            }
            let line = if owned {
                angle::words(&here, &plain_words, degrees)
            } else {
                Err(both!(
                    "beside a code that owns the words of its block",
                    "рядом с функцией, которой принадлежат слова кадра"
                ))
            };
            let line = line.map_err(|label| words.fault(refusal::arc_by_angle(label), span))?;
            return self.arc_by_angle(words, &text, &line, start);
        }
        let moves = owned && names_axes(&plain_words);
        match turns {
            Some((count, span)) if count > 0 => self.helix(words, &plain_words, &here, count, span)?,
            _ => self.out.write(&text, words.from)?,
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
        self.out.comment(shown(words.block), words.from)?;
        self.out.write(&text, words.from)?;
        self.behind(words, true, start)
    }

    /// Full circles and the rest of a helix.
    fn helix(
        &mut self,
        words: &Words<'_, '_>,
        plain: &Words<'_, '_>,
        here: &Modal,
        count: u32,
        span: Span,
    ) -> Result<(), Fault> {
        let refuse = |label: Text| words.fault(refusal::turns(label), span);
        if motion(here) != Motion::Arc {
            return Err(refuse(both!("G2 or G3 was expected", "ожидалось G2 или G3")));
        }
        if !here.says_places() {
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
        let ([u, v, n], at) = (here.plane.axes(), here.places());
        let centre_letters = [b"IJK"[u], b"IJK"[v]];
        let (Some(a), Some(b), Some(h)) = (at[u], at[v], at[n]) else {
            return Err(refuse(both!(
                "where the helix starts is not known: name X, Y and Z before it, in G90",
                "неизвестно, откуда начинается винтовая линия: назовите до неё X, Y и Z при G90"
            )));
        };
        let target = plain.end(here);
        let end = [u, v, n].map(|axis| target[axis].unwrap_or(f64::NAN));
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
        let code: &[u8] = if clockwise { b"G2" } else { b"G3" };
        let centres = [(centre_letters[0], centre[0]), (centre_letters[1], centre[1])];
        for turn in 1..=count {
            let mut line = if turn == 1 {
                kept(plain, [AXES[u], AXES[v], AXES[n], centre_letters[0], centre_letters[1]])
            } else {
                code.to_vec()
            };
            let level = h + (end[2] - h) * (f64::from(turn) * full / all);
            numbers(&mut line, [(AXES[u], a), (AXES[v], b), (AXES[n], level)].into_iter().chain(centres));
            self.out.line(&line, words.from)?;
        }
        let places = [u, v, n].map(|axis| AXES[axis]).into_iter().zip(end);
        self.out.line(&line_of(code, places.chain(centres)), words.from)
    }
}

/// The words of a block but for some letters.
fn kept(words: &Words<'_, '_>, without: [u8; 5]) -> Vec<u8> {
    let mut line = Vec::new();
    for item in &words.block.items {
        if let ItemKind::Word { letter, .. } = item.kind
            && !without.contains(&letter)
        {
            add(&mut line, words.block.text(item.span));
        }
    }
    line
}

/// The number that a word without AC and IC needs.
fn place(modal: &Modal, letter: u8, value: f64, by: Distance) -> Option<f64> {
    let at = modal.places();
    if let Some(axis) = AXES.iter().position(|axis| *axis == letter) {
        return match (by, modal.says_places()) {
            (Distance::Absolute, true) | (Distance::Incremental, false) => Some(value),
            (Distance::Incremental, true) => Some(at[axis]? + value),
            (Distance::Absolute, false) => Some(value - at[axis]?),
        };
    }
    let axis = usize::from(letter - b'I');
    if by == Distance::Incremental { Some(value) } else { Some(value - at[axis]?) }
}
