//! What this room's errors say, in Russian; English stands with the errors.

use diagnostic::Speaks;

use crate::effects::{EffectError, MissingCondition, UnknownEffect};
use crate::engines::BuildError;
use crate::engines::FieldError;
use crate::{ChainError, SolveError, TableError, UnknownCondition, Unusable};

impl Speaks for ChainError {
    fn russian(&self) -> String {
        match self {
            Self::Form => {
                "цепь пишется так: [w X Y b Z t] — звенья через пробел в квадратных скобках".to_owned()
            }
            Self::UnknownLink(link) => {
                format!("`{link}` — не звено цепи: ожидалось w, b, t или одно из X Y Z A B C")
            }
            Self::Twice(link) => format!("`{link}` стоит в цепи дважды"),
            Self::Lacks(link) => format!(
                "в цепи нет `{link}`: она начинается с w (деталь), кончается на t (инструмент), между ними b (станина)"
            ),
            Self::LacksLinear(axis) => format!("в цепи нет линейной оси {axis}"),
            Self::RotaryBetweenLinear(axis) => format!(
                "{axis} стоит между линейными осями: поворотные оси стоят рядом с деталью или рядом с инструментом"
            ),
        }
    }
}

/// A condition in the genitive: an effect depends on it.
fn condition(condition: MissingCondition) -> &'static str {
    match condition.0 {
        "time" => "времени",
        "feed" => "подачи",
        "temperature" => "температуры",
        "load" => "нагрузки",
        "place of the station" => "места трекера",
        other => other,
    }
}

impl Speaks for MissingCondition {
    fn russian(&self) -> String {
        format!("эффект зависит от {}, а это здесь неизвестно", condition(*self))
    }
}

impl Speaks for UnknownCondition {
    fn russian(&self) -> String {
        format!("эффект {} зависит от {}, а это здесь неизвестно", self.effect, condition(self.condition))
    }
}

impl Speaks for UnknownEffect {
    fn russian(&self) -> String {
        format!(
            "эффект '{}' неизвестен; известны, например, scale.X, backlash.Y, squareness.XZ, straightness.EYX, angular.EAX",
            self.0
        )
    }
}

impl Speaks for EffectError {
    fn russian(&self) -> String {
        match self {
            Self::Unknown(unknown) => unknown.russian(),
            Self::UnknownParameter { id, name, known } => {
                format!("у {id} нет параметра '{name}'; есть {known}")
            }
            Self::Twice { id, name } => format!("{id}: '{name}' дано дважды"),
            Self::Missing { id, name } => format!("для {id} нужно '{name}'"),
            Self::Value { id, name, value, reason } => {
                let reason = match *reason {
                    "it must be a finite number" => "нужно конечное число",
                    "it must be above zero" => "нужно больше нуля",
                    "it must exceed from_mm" => "нужно больше from_mm",
                    other => other,
                };
                format!("{id}: '{name}' = {value} невозможно: {reason}")
            }
        }
    }
}

impl Speaks for SolveError {
    fn russian(&self) -> String {
        match self {
            Self::OutsideVolume { axis, value_mm, low_mm, high_mm } => format!(
                "ось {axis} в {value_mm:.3} мм лежит вне калиброванных пределов от {low_mm:.3} до {high_mm:.3} мм"
            ),
            Self::OutsideRotaryRange { axis, value_deg, low_deg, high_deg } => format!(
                "ось {axis} в {value_deg:.4}° лежит вне своих пределов от {low_deg:.4}° до {high_deg:.4}°"
            ),
            Self::NotConverged { iterations, residual_mm } => format!(
                "обратная задача не сходится: после итераций, которых было {iterations}, остаётся {residual_mm:.3e} мм"
            ),
            Self::OutsideVectors { place_mm: [x, y, z] } => {
                format!("X {x:.3} Y {y:.3} Z {z:.3} лежит в коробке измеренных векторов, но за их оболочкой")
            }
            Self::OtherTool { found_mm: [a, b, c], measured_mm: [x, y, z] } => format!(
                "вектор инструмента {a:.3} {b:.3} {c:.3} мм — не тот, с которым измерены векторы, {x:.3} {y:.3} {z:.3} мм, а углов поле не знает"
            ),
            Self::Undefined(_, russian) => (*russian).to_owned(),
        }
    }
}

impl Speaks for BuildError {
    fn russian(&self) -> String {
        match self {
            Self::Missing { engine, what, add } => {
                let what = match *what {
                    "three axis traverses of a laser tracker" => {
                        "три прохода по осям, снятые лазерным трекером"
                    }
                    "the error tables of X, Y and Z" => "таблицы погрешностей X, Y и Z",
                    "a kinematic chain" => "кинематическая цепь",
                    other => other,
                };
                let add = match *add {
                    "[tracker] with x, y and z" => "раздел [tracker] с x, y и z",
                    "[axis.X], [axis.Y] and [axis.Z] with errors" => {
                        "разделы [axis.X], [axis.Y] и [axis.Z] с errors"
                    }
                    "`chain` and [axis.X], [axis.Y], [axis.Z]" => {
                        "`chain` и разделы [axis.X], [axis.Y], [axis.Z]"
                    }
                    other => other,
                };
                format!(
                    "методу `{engine}` нужно то, чего в профиле нет: {what}; добавьте {add} или выберите другой метод ключом `--engine`"
                )
            }
            Self::TraverseOfOtherAxis { axis } => format!(
                "в проходе {axis} раздела [tracker] движется не одна {axis}, или в нём не хватает измеренных положений"
            ),
            Self::TraverseTooShort { axis, found, needed } => format!(
                "положений в проходе {axis} раздела [tracker]: {found}, а методу нужно не меньше {needed}"
            ),
            Self::NoCommonOrigin { axis, first_mm, second_mm } => format!(
                "проходы раздела [tracker] не сходятся в одной точке: {axis} стояла в {first_mm} мм и {second_mm} мм, пока двигались другие оси, а её собственный проход должен там пройти"
            ),
            Self::UnequalSteps { axis } => {
                format!("методу `kmtpp-published` нужна таблица {axis} с равным шагом от 0 мм")
            }
            Self::Singular => "направления осей в [tracker] лежат в одной плоскости".to_owned(),
            Self::Table(error) => error.russian(),
        }
    }
}

impl Speaks for TableError {
    fn russian(&self) -> String {
        match self {
            Self::TooShort(rows) => format!("в таблице нужно не меньше 2 строк, а в этой {rows}"),
            Self::Lengths { nodes, values } => format!("узлов {nodes}, а значений {values}"),
            Self::NotFinite { row } => format!("в строке {row} не конечное число"),
            Self::NotIncreasing { row, position, before } => {
                format!("строка {row}: положение {position} не больше {before} из строки перед ней")
            }
        }
    }
}

impl Speaks for Unusable {
    fn russian(&self) -> String {
        format!("ось {}: у её таблиц и её хода нет общего отрезка", self.axis)
    }
}

impl Speaks for FieldError {
    fn russian(&self) -> String {
        match self {
            Self::TooFew { found, needed } => {
                format!(
                    "мест с векторами погрешности {found}; полю с заданным шумом нужно не меньше {needed}"
                )
            }
            Self::Flat { shape } => format!(
                "все векторы погрешности измерены {}: об объёме вокруг они ничего не говорят",
                match *shape {
                    "place" => "в одной точке",
                    "line" => "на одной прямой",
                    _ => "в одной плоскости",
                }
            ),
            Self::Repeated { component, apart_mm, allowed_mm, .. } => {
                let why = if *allowed_mm > 0.0 {
                    format!("больше, чем объясняет их неопределённость ({:.2} мкм)", allowed_mm * 1e3)
                } else {
                    "а шум задан равным 0".to_owned()
                };
                let axis = ['X', 'Y', 'Z'][*component];
                format!("два вектора одной точки расходятся на {:.2} мкм по {axis}, {why}", apart_mm * 1e3)
            }
            Self::Hole { counts: [x, y, z], missing, place_mm } => format!(
                "в решётке из {x} x {y} x {z} узлов недостаёт {missing}, первый — X {} Y {} Z {}",
                place_mm.x, place_mm.y, place_mm.z
            ),
            Self::Scattered { places } => {
                format!("шум задан равным 0, а {places} точек не образуют полной решётки")
            }
            Self::Exact { .. } => "неопределённость 0 рядом с другими больше 0".to_owned(),
            Self::Noise(doubt) => format!(
                "векторы рассеяны около лучшего для них поля примерно на {:.3} мкм, а задан шум {:.3} мкм",
                doubt.scatter_mm * 1e3,
                doubt.stated_mm * 1e3
            ),
            Self::Offset { offset_mm, .. } => format!(
                "серия этого вектора лежит на {:.2} {:.2} {:.2} мкм в стороне от остальных: у неё своя установка или своё направление подхода",
                offset_mm.x * 1e3,
                offset_mm.y * 1e3,
                offset_mm.z * 1e3
            ),
            Self::NotDetermined => "места векторов не определяют поля".to_owned(),
        }
    }
}
