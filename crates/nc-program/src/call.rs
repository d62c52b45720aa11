//! What only the control has: programs and functions that are left alone, and what is unknown behind them.

use diagnostic::{Diagnostic, refusal};
use nc_dialect::Action;
use nc_syntax::Span;
use smallvec::smallvec;
use toolpath::{Motion, Mover};

use crate::codes;
use crate::environment::Environment;
use crate::modal::{Axis, Lost, Modal, MotionMode, Naming, Why};
use crate::moved::Moved;
use crate::words::{Outcome, Words};

/// G65 P9810, M98 P9000 and functions that the profile names under `[calls]`: the control does them. What they may move
/// stands anywhere afterwards, and has to be named anew; which motion code they leave is nobody's knowledge.
pub(crate) fn left_alone(
    env: &Environment<'_>,
    words: &Words<'_, '_, '_>,
    state: &mut Modal,
    moved: &mut Moved,
) -> Outcome<()> {
    let by_g = words.codes.iter().filter(|row| row.entry.action == Action::Call);
    let by_g = by_g.map(|row| (b'G', row.entry.code.0, row.span));
    let calls = |code: u16| env.dialect.m_code(code).is_some_and(|row| row.calls);
    let by_m = words.m_codes.iter().filter(|(code, _)| calls(*code));
    let Some((letter, tenths, span)) =
        by_g.chain(by_m.map(|(code, span)| (b'M', code.saturating_mul(10), *span))).next()
    else {
        return Ok(());
    };
    let program = words.whole(b'P')?;
    let unknown = env.dialect.control_call(letter, tenths, program).map_or([true; 6], |call| call.unknown);
    if !unknown.contains(&true) {
        return Ok(());
    }
    if !moved.motions.is_empty() {
        return Err(moves_itself(words, span));
    }
    let lost = Lost { why: Why::Call, line: words.block.line };
    for i in (0..3).filter(|i| unknown[*i] && env.moves_axis(*i)) {
        state.axes.linear[i] = Axis::Unknown(lost);
        state.named[i] = Naming::Since(lost);
    }
    for i in (0..3).filter(|i| unknown[3 + i] && env.setup.has_rotary[*i] && env.setup.rotary_matters) {
        state.axes.rotary[i] = Axis::Unknown(lost);
    }
    (state.motion, state.cycle) = (MotionMode::None, None);
    moved.motions = smallvec![Motion::Uncorrected { end: state.axes.partial(), by: Mover::Other }];
    Ok(())
}

/// A function that moves axes in a block that moves them too.
pub(crate) fn moves_itself(words: &Words<'_, '_, '_>, span: Span) -> Box<Diagnostic> {
    words.refuse(
        refusal!(codes::COMBINATION;
            "{} moves the axes itself, in a block that moves them too",
            "{} сама двигает оси, и кадр двигает их тоже", words.text(span);
            "before or after the motion? controls differ", "до движения или после? у стоек по-разному";
            "write it in a block of its own", "напишите её отдельным кадром"
        ),
        span,
    )
}
