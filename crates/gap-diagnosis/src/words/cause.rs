//! Each cause in a sentence that a metrologist would say, and what not to do about it.

use diagnostic::{Text, both};
use machine_model::Vector;

use crate::effects::{self, Size};
use crate::equations::term::Term;
use crate::judgement::assembly::Assembly;

/// What stands in the place of a remedy where the causes do not explain the gap, or unseen rows refute them.
pub(crate) const DO_NOT_ACT: Text = Text::pair(
    "Do not act on this: what is left of the gap has no name yet, or rows that were not fitted contradict it, or other explanations would be made worse by it.",
    "Ничего по этому не делайте: у остатка расхождения ещё нет названия, или строки вне подгонки этому противоречат, или при других объяснениях станет хуже.",
);

/// Why nothing is written of causes that leave a part of the gap open.
pub(crate) const NO_NAME_YET: Text = Text::pair(
    "No correction is made of the causes: what is left of the gap has no name yet, and no rows that were not fitted confirm them.",
    "По причинам ничего не исправляется: у остатка расхождения ещё нет названия, и строки вне подгонки их не подтверждают.",
);

/// Why nothing is written of a play below zero.
pub(crate) const TURNED: Text = Text::pair(
    "No correction is made of the causes: a play below zero is mostly a slip of the file. Is the direction of approach (dir_x, dir_y, dir_z) the wrong way round, or the sign of the readings (measured minus commanded)?",
    "По причинам ничего не исправляется: отрицательный люфт — чаще всего ошибка файла. Не обратное ли направление подхода (dir_x, dir_y, dir_z) и не обратный ли знак показаний (измеренное минус заданное)?",
);

/// What stands there for play of the wrong sign.
pub(crate) const NO_PLAY: Text = Text::pair(
    "This is no play: the reversal is over-compensated (lower the control's backlash value), or the sensor sits on the motor's side of it.",
    "Это не люфт: реверс перекомпенсирован (уменьшите значение люфта в ЧПУ) или датчик стоит со стороны двигателя.",
);

impl Assembly<'_> {
    /// The part at a place of the model in words, with its size where it was measured.
    pub(crate) fn words(&self, place: usize) -> Text {
        let kind = self.model.library.kind(self.model.parts[place]);
        let own = self.own(place);
        let first = own.first().map_or(0.0, |(_, value)| *value);
        let shape = own.iter().find_map(|(term, _)| term.shape()).unwrap_or_default();
        let row = own.iter().find_map(|(term, _)| match term {
            Term::Knock { from, .. } => self.data.rows.iter().find(|row| row.order[0] >= *from),
            _ => None,
        });
        let moment = match (row, shape.time_s) {
            (Some(row), _) => both!("from line {} on", "со строки {}", row.line),
            (None, time_s) => both!("at {time_s:.0} s", "в момент {time_s:.0} с"),
        };
        let size = first.abs();
        // `X` of one axis, `XY` of two, `EYX` of what shows along Y as X moves.
        let id = kind.to_string();
        let of = id.split_once('.').map_or("", |(_, of)| of.trim_start_matches('E'));
        let (a, b) = of.split_at_checked(1).unwrap_or_default();
        (effects::of(kind).words)(&Size {
            of,
            a,
            b,
            first,
            size,
            per_100_mm: 0.1 * size,
            twice: 2.0 * size,
            swing: self.swing_um(&own),
            pitch_mm: shape.pitch_mm,
            tau_min: shape.tau_s / 60.0,
            moment: &moment,
            centre_mm: shape.centre_mm,
            width_mm: shape.width_mm,
            way_mm: 2.3 * shape.width_mm,
        })
    }

    /// From the least to the most that some terms displace the rows, along the direction where that is largest, µm.
    fn swing_um(&self, terms: &[(Term, f64)]) -> f64 {
        let (mut low, mut high) = (Vector::repeat(f64::INFINITY), Vector::repeat(f64::NEG_INFINITY));
        for moved in crate::equations::align::displacements(self.data, terms) {
            (low, high) = (low.inf(&moved), high.sup(&moved));
        }
        (high - low).max().max(0.0)
    }
}
