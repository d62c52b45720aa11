//! CYCLE800 of Sinumerik: a tilted working plane by its arguments, to which the control turns the rotary axes itself.
//!
//! `CYCLE800(_FR, _TC, _ST, _MODE, _X0, _Y0, _Z0, _A, _B, _C, _X1, _Y1, _Z1, _DIR, _FR_I, _DMODE)`: the work offset's zero
//! goes to X0 Y0 Z0, turns there about three axes one after the other, each as it lies by then (`_MODE` says in which
//! order;
//! `_A` is the first angle, whichever its axis), and goes on to X1 Y1 Z1 along the turned axes. The retraction of `_FR` is
//! the control's own rapid to places that no program names; behind the cycle nobody knows where X, Y and Z stand in the
//! plane, with a retraction or without.

use diagnostic::{Diagnostic, Text, both, refusal};
use nc_syntax::Span;
use toolpath::{AngleValue, Kinematics, Plane, TiltedPlane};

use crate::brackets::arguments;
use crate::codes;
use crate::environment::Environment;
use crate::frame_state::refresh;
use crate::modal::{Axis, Modal, Units};
use crate::position::require_frame;
use crate::tilted::{Aligning, declared, lose, not_certain};
use crate::words::{Outcome, Words};
use nc_syntax::Letters;

const NAMES: [&str; 16] = [
    "_FR", "_TC", "_ST", "_MODE", "_X0", "_Y0", "_Z0", "_A", "_B", "_C", "_X1", "_Y1", "_Z1", "_DIR",
    "_FR_I", "_DMODE",
];
const RETRACTION: usize = 0;
const DATA_SET: usize = 1;
const STATUS: usize = 2;
const MODE: usize = 3;
const BEFORE: usize = 4;
const ANGLES: usize = 7;
const BEHIND: usize = 10;
const DIRECTION: usize = 13;
const WAY_BACK: usize = 14;
const DISPLAY: usize = 15;

/// Where a call stands, for its refusals.
struct Call<'c, 'b, 'a, 'd> {
    words: &'c Words<'b, 'a, 'd>,
    span: Span,
    arguments: Vec<&'c str>,
}

/// What a call asks for.
struct Swivel {
    /// It adds to the plane in force.
    adds: bool,
    before_mm: [f64; 3],
    turn: [[f64; 3]; 3],
    behind_mm: [f64; 3],
    /// Nothing is turned or shifted.
    is_none: bool,
    /// `None`: nothing turns.
    value: Option<AngleValue>,
}

impl Call<'_, '_, '_, '_> {
    fn refuse(&self, what: &Text, label: Text, help: Text) -> Box<Diagnostic> {
        self.words.refuse(
            refusal!(codes::TILTED_PLANE; "CYCLE800 {what}", "CYCLE800 {what:#}"; label; help),
            self.span,
        )
    }

    /// A plain number; an argument left out is 0.
    fn number(&self, place: usize) -> Outcome<f64> {
        let text = self.arguments.get(place).copied().unwrap_or_default();
        let plain = text.bytes().all(|byte| byte.is_ascii_digit() || matches!(byte, b'+' | b'-' | b'.'));
        match text.parse::<f64>() {
            _ if text.is_empty() => Ok(0.0),
            Ok(value) if plain => Ok(value),
            _ => Err(self.refuse(
                &both!("with {} = `{text}`", "с {} = `{text}`", NAMES[place]),
                both!("not a plain number", "не просто число"),
                both!(
                    "write the number itself, without variables and calculations",
                    "напишите само число, без переменных и вычислений"
                ),
            )),
        }
    }

    fn whole(&self, place: usize) -> Outcome<u32> {
        let value = self.number(place)?;
        if !(0.0..=999_999.0).contains(&value) || value.fract() != 0.0 {
            return Err(
                self.unknown(place, &both!("no value that the cycle has", "такого значения у цикла нет"))
            );
        }
        Ok(value as u32)
    }

    /// The refusal of a value, and what may stand there.
    fn unknown(&self, place: usize, why: &Text) -> Box<Diagnostic> {
        let text = self.arguments.get(place).copied().unwrap_or_default();
        let may = match place {
            RETRACTION => both!("write 0, 1, 2, 4 or 5", "напишите 0, 1, 2, 4 или 5"),
            STATUS => both!(
                "write 0 for a new plane, 1 for one on top of that in force; 100000 beside _DIR -1 and 200000 beside _DIR 1 may be added",
                "напишите 0 для новой плоскости или 1 для добавочной; при _DIR -1 можно прибавить 100000, при _DIR 1 — 200000"
            ),
            MODE => both!(
                "write the plane axis by axis: 57 for X Y Z, 45 X Z Y, 54 Y X Z, 30 Y Z X, 39 Z X Y, 27 Z Y X",
                "задайте плоскость поворотами по осям: 57 — X Y Z, 45 — X Z Y, 54 — Y X Z, 30 — Y Z X, 39 — Z X Y, 27 — Z Y X"
            ),
            DIRECTION => both!(
                "write -1 for the lower angle of the reference axis, 1 for the higher",
                "напишите -1 для меньшего угла опорной оси, 1 для большего"
            ),
            WAY_BACK => both!("write 0 or more", "напишите 0 или больше"),
            _ => both!("write 0 or 1 (G17)", "напишите 0 или 1 (G17)"),
        };
        self.refuse(&both!("with {} = `{text}`", "с {} = `{text}`", NAMES[place]), why.clone(), may)
    }

    fn lengths_mm(&self, first: usize, units: Units) -> Outcome<[f64; 3]> {
        let [x, y, z] = [0, 1, 2].map(|axis| self.number(first + axis));
        let found = [x?, y?, z?];
        if units == Units::Inch && found != [0.0; 3] {
            return Err(self.refuse(
                &both!("with lengths under inches", "с длинами в дюймах"),
                both!(
                    "inches, or the unit of the control's set-up? G70 and G700 differ",
                    "дюймы или единица, настроенная на стойке? у G70 и G700 по-разному"
                ),
                both!("write G710 before it", "напишите перед ней G710"),
            ));
        }
        Ok(found)
    }

    /// The axes in the order of their turns, by two bits each: 1 is X, 2 is Y, 3 is Z.
    fn order(&self) -> Outcome<[usize; 3]> {
        let mode = self.whole(MODE)?;
        let axes = [mode & 3, mode >> 2 & 3, mode >> 4 & 3].map(|axis| axis as usize);
        let mut each = axes;
        each.sort_unstable();
        let why = match mode >> 6 {
            0 if each == [1, 2, 3] => return Ok(axes.map(|axis| axis - 1)),
            0 => both!(
                "axis by axis, and not X, Y and Z once each",
                "по осям, но X, Y и Z стоят не по одному разу"
            ),
            1 => both!(
                "by a solid angle: about which axis is not certain",
                "пространственный угол: вокруг какой оси, неясно"
            ),
            2 => both!(
                "by projected angles: which turn that is, is not certain",
                "углы проекций: какой это поворот, неясно"
            ),
            3 => both!(
                "by the rotary axes' own angles: how X and Y of the plane lie then, the control chooses",
                "сами углы поворотных осей: как тогда лежат X и Y плоскости, выбирает стойка"
            ),
            _ => both!("no value that the cycle has", "такого значения у цикла нет"),
        };
        Err(self.unknown(MODE, &why))
    }

    /// Digits of _ST, beside _DIR.
    fn status(&self, direction: i8) -> Outcome<bool> {
        let status = self.whole(STATUS)?;
        let digit = |place: u32| status / 10_u32.pow(place) % 10;
        let why = if digit(0) > 1 || digit(1) > 1 {
            both!("no value that the cycle has", "такого значения у цикла нет")
        } else if digit(2) != 0 {
            both!(
                "its hundreds align the tool instead of the plane",
                "сотни в нём поворачивают не плоскость, а инструмент"
            )
        } else if digit(3) != 0 || digit(4) != 0 {
            both!(
                "its thousands belong to the panel, or let nothing turn",
                "тысячи в нём принадлежат пульту или запрещают поворот"
            )
        } else if !matches!((digit(5), direction), (0, _) | (1, -1) | (2, 1)) {
            both!("asks for another direction than _DIR", "просит другого направления, чем _DIR")
        } else {
            return Ok(digit(0) == 1);
        };
        Err(self.unknown(STATUS, &why))
    }

    fn read(&self, state: &Modal) -> Outcome<Swivel> {
        if let Some(extra) = self.arguments.get(NAMES.len()) {
            return Err(self.refuse(
                &both!("with a seventeenth argument", "с семнадцатым аргументом"),
                both!("`{extra}` is not known", "`{extra}` неизвестен"),
                both!("remove it", "уберите его"),
            ));
        }
        if !matches!(self.whole(RETRACTION)?, 0 | 1 | 2 | 4 | 5) {
            return Err(self.unknown(RETRACTION, &both!("which way is that?", "какой это отвод?")));
        }
        if self.number(WAY_BACK)? < 0.0 {
            return Err(self.unknown(WAY_BACK, &both!("a way back below 0", "отвод меньше 0")));
        }
        let along = || both!("the tool does not stand along Z then", "инструмент тогда стоит не вдоль Z");
        if self.whole(DISPLAY)? > 1 {
            return Err(self.unknown(DISPLAY, &along()));
        }
        if state.plane != Plane::Xy {
            let what = both!("under G18 or G19", "при G18 или G19");
            let help = both!("write G17 before it", "напишите перед ней G17");
            return Err(self.refuse(&what, along(), help));
        }
        let direction = match self.arguments.get(DIRECTION).copied().unwrap_or_default() {
            "-1" => -1,
            "1" | "+1" => 1,
            "0" => 0,
            "" => {
                return Err(
                    self.unknown(DIRECTION, &both!("which way is not said", "куда поворачивать, не сказано"))
                );
            }
            _ => return Err(self.unknown(DIRECTION, &both!("no direction", "не направление"))),
        };
        let adds = self.status(direction)?;
        let [first, second, third] = [0, 1, 2].map(|place| self.number(ANGLES + place));
        let angles_deg = [first?, second?, third?];
        let order = self.order()?;
        let [before_mm, behind_mm] = [BEFORE, BEHIND].map(|first| self.lengths_mm(first, state.units));
        let (before_mm, behind_mm) = (before_mm?, behind_mm?);
        let is_none = angles_deg == [0.0; 3] && !adds;
        let stands = state.axes.rotary == [Axis::At(0.0); 3];
        if direction == 0 && !(is_none && stands) {
            return Err(self.unknown(
                DIRECTION,
                &both!(
                    "the plane is computed for axes that do not turn: for which of two ways is not certain",
                    "плоскость считается для осей, которые не поворачиваются: для какого из двух положений, неясно"
                ),
            ));
        }
        let turn = TiltedPlane::turn_by_axes(order, angles_deg);
        let value = match direction {
            0 => None,
            1.. => Some(AngleValue::Higher),
            _ => Some(AngleValue::Lower),
        };
        Ok(Swivel { adds, before_mm, turn, behind_mm, is_none, value })
    }
}

/// CYCLE800 with arguments.
pub(crate) fn execute(
    env: &Environment<'_>,
    words: &Words<'_, '_, '_>,
    span: Span,
    state: &mut Modal,
) -> Outcome<()> {
    let text = words.text(span);
    let call = Call { words, span, arguments: arguments(&text) };
    let others = words.letters.without(Letters::of(b"NO"));
    if !others.is_empty() || !words.codes.is_empty() || !words.m_codes.is_empty() {
        return Err(call.refuse(
            &both!("beside something else", "рядом с чем-то ещё"),
            both!("a block of its own was expected", "ожидался отдельный кадр"),
            both!("write it in a block of its own", "напишите её отдельным кадром"),
        ));
    }
    // The name of the data set that nobody has: the plane ends, behind the retraction.
    if call.arguments.get(DATA_SET) == Some(&"\"0\"") {
        if state.kinematics == Kinematics::Tip {
            return Err(under_tip_control(&call));
        }
        state.kinematics = Kinematics::Axes;
        lose(words, state);
        return Ok(());
    }
    declared(env, words, span)?;
    if state.kinematics == Kinematics::Tip {
        return Err(under_tip_control(&call));
    }
    let swivel = call.read(state)?;
    let base = match state.kinematics {
        Kinematics::Plane(plane) if swivel.adds => plane,
        _ => {
            state.kinematics = Kinematics::Axes;
            refresh(state);
            let applied_mm = state.tool_length.applied_mm();
            let zero_mm = require_frame(env, words, state)?.to_machine([0.0; 3]);
            let zero_mm = [0, 1, 2].map(|i| zero_mm[i] - applied_mm[i]);
            TiltedPlane { turn: TiltedPlane::turn_about(2, 0.0), zero_mm }
        }
    };
    let plane = base.then(swivel.before_mm, swivel.turn, swivel.behind_mm);
    state.kinematics = Kinematics::Plane(plane);
    // Where nothing is tilted and all axes stand at 0 every control lets them stand.
    let rests = swivel.is_none && state.axes.rotary == [Axis::At(0.0); 3];
    if let Some(value) = swivel.value.filter(|_| !rests) {
        turn(env, words, span, &plane, value, state)?;
    }
    lose(words, state);
    Ok(())
}

/// Turns the rotary axes to a plane.
fn turn(
    env: &Environment<'_>,
    words: &Words<'_, '_, '_>,
    span: Span,
    plane: &TiltedPlane,
    value: AngleValue,
    state: &mut Modal,
) -> Outcome<()> {
    let stand = state.axes.rotary.map(Axis::known);
    let chain = &env.setup.rotary_chain;
    let angles = chain
        .angles_by_value(plane.normal(), value, &env.setup.tilt_rule, stand)
        .map_err(|why| not_certain(words, span, why, Aligning::Swivel))?;
    for axis in (0..3).filter(|axis| env.setup.has_rotary[*axis]) {
        state.axes.rotary[axis] = Axis::At(angles[axis]);
    }
    Ok(())
}

fn under_tip_control(call: &Call<'_, '_, '_, '_>) -> Box<Diagnostic> {
    call.refuse(
        &both!("under tool centre point control", "при управлении по вершине инструмента"),
        both!(
            "do X, Y and Z count in the plane then, or in the workpiece?",
            "в чьих координатах тогда X, Y и Z: плоскости или детали?"
        ),
        both!("write TRAFOOF before it", "напишите перед ней TRAFOOF"),
    )
}
