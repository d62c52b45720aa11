//! Tools of a profile: lengths, names and radii.

use std::collections::BTreeSet;

use diagnostic::{Text, both};

use crate::error::{CONFLICT, KEY, VALUE};
use crate::format::{self, Document};
use crate::loader::Loader;
use crate::number::{Finite, Length, Spanned};
use crate::profile::LatheParts;

impl Loader<'_> {
    /// Where lengths count from, where that is not the gauge point.
    pub(crate) fn gauge_point(&mut self, document: &Document, lathe: Option<&LatheParts>) -> Option<f64> {
        let written = document.tool.gauge_point_mm.as_ref()?;
        let conflict = if document.kinematics.is_some() {
            Some((
                both!(
                    "`gauge_point_mm` and `[kinematics]`: the control turns tools about what it takes for the gauge point",
                    "`gauge_point_mm` и `[kinematics]`: стойка поворачивает инструмент вокруг того, что считает базовой точкой"
                ),
                both!(
                    "give lengths from the gauge point, on the control and here, and leave `gauge_point_mm` out",
                    "задайте длины от базовой точки, на стойке и здесь, и уберите `gauge_point_mm`"
                ),
            ))
        } else if lathe.is_some() {
            Some((
                both!(
                    "`gauge_point_mm` in the profile of a lathe",
                    "`gauge_point_mm` в профиле токарного станка"
                ),
                both!(
                    "give `lengths_mm` from the point of the turret that the tables were measured at",
                    "задайте `lengths_mm` от той точки револьверной головки, в которой измерены таблицы"
                ),
            ))
        } else {
            None
        };
        if let Some((message, help)) = conflict {
            self.refuse(written, CONFLICT, message, both!("this key", "этот ключ"), help);
        }
        Some(written.get_ref().0)
    }

    /// Names of tools, each with a length that is given.
    pub(crate) fn tool_names(
        &mut self,
        written: &format::Tool,
        tools: &[(u32, [f64; 3])],
    ) -> Vec<(String, u32)> {
        for (name, number) in &written.names {
            if tools.iter().all(|(known, _)| known != number.get_ref()) {
                let message = both!(
                    "the tool \"{name}\" has the length H{}",
                    "у инструмента \"{name}\" длина H{}",
                    number.get_ref()
                );
                let label = both!("lengths_mm has no such length", "такой длины в lengths_mm нет");
                let help = both!(
                    "add the length to `lengths_mm`, or correct the number",
                    "добавьте длину в `lengths_mm` или исправьте номер"
                );
                self.refuse(number, KEY, message, label, help);
            }
        }
        written.names.iter().map(|(name, number)| (name.clone(), *number.get_ref())).collect()
    }

    /// Radii of a mill's cutters by D number.
    pub(crate) fn cutter_radii(&mut self, document: &Document) -> Vec<(u32, f64)> {
        let mut radii = Vec::new();
        for (name, radius) in &document.tool.radii_mm {
            let Finite(mm) = *radius.get_ref();
            match numbered(name, 'D') {
                Some(number) if mm > 0.0 && document.spindle.is_none() => radii.push((number, mm)),
                Some(_) if mm > 0.0 => {
                    let message = both!(
                        "`radii_mm` in the profile of a lathe",
                        "`radii_mm` в профиле токарного станка"
                    );
                    let help = both!(
                        "give the radius of a turning tool under `noses`",
                        "радиус при вершине резца задайте в `noses`"
                    );
                    self.refuse(radius, CONFLICT, message, both!("this key", "этот ключ"), help);
                }
                Some(_) => {
                    let message = both!("the radius of `{name}` is {mm}", "радиус `{name}` — {mm}");
                    let help = both!("write millimetres above 0", "напишите миллиметры больше 0");
                    self.refuse(radius, VALUE, message, both!("this radius", "этот радиус"), help);
                }
                None => self.refuse_number(radius, name, 'D', 6.0),
            }
        }
        radii.sort_by_key(|(number, _)| *number);
        radii
    }

    pub(crate) fn tools(&mut self, written: &format::Tool) -> Vec<(u32, [f64; 3])> {
        let mut tools = Vec::new();
        let mut known = BTreeSet::new();
        for (name, length) in &written.lengths_mm {
            match numbered(name, 'H') {
                Some(number) if !known.insert(number) => {
                    let message =
                        both!("tool H{number} stands there twice", "инструмент H{number} стоит там дважды");
                    self.refuse(length, CONFLICT, message, both!("again here", "здесь ещё раз"), Text::EMPTY);
                }
                Some(number) => tools.push((
                    number,
                    match length.get_ref() {
                        Length::Number(Finite(z)) => [0.0, 0.0, *z],
                        Length::Vector(v) => v.map(|Finite(v)| v),
                    },
                )),
                None => self.refuse_number(length, name, 'H', 120.0),
            }
        }
        tools.sort_by_key(|(number, _)| *number);
        tools
    }

    /// A key that is no letter with a number.
    fn refuse_number<T>(&mut self, at: &Spanned<T>, name: &str, letter: char, value: f64) {
        let message = both!("`{name}` is no {letter} number", "`{name}` — не номер {letter}");
        let help = both!(
            "write {letter} and a whole number from 1, like {letter}1 = {value:.1}",
            "напишите {letter} и целое число от 1, например {letter}1 = {value:.1}"
        );
        self.refuse(at, KEY, message, both!("of this entry", "в этой записи"), help);
    }
}

/// The number behind a letter, from 1: 7 of `H7`.
fn numbered(name: &str, letter: char) -> Option<u32> {
    let digits = name.strip_prefix(letter).filter(|digits| digits.bytes().all(|b| b.is_ascii_digit()))?;
    digits.parse().ok().filter(|number| *number > 0)
}
