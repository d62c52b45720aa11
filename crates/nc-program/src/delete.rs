//! Block delete: one text, two states.
//!
//! The switch on the panel decides whether blocks with `/` are executed. Blocks of one switch that follow each other
//! are one section: executed all or skipped all. Nobody throws the switch between two of them, or the posted
//! program would go wrong by more than a correction; and no posted section could be read otherwise, for its second
//! block goes on from where the first one led. Behind the section both states must be right: what differs is forgotten
//! where forgetting is enough (a later block that needs it is refused, one that names all axes makes both states
//! equal again), and refused where it is not.

use diagnostic::{Text, both};
use nc_dialect::Side;
use toolpath::Kinematics;

use crate::modal::{
    ArcCentres, Aside, Axis, Compensation, Distance, FeedMode, Lost, Modal, MotionMode, Naming, Progress,
    ReturnLevel, Stated, ToolLength, Units, Why, XWords,
};
use crate::refusals::delete as refusal;
use crate::words::{Outcome, Words};

/// The state behind blocks that may be skipped.
///
/// * `words` – the block that ends the section, for messages
/// * `aside` – the state where they are skipped. Where one of them moves, all axes are forgotten: even where both
///   states agree on the programmed position, the corrected one of an axis that no block named may differ
/// * `executed` – the state where they are executed
pub(crate) fn merge(words: &Words<'_, '_, '_>, aside: &Aside, executed: &Modal) -> Outcome<Modal> {
    let Aside { line, skipped, .. } = aside;
    let line = *line;
    let mut both = skipped.clone();
    if executed.motion != skipped.motion {
        both.motion = MotionMode::Undecided { line };
    }
    if executed.return_level != skipped.return_level {
        both.return_level = ReturnLevel::Undecided { line };
    }
    if executed.tool_selected != skipped.tool_selected {
        both.tool_selected = None;
    }
    if executed.tool_loaded != skipped.tool_loaded {
        both.tool_loaded = None;
    }
    let lost = Axis::Unknown(Lost { why: Why::BlockDelete, line });
    for i in (0..3).filter(|i| *i != 1 || !words.turns()) {
        if aside.moved || executed.axes.linear[i] != skipped.axes.linear[i] {
            both.axes.linear[i] = lost;
        }
        if executed.axes.rotary[i] != skipped.axes.rotary[i] {
            both.axes.rotary[i] = lost;
        }
    }
    for i in 0..3 {
        if executed.named[i] != skipped.named[i] || aside.moved {
            both.named[i] = Naming::Since(Lost { why: Why::BlockDelete, line });
        }
    }
    both.stated = Stated {
        work_offset: executed.stated.work_offset && skipped.stated.work_offset,
        tool_length: executed.stated.tool_length && skipped.stated.tool_length,
        units: executed.stated.units && skipped.stated.units,
    };
    both.speed_limited = executed.speed_limited && skipped.speed_limited;
    both.edge_unsaid = executed.edge_unsaid || skipped.edge_unsaid;
    both.last_feed = executed.last_feed.either(skipped.last_feed);
    both.path_control = executed.path_control.either(skipped.path_control);
    both.feed = executed.feed.filter(|feed| skipped.feed == Some(*feed));
    if executed.curve_leaves_mm != skipped.curve_leaves_mm {
        both.curve_leaves_mm = None;
    }
    both.offset = executed.offset.either(skipped.offset, executed.compensation != Compensation::Off);
    both.unsettled = [0, 1, 2].map(|i| executed.unsettled[i] || skipped.unsettled[i]);
    // `/M30` ends the program or not: what follows is executed or not, and must be right where it is.
    both.progress = Progress::Running;
    match difference(skipped, executed) {
        None => Ok(both),
        Some((with, without)) => {
            let span = words.codes.first().map_or_else(|| words.span(words.letters), |code| code.span);
            Err(words.refuse(refusal::either_is_in_force(line, &with, &without), span))
        }
    }
}

/// What is in force after execution and after skipping, where the two cannot be served by one text.
fn difference(skipped: &Modal, executed: &Modal) -> Option<(Text, Text)> {
    fn pair<T: PartialEq>(with: &T, without: &T, name: impl Fn(&T) -> Text) -> Option<(Text, Text)> {
        (with != without).then(|| (name(with), name(without)))
    }
    let (with, without) = (executed, skipped);
    pair(&with.distance, &without.distance, |v| match v {
        Distance::Absolute => Text::same("G90"),
        Distance::Incremental => Text::same("G91"),
    })
    .or_else(|| {
        pair(&with.units, &without.units, |v| match v {
            Units::Inch => both!("inch", "дюймы"),
            Units::Millimetre => both!("millimetre", "миллиметры"),
        })
    })
    .or_else(|| {
        pair(&with.x_words, &without.x_words, |v| match v {
            XWords::Diameter => both!("X as Diameter", "X — диаметр"),
            XWords::DiameterOfAbsolute => both!("X as DiameterOfAbsolute", "X — диаметр при G90"),
            XWords::Radius => both!("X as a radius", "X — радиус"),
            XWords::Unstated => both!("X as nobody said", "что такое X, не сказано"),
        })
    })
    .or_else(|| pair(&with.plane, &without.plane, |v| both!("plane {v:?}", "плоскость {v:?}")))
    .or_else(|| {
        pair(&with.feed_mode, &without.feed_mode, |v| match v {
            FeedMode::InverseTime => Text::same("G93"),
            FeedMode::PerMinute => Text::same("G94"),
            FeedMode::PerRevolution => Text::same("G95"),
        })
    })
    .or_else(|| {
        pair(&with.arc_centres, &without.arc_centres, |v| match v {
            ArcCentres::Incremental => both!("arc centres incremental", "центры дуг в приращениях"),
            ArcCentres::Absolute => both!("arc centres absolute", "центры дуг абсолютные"),
        })
    })
    .or_else(|| {
        pair(&with.compensation, &without.compensation, |v| match v {
            Compensation::Off => both!("no cutter compensation", "коррекция на радиус выключена"),
            Compensation::On(Side::Left) => {
                both!("cutter compensation to the left", "коррекция на радиус слева")
            }
            Compensation::On(Side::Right) => {
                both!("cutter compensation to the right", "коррекция на радиус справа")
            }
        })
    })
    .or_else(|| {
        pair(&with.tool_length, &without.tool_length, |v| match v {
            ToolLength::Off => both!("no tool length", "коррекция на длину выключена"),
            ToolLength::On { number, .. } => both!("tool length H{number}", "коррекция на длину H{number}"),
            ToolLength::Written { .. } => {
                both!("the tool length of this block", "коррекция на длину этого кадра")
            }
        })
    })
    .or_else(|| {
        pair(&with.kinematics, &without.kinematics, |v| match v {
            Kinematics::Axes => both!(
                "neither tool centre point control nor a tilted plane",
                "ни управления по вершине инструмента, ни наклонной плоскости"
            ),
            Kinematics::Tip => both!("tool centre point control", "управление по вершине инструмента"),
            Kinematics::Plane(_) => both!("a tilted plane", "наклонная плоскость"),
        })
    })
    .or_else(|| {
        pair(&with.vectors, &without.vectors, |v| {
            if *v {
                both!("directions by I, J, K", "направления словами I, J, K")
            } else {
                both!("no directions by I, J, K", "направления не словами I, J, K")
            }
        })
    })
    .or_else(|| {
        pair(&with.plane_begun, &without.plane_begun, |v| {
            if v.is_some() {
                both!("the beginning of a tilted plane", "начало наклонной плоскости")
            } else {
                both!("none of it", "без неё")
            }
        })
    })
    .or_else(|| {
        pair(&with.curve, &without.curve, |v| {
            if v.is_some() {
                both!("the beginning of a curve", "начало кривой")
            } else {
                both!("none of it", "без неё")
            }
        })
    })
    .or_else(|| pair(&with.transform, &without.transform, |v| v.name()))
    .or_else(|| pair(&with.shifts, &without.shifts, |v| both!("shift {:?} mm", "сдвиг {:?} мм", v.preset_mm)))
    .or_else(|| {
        pair(&with.written, &without.written, |v| {
            both!("{} work offset(s) of the program", "смещений нуля, записанных программой: {}", v.len())
        })
    })
    .or_else(|| {
        pair(&with.written_lengths, &without.written_lengths, |v| {
            both!("{} tool length(s) of the program", "длин инструмента, записанных программой: {}", v.len())
        })
    })
    .or_else(|| {
        pair(&with.work_offset, &without.work_offset, |v| {
            v.code.map_or_else(
                || both!("no work offset", "смещение нуля не выбрано"),
                |code| Text::same(code.to_string()),
            )
        })
    })
    .or_else(|| {
        pair(&with.cycle, &without.cycle, |v| {
            v.map_or_else(
                || both!("no cycle", "цикл не действует"),
                |cycle| both!("{} with its words", "{} со своими словами", cycle.code),
            )
        })
    })
}
