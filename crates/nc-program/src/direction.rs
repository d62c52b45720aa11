//! Where the tool points as a vector: I, J, K under G43.5, A3, B3, C3 under TRAORI.
//!
//! The vector leads from the tip up, in the frame of the workpiece, which turns with the table. Which angles the control
//! makes of it is the machine's kinematics, and of two ways and all whole turns the nearest to where the axes stand; where two
//! are as near, the branch of the profile.

use diagnostic::{Refusal, both, refusal};
use nc_syntax::Letters;
use toolpath::{AXIS_NAMES, Kinematics, NoAngles, unit};

use crate::codes;
use crate::environment::Environment;
use crate::modal::{Axis, Modal, MotionMode};
use crate::position::require_rotary;
use crate::refusals::direction as refusal;
use crate::setup::BetweenVectors;
use crate::words::{AXIS_LETTERS, CENTRE_LETTERS, Outcome, ROTARY_LETTERS, SECONDARY_LETTERS, Words};

/// The words by which a block says where the tool points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DirectionWords {
    /// I, J, K.
    Ijk,
    /// A3, B3, C3, which are read as U, V, W.
    Abc3,
}

impl DirectionWords {
    /// The letters that they are read as.
    #[must_use]
    pub const fn letters(self) -> [u8; 3] {
        match self {
            Self::Ijk => *b"IJK",
            Self::Abc3 => *b"UVW",
        }
    }

    fn all(self) -> Letters {
        match self {
            Self::Ijk => CENTRE_LETTERS,
            Self::Abc3 => SECONDARY_LETTERS,
        }
    }
}

/// The words of a block that say where the tool points.
pub(crate) fn words_of(words: &Words<'_, '_, '_>, state: &Modal) -> Option<DirectionWords> {
    let straight =
        matches!(state.motion, MotionMode::Rapid(_) | MotionMode::Line(_)) && state.cycle.is_none();
    if words.names_direction() {
        Some(DirectionWords::Abc3)
    } else if state.vectors && straight && words.has(CENTRE_LETTERS) {
        Some(DirectionWords::Ijk)
    } else {
        None
    }
}

/// What does not go together with directions as vectors.
pub(crate) fn check(
    env: &Environment<'_>,
    words: &Words<'_, '_, '_>,
    state: &Modal,
    named: Option<DirectionWords>,
) -> Outcome<()> {
    if state.vectors && words.has(ROTARY_LETTERS) {
        return Err(
            words.refuse(refusal::under_g43_5(&words.names(ROTARY_LETTERS)), words.span(ROTARY_LETTERS))
        );
    }
    let Some(named) = named else {
        if state.vectors
            && matches!(state.motion, MotionMode::Arc(..))
            && words.has(AXIS_LETTERS.or(CENTRE_LETTERS))
        {
            return Err(words.refuse(refusal::ARC_UNDER_G43_5, words.span(AXIS_LETTERS.or(CENTRE_LETTERS))));
        }
        return Ok(());
    };
    let span = words.span(named.all());
    if words.has(ROTARY_LETTERS) {
        return Err(words.refuse(refusal::direction_beside(&words.names(ROTARY_LETTERS)), span));
    }
    if state.kinematics != Kinematics::Tip {
        return Err(words.refuse(refusal::DIRECTION_WITHOUT_TIP_CONTROL, span));
    }
    let straight = matches!(state.motion, MotionMode::Rapid(_) | MotionMode::Line(_));
    if !straight || state.cycle.is_some() {
        return Err(words.refuse(refusal::DIRECTION_WITHOUT_LINE, span));
    }
    let (label, help) = match env.setup.vectors {
        Some(BetweenVectors::Axes) => return Ok(()),
        Some(BetweenVectors::GreatCircle) => (
            both!(
                "the tool turns along a great circle on this control, and no path is proven for that",
                "на этой стойке инструмент поворачивается по большому кругу, и путь для этого не доказать"
            ),
            both!(
                "let the control run its rotary axes evenly (ORIAXES; Fanuc without tool posture control) and say `vectors = \"axes\"` under `[kinematics]`; or post rotary axes",
                "включите на стойке равномерный ход поворотных осей (ORIAXES; Fanuc без управления ориентацией) и впишите `vectors = \"axes\"` в раздел `[kinematics]`; или выводите поворотные оси"
            ),
        ),
        None => (
            both!(
                "what the control does between two directions is not said",
                "не сказано, как стойка переходит от одного направления к другому"
            ),
            both!(
                "write `vectors = \"axes\"` under `[kinematics]` in the profile where the rotary axes run evenly, `\"great-circle\"` where the tool turns in a plane",
                "впишите в раздел `[kinematics]` профиля `vectors = \"axes\"`, если поворотные оси идут равномерно, `\"great-circle\"`, если инструмент поворачивается в плоскости"
            ),
        ),
    };
    Err(words.refuse(
        refusal!(codes::DIRECTION_BETWEEN;
            "a direction as a vector cannot be followed", "направление вектором не проследить";
            label; help
        ),
        span,
    ))
}

/// A, B, C at the end of a block with a direction, degrees.
pub(crate) fn angles(
    env: &Environment<'_>,
    words: &Words<'_, '_, '_>,
    state: &Modal,
    named: DirectionWords,
) -> Outcome<[f64; 3]> {
    let span = words.span(named.all());
    let vector = named.letters().map(|letter| words.coordinate(letter, false).unwrap_or(0.0));
    let Some(direction) = unit(vector).filter(|unit| unit.iter().all(|part| part.is_finite())) else {
        return Err(words.refuse(refusal::DIRECTION_OF_NO_LENGTH, span));
    };
    require_rotary(words, &state.axes)?;
    let stand = state.axes.rotary.map(|axis: Axis| axis.known().unwrap_or(0.0));
    let name = |axis: usize| AXIS_NAMES[3 + axis];
    env.setup.rotary_chain.angles_near(direction, &env.setup.tilt_rule, stand).map_err(|why| {
        let (label, help) = match why {
            NoAngles::NotTwoAxes => (
                both!("this machine has not two rotary axes that tilt the tool", "у этого станка нет двух поворотных осей, наклоняющих инструмент"),
                both!("post rotary axes", "выводите поворотные оси"),
            ),
            NoAngles::OutOfReach => (
                both!("no angles within travel point the tool there", "в пределах хода нет углов с таким направлением инструмента"),
                both!("check the vector and `travel_deg` of the rotary axes", "проверьте вектор и `travel_deg` поворотных осей"),
            ),
            NoAngles::TwoWays | NoAngles::Turns(_) | NoAngles::HalfTurn(_) | NoAngles::Travel(_) => (
                both!("two pairs of angles are as near", "две пары углов одинаково близки"),
                both!("say which one the control takes: `branch = \"A+\"` under `[kinematics]` in the profile; or turn the axes by their own words before", "скажите, какую берёт стойка: `branch = \"A+\"` в разделе `[kinematics]` профиля; или поверните до этого оси их собственными словами"),
            ),
            NoAngles::Start(axis, degrees) => (
                both!("the tool stands along {}, which would have to turn by {degrees} degrees before the tool tilts", "инструмент стоит вдоль {}, и до наклона эту ось надо повернуть на {degrees}°", name(axis)),
                both!("turn {} there in a rapid by its own word, before G43.5 or without a direction in the block", "поверните туда {} быстрым ходом её собственным словом, до G43.5 или в кадре без направления", name(axis)),
            ),
            NoAngles::Free(axis) | NoAngles::Unknown(axis) => (
                both!("{} may stand anywhere then", "{} может тогда стоять где угодно", name(axis)),
                both!("post rotary axes here", "выводите здесь поворотные оси"),
            ),
        };
        let message = both!("where a direction turns the rotary axes is not certain", "куда направление повернёт поворотные оси, неясно");
        let refusal: Box<diagnostic::Diagnostic> =
            words.refuse(Refusal { code: codes::DIRECTION_ANGLES, message, label, help }, span);
        refusal
    })
}
