//! Tool centre point control: G43.4, TRAORI, M codes of the machine. X, Y and Z then say where the tip is.

use diagnostic::{both, refusal};
use nc_dialect::{Action, TipSwitch};
use nc_syntax::{Letters, Span};
use toolpath::Kinematics;

use crate::codes;
use crate::environment::{Demand, Environment};
use crate::modal::{Axis, Compensation, Lost, Modal, Why};
use crate::refusals::tip as refusal;
use crate::words::{Outcome, Words};

/// What the codes of a block, whose tool length is in `state` already, say of the kinematics in force from here on.
fn wanted(env: &Environment<'_>, words: &Words<'_, '_, '_>, before: &Modal) -> Option<(Kinematics, Span)> {
    let of = |switch: TipSwitch| match switch {
        TipSwitch::On => Kinematics::Tip,
        TipSwitch::Off => Kinematics::Axes,
    };
    let by_code = words.codes.iter().find_map(|code| match code.entry.action {
        Action::TipLengthOn | Action::TipLengthOnVectors => Some((Kinematics::Tip, code.span)),
        Action::Tip(switch) => Some((of(switch), code.span)),
        // A code of its group ends G43.4.
        _ if before.kinematics == Kinematics::Tip && code.entry.group != 0 => {
            let replaces = |row: &nc_dialect::CodeEntry| {
                row.action == Action::TipLengthOn && row.group == code.entry.group
            };
            env.dialect.codes.iter().any(replaces).then_some((Kinematics::Axes, code.span))
        }
        _ => None,
    });
    let by_command = || {
        words.commands.iter().find_map(|(action, span)| match action {
            Action::Tip(switch) => Some((of(*switch), *span)),
            _ => None,
        })
    };
    let by_machine = || {
        words.m_codes.iter().find_map(|(number, span)| Some((of(env.dialect.m_code(*number)?.tip?), *span)))
    };
    by_code.or_else(by_command).or_else(by_machine)
}

/// Switches the kinematics where the block says so.
///
/// The axes stand meanwhile. With all rotary axes at 0 tip commands are axis commands; elsewhere nobody but the control
/// knows where the tip is in the coordinates that hold from here on.
pub(crate) fn switch(
    env: &Environment<'_>,
    words: &Words<'_, '_, '_>,
    before: &Modal,
    state: &mut Modal,
) -> Outcome<()> {
    let Some((kinematics, span)) = wanted(env, words, before) else { return Ok(()) };
    state.vectors = kinematics == Kinematics::Tip
        && words.codes.iter().any(|code| code.entry.action == Action::TipLengthOnVectors);
    let unknown = env.setup.tip_control.unknown(
        &both!("no path under it", "при нём"),
        &both!("tool centre point control", "управления по вершине инструмента"),
    );
    if let (Kinematics::Tip, Some((label, help))) = (kinematics, unknown) {
        return Err(words.refuse(refusal!(codes::TIP_CONTROL;
            "{} is refused: it moves the axes so that the tool's tip follows the path (tool centre point)",
            "{} не принимается: она ведёт оси так, чтобы по пути шла вершина инструмента", words.text(span);
            label; help
        ), span));
    }
    if kinematics == before.kinematics {
        return Ok(());
    }
    if let Kinematics::Plane(_) = before.kinematics {
        if kinematics == Kinematics::Axes {
            // What is not on cannot be switched off.
            return Ok(());
        }
        return Err(words.refuse_code(refusal::INSIDE_TILTED_PLANE, span));
    }
    state.kinematics = kinematics;
    if state.axes.rotary.iter().any(|axis| *axis != Axis::At(0.0)) {
        let lost = Lost { why: Why::Kinematics, line: words.block.line };
        state.axes.linear = [Axis::Unknown(lost); 3];
    }
    Ok(())
}

/// Whether a reference return, a probe move or G53 moves the axes or the tip, controls differ: behind it nobody knows where
/// the tip is.
pub(crate) fn lose(words: &Words<'_, '_, '_>, state: &mut Modal, why: Why) {
    if state.kinematics == Kinematics::Tip {
        state.axes.linear = [Axis::Unknown(Lost { why, line: words.block.line }); 3];
    }
}

/// What does not go together with tool centre point control, on controls or in what is certain of them.
pub(crate) fn check(
    words: &Words<'_, '_, '_>,
    demand: &Demand<'_>,
    before: &Modal,
    state: &Modal,
) -> Outcome<()> {
    if [before, state].iter().all(|state| state.kinematics != Kinematics::Tip) {
        return Ok(());
    }
    let span = || {
        demand.owner_span.unwrap_or_else(|| {
            words.codes.first().map_or_else(|| words.span(Letters::NONE), |code| code.span)
        })
    };
    let (message, help) = if state.compensation != Compensation::Off {
        (
            both!(
                "cutter compensation under tool centre point control",
                "коррекция на радиус при управлении по вершине инструмента"
            ),
            both!(
                "correct the radius in the CAM: in which plane it is corrected while the tool turns, controls differ",
                "учтите радиус в CAM: в какой плоскости его учитывают, пока инструмент поворачивается, у стоек по-разному"
            ),
        )
    } else if !state.transform.is_none() {
        (
            both!(
                "a rotation, scaling or mirror under tool centre point control",
                "поворот, масштабирование или зеркальное отображение при управлении по вершине инструмента"
            ),
            both!(
                "cancel it before, or let the CAM write the points",
                "отмените его раньше или выводите точки из CAM"
            ),
        )
    } else if state.cycle.is_some() {
        (
            both!(
                "a drilling cycle under tool centre point control",
                "цикл сверления при управлении по вершине инструмента"
            ),
            both!(
                "switch it off for the cycle: along which axis it drills, controls differ",
                "отключите управление на время цикла: вдоль какой оси сверлить, у стоек по-разному"
            ),
        )
    } else {
        return Ok(());
    };
    Err(words.refuse(
        refusal!(codes::TIP_CONTROL; message;
            "X, Y and Z say where the tip is here", "X, Y и Z здесь — положение вершины";
            help
        ),
        span(),
    ))
}
