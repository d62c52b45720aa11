//! Computed words as text.

use nc_dialect::Action;
use nc_syntax::{GCode, Macros, Span};

use crate::evaluate::Rules;
use crate::faults::{self, Stop};
use crate::output::{self, Style};
use crate::run::Run;
use crate::statement::{Complex, ComputedWord, Statement};
use crate::value::Value;

impl Run<'_, '_> {
    /// The block's words with their numbers, but for the block `number` that is dropped.
    pub(crate) fn edited(
        &mut self,
        statement: &Statement,
        complex: &Complex,
        base: &[u8],
        mut number: Option<Span>,
    ) -> Result<Vec<u8>, Stop> {
        let mut text = Vec::with_capacity(base.len() + 32);
        let mut from = 0_usize;
        let cycle = statement.flags.cycle.unwrap_or(self.cycle);
        for word in &complex.words {
            if let Some(span) =
                number.filter(|span| span.start <= word.span.start && word.span.start < span.end)
            {
                // The block number itself is computed, and goes.
                text.extend_from_slice(&base[from..span.start as usize]);
                from = span.end.max(word.span.end) as usize;
                number = None;
                continue;
            }
            if let Some(span) = number.filter(|span| span.end <= word.span.start) {
                text.extend_from_slice(&base[from..span.start as usize]);
                from = span.end as usize;
                number = None;
            }
            text.extend_from_slice(&base[from..word.span.start as usize]);
            from = word.span.end as usize;
            self.word(&mut text, word, cycle)?;
        }
        if let Some(span) = number {
            text.extend_from_slice(&base[from..span.start as usize]);
            from = span.end as usize;
        }
        text.extend_from_slice(&base[from..]);
        Ok(text)
    }

    /// In the unit in force.
    pub(crate) fn least_increment_decimals(&self) -> u8 {
        let numbers = &self.dialect.numbers;
        if self.inch { numbers.least_increment_decimals_inch } else { numbers.least_increment_decimals_mm }
    }

    /// One word with its number; an empty variable leaves no word.
    fn word(&mut self, text: &mut Vec<u8>, word: &ComputedWord, cycle: bool) -> Result<(), Stop> {
        let fanuc = self.dialect.flow.macros == Macros::Fanuc;
        let decimals = self.least_increment_decimals();
        let rules = Rules { flow: self.dialect.flow, round_decimals: fanuc.then_some(decimals) };
        let value = match rules.evaluate(&word.value, &self.store).map_err(Stop::Fault)? {
            Value::Number(value) | Value::Rounded(value) => value,
            Value::Null => return Ok(()),
            Value::Unknown(variable) => return Err(Stop::Unknown(variable)),
        };
        if word.comma {
            text.push(b',');
        }
        let slack = if fanuc { 1e-7 } else { 1e-4 };
        let near = (value - value.round()).abs() <= slack;
        let letter = word.letter as char;
        let style = match word.letter {
            b'G' => {
                let tenths = (value * 10.0).round();
                if (value * 10.0 - tenths).abs() > 10.0 * slack || !(0.0..65536.0).contains(&tenths) {
                    return Err(faults::no_code(letter, value));
                }
                self.computed_g(GCode(tenths as u16), value)?;
                if tenths % 10.0 == 0.0 { Style::Whole } else { Style::Decimals(1) }
            }
            b'M' if near && self.decides_flow(value.round()) => {
                return Err(faults::no_code(letter, value));
            }
            b'M' | b'N' | b'O' | b'T' | b'H' | b'D' | b'L' if !near => {
                return Err(faults::no_code(letter, value));
            }
            b'M' | b'N' | b'O' | b'T' | b'H' | b'D' | b'L' => Style::Whole,
            b'K' if cycle && near => Style::Whole,
            b'P' | b'S' if near && value.round() == value => Style::Whole,
            // Pecks and angles of lathes count increments: a point would make millimetres of them.
            b'Q' if fanuc && self.dialect.turning.is_some() && near => Style::Whole,
            b'Q' if fanuc && self.dialect.turning.is_some() => return Err(faults::no_code(letter, value)),
            b'P' | b'S' if fanuc => return Err(faults::no_code(letter, value)),
            _ => Style::Decimals(if fanuc || self.dialect.marks.labels { 6 } else { 9 }),
        };
        let length = text.len();
        let styles: &[Style] = if let Style::Decimals(2..) = style {
            &[style, Style::Decimals(6), Style::Decimals(3)]
        } else {
            &[style]
        };
        for style in styles {
            if output::word(text, word.letter, value, *style).is_some() {
                if let Some((before, behind)) = &word.around {
                    text.splice(length..=length, before.iter().copied());
                    text.extend_from_slice(behind);
                }
                return Ok(());
            }
            text.truncate(length);
        }
        Err(faults::too_large(letter, value))
    }

    /// True for M codes that end, call or return.
    fn decides_flow(&self, code: f64) -> bool {
        let row = self.dialect.m_code(code.clamp(0.0, 65535.0) as u16);
        matches!(code, 98.0 | 99.0 | 198.0)
            || row.is_some_and(|row| row.ends_program || row.refuse.is_some() || row.switches.is_some())
    }

    /// A G code from a variable sets what it sets.
    fn computed_g(&mut self, code: GCode, value: f64) -> Result<(), Stop> {
        if self.dialect.flow.macros == Macros::Fanuc && matches!(code.0, 650..=669) {
            return Err(faults::no_code('G', value));
        }
        match self.dialect.code(code).map(|row| &row.action) {
            Some(Action::Inch) => self.units(true),
            Some(Action::Millimetre) => self.units(false),
            Some(Action::Cycle(_)) => self.cycle = true,
            Some(Action::CycleCancel | Action::Rapid | Action::Line) => self.cycle = false,
            _ => {}
        }
        Ok(())
    }
}
