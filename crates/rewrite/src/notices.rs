//! What is said of a program: warnings that are told once, and why a motion cannot be corrected.

use std::ops::Range;

use correction::CorrectionError;
use diagnostic::{Code, Diagnostic, Severity, Speaks, Text, both};
use machine_model::SolveError;
use nc_program::Context;
use nc_syntax::Block;
use toolpath::{AXIS_NAMES, Motion};

use crate::figures::Held;
use crate::job::{
    ACCEPTED, COMPENSATED, DIRECTION, DIRECTION_HELD, DIRECTION_IN_PLANE, LEANING_CYCLE, LEANS,
    MUST_NOT_SPLIT, NO_BOUNDS_FOR_TURNS, NOT_CONVERGED, NOT_WITHIN_TOLERANCE, OTHER_TOOL, OUTSIDE,
    RAPID_OUTSIDE, SIDEWAYS, SPIRAL, TOO_MANY_PECKS, TOUCHED_BY_GUESS, TOUCHED_OUTSIDE, UNKNOWN_SIDE,
    UNNAMED, Warning,
};

/// Things that happen more than once and are told once.
#[derive(Debug, Clone, Default)]
pub(crate) struct Notices {
    pub(crate) clamped: Notice,
    pub(crate) leaning: Notice,
    pub(crate) compensated: Notice,
    pub(crate) beside: Notice,
    pub(crate) unknown_side: Notice,
    pub(crate) spirals: Notice,
    pub(crate) held: Notice,
    pub(crate) touched_outside: Notice,
    pub(crate) touched_by_guess: Notice,
    pub(crate) accepted: Notice,
}

/// One kind of them.
#[derive(Debug, Clone, Default)]
pub(crate) struct Notice {
    count: u64,
    /// Where it happened first, and that line.
    first: Option<(Range<u64>, u64)>,
    largest_mm: f64,
    /// Where that was.
    at_largest: Option<(Range<u64>, u64)>,
}

impl Notice {
    pub(crate) fn see(&mut self, span: &Range<u64>, line: u64, size_mm: f64) {
        self.count += 1;
        self.first.get_or_insert_with(|| (span.clone(), line));
        if self.at_largest.is_none() || size_mm > self.largest_mm {
            self.largest_mm = size_mm;
            self.at_largest = Some((span.clone(), line));
        }
    }

    fn add(&mut self, later: &Self) {
        self.count += later.count;
        if self.first.is_none() {
            self.first.clone_from(&later.first);
        }
        if self.at_largest.is_none() || later.largest_mm > self.largest_mm {
            self.largest_mm = later.largest_mm;
            self.at_largest.clone_from(&later.at_largest);
        }
    }

    /// The same, told where it was largest.
    fn at_its_largest(&self) -> Self {
        Self { first: self.at_largest.clone(), ..self.clone() }
    }

    /// What is to be said where it happened; the message is made of how often, and of the largest, um.
    fn warning(
        &self,
        code: Code,
        message: impl FnOnce(u64, f64) -> Text,
        label: Text,
        help: Text,
    ) -> Option<Warning> {
        let (first, line) = self.first.clone()?;
        let message = message(self.count, self.largest_mm * 1e3);
        Some((Diagnostic::warning(code, message).at(first, label).help(help), line))
    }
}

impl Notices {
    pub(crate) fn add(&mut self, later: &Self) {
        self.clamped.add(&later.clamped);
        self.leaning.add(&later.leaning);
        self.compensated.add(&later.compensated);
        self.beside.add(&later.beside);
        self.unknown_side.add(&later.unknown_side);
        self.spirals.add(&later.spirals);
        self.held.add(&later.held);
        self.touched_outside.add(&later.touched_outside);
        self.touched_by_guess.add(&later.touched_by_guess);
        self.accepted.add(&later.accepted);
    }

    pub(crate) fn warnings(&self, held: &Held) -> Vec<Warning> {
        let clamped = self.clamped.warning(
            RAPID_OUTSIDE,
            |count, _| {
                both!(
                    "{count} rapid motion(s) end outside the calibrated volume",
                    "быстрые ходы кончаются вне калиброванного объёма: {count}"
                )
            },
            both!(
                "the first; it takes the correction of the volume's nearest point",
                "первый; для него взята поправка ближайшей точки объёма"
            ),
            both!(
                "nothing is cut there; calibrate a larger volume if the place matters",
                "резания там нет; если место важно, калибруйте больший объём"
            ),
        );
        let leaning = self.leaning.warning(
            LEANING_CYCLE,
            |count, um| both!("{count} hole(s) are off by up to {um:.1} um along their depth", "отверстия смещены по глубине не больше чем на {um:.1} мкм: {count}"),
            both!("this cycle is bound to the spindle and cannot be written as moves; its middle was put in place", "этот цикл связан со шпинделем и движениями не записывается; на место поставлена его середина"),
            both!("the machine's drilling axis leans; thread by milling where that matters", "ось сверления станка наклонена; где это важно, фрезеруйте резьбу"),
        );
        let compensated = self.compensated.warning(
            COMPENSATED,
            |count, _| both!("{count} motion(s) under cutter compensation", "движения при коррекции на радиус: {count}"),
            both!("the programmed contour was corrected, not the path of the tool's centre", "исправлен запрограммированный контур, а не путь центра инструмента"),
            both!("between the two lies the tool radius times the error's change per mm (1 um per mm of radius at 1 mrad); post with compensation computed in CAM where that matters, or give the profile the cutter's radius (`radii_mm`), a turning tool's nose", "между ними — радиус инструмента, умноженный на изменение погрешности на миллиметр (1 мкм на мм радиуса при 1 мрад); где это важно, считайте коррекцию в CAM или задайте в профиле радиус фрезы (`radii_mm`), токарному резцу — радиус при вершине"),
        );
        let beside = self.beside.at_its_largest().warning(
            COMPENSATED,
            |count, um| both!("{count} motion(s) under cutter compensation, the tool's centre off by up to {um:.2} um more", "движения при коррекции на радиус: {count}, центр инструмента отклоняется ещё до {um:.2} мкм"),
            both!("the largest; the contour was corrected, and the machine's error is another one radius beside it", "наибольшее; исправлен контур, а на радиус в стороне погрешность станка другая"),
            both!("post with compensation computed in CAM where that matters", "где это важно, считайте коррекцию в CAM"),
        );
        let unknown_side = self.unknown_side.warning(
            UNKNOWN_SIDE,
            |count, um| both!("{count} motion(s) with an axis on an unknown side of its play, off by up to {um:.1} um", "движения, где неизвестно, с какой стороны люфта стоит ось, отклонение до {um:.1} мкм: {count}"),
            both!("the first; the middle of the play was taken, since nothing before tells from where the axis came", "первое; взята середина люфта: по предыдущим кадрам не узнать, откуда пришла ось"),
            both!("say with `--start-at X,Y,Z` where the axes stand at the start; behind a reference return, a tool change (M6) or `/`, feed the axis to its place from one side first", "скажите ключом `--start-at X,Y,Z`, где стоят оси в начале; после выхода в исходное положение, смены инструмента (M6) или `/` сначала подведите ось рабочим ходом с одной стороны"),
        );
        let spirals = self.spirals.at_its_largest().warning(
            SPIRAL,
            |count, um| both!("{count} arc(s) end off their circle, the largest by {:.3} mm", "дуги кончаются не на своей окружности, наибольшее отклонение {:.3} мм: {count}", um * 1e-3),
            both!("the largest; the control cuts a spiral from the one radius to the other, and that is the path", "наибольшее; стойка ведёт по спирали от одного радиуса к другому: это и есть путь"),
            both!("post with more decimals where that matters", "где это важно, выводите с большим числом знаков"),
        );
        let lines = held.names();
        let directions = self.held.warning(
            DIRECTION_HELD,
            |count, _| both!("the tool's direction is not corrected in {count} motion(s), lines {lines}: it leans by up to {:.1} urad (line {})", "направление инструмента не исправлено, движений: {count}, строки {lines}; наклон до {:.1} мкрад (строка {})", held.largest.0 * 1e6, held.largest.1),
            both!("the first; near a singularity a rotary axis would have to turn far for little, or its travel ends: the tip alone is corrected there", "первое; у особого положения поворотной оси пришлось бы повернуться далеко ради малого, или кончается её ход: здесь исправлена только вершина"),
            both!("tilt the workpiece in the CAM so that the tool passes further from the axis that turns about it, or take `singular_sin`, `singular_turn_deg`, `singular_share` under [correction] for what the machine bears", "наклоните деталь в CAM, чтобы инструмент проходил дальше от оси, вращающей вокруг него, или задайте `singular_sin`, `singular_turn_deg`, `singular_share` в разделе [correction] по возможностям станка"),
        );
        [clamped, leaning, compensated, beside, unknown_side, spirals, directions]
            .into_iter()
            .chain(self.of_zeros())
            .chain([self.beyond()])
            .flatten()
            .collect()
    }

    /// What was written although the tolerance cannot be held.
    fn beyond(&self) -> Option<Warning> {
        let (warning, line) = self.accepted.at_its_largest().warning(
            ACCEPTED,
            |count, um| {
                both!(
                    "{count} motion(s) leave their path by up to {um:.2} um, more than the tolerance",
                    "движения отходят от траектории до {um:.2} мкм, больше допуска: {count}"
                )
            },
            both!(
                "the largest; no words of this program hold it nearer",
                "наибольшее; никакие слова этой программы не удержат его ближе"
            ),
            both!(
                "`--accept UM` says what may be written so, `--accept 0` refuses it and says why",
                "`--accept МКМ` задаёт, до какой величины так писать; `--accept 0` откажет и скажет почему"
            ),
        )?;
        Some((Diagnostic { severity: Severity::Doubt, ..warning }, line))
    }

    /// What is not known of touched zeros.
    fn of_zeros(&self) -> [Option<Warning>; 2] {
        let outside = self.touched_outside.warning(
            TOUCHED_OUTSIDE,
            |_, um| {
                both!(
                    "a zero is taken as touched outside the calibrated volume, with the error of {um:.1} um of its nearest point",
                    "нуль считается найденным касанием вне калиброванного объёма, с погрешностью {um:.1} мкм в ближайшей точке"
                )
            },
            both!("the first cut from that zero", "первое резание от этого нуля"),
            both!(
                "say where it was touched (`touched_at` in the profile, `--touched-at G54=X,Y,Z`), or that it is true (`--zero true`)",
                "скажите, где его касались (`touched_at` в профиле, `--touched-at G54=X,Y,Z`), или что он точный (`--zero true`)"
            ),
        );
        let by_guess = self.touched_by_guess.at_its_largest().warning(
            TOUCHED_BY_GUESS,
            |_, um| {
                both!(
                    "a zero is taken as touched without a tool length; touched by the tool in force it would lie up to {um:.1} um elsewhere",
                    "нуль считается найденным касанием без длины инструмента; если касались этим инструментом, он лежит до {um:.1} мкм в стороне"
                )
            },
            both!(
                "cut from that zero with this tool; all of the part moves by as much, and nothing within it",
                "резание от этого нуля этим инструментом; на столько сдвинута вся деталь, внутри неё ничего"
            ),
            both!(
                "say which tool touched it, `touched_at = {{ tool = \"H1\" }}` or a length in mm, or that it is true (`--zero true`)",
                "скажите, чем касались: `touched_at = {{ tool = \"H1\" }}` или длина в мм; или что нуль точный (`--zero true`)"
            ),
        );
        [by_guess, outside]
    }
}

/// A corrected hole under block delete: what it says would hold for the next holes only where it is executed.
pub(crate) fn hole_skipped(block: &Block<'_>) -> Diagnostic {
    let whole = block.file_range();
    Diagnostic::error(nc_program::codes::BLOCK_DELETE, both!("a hole that may be skipped has levels of its own after correction", "у отверстия, которое могут пропустить, после исправления свои уровни"))
        .at(whole, both!("its Z and R differ from those of the holes before, and the next holes would inherit them only where it is executed", "его Z и R не те, что у прежних отверстий, а следующие унаследовали бы их, только если оно исполнено"))
        .help(both!("delete the `/`, or post a program without this hole", "удалите `/` или выведите программу без этого отверстия"))
}

/// The word that says where an axis stands before a motion, as `X12.5`.
fn stands_at(axis: usize, motion: &Motion, context: &Context) -> String {
    let start_mm = match motion {
        Motion::Feed(feed) => feed.start.linear_mm,
        Motion::Hole(hole) => hole.start.linear_mm,
        Motion::Rapid { start, .. } | Motion::Uncorrected { end: start, .. } => {
            start.linear_mm.map(Option::unwrap_or_default)
        }
    };
    let place = context.frame.to_program(start_mm)[axis] / context.word_mm(axis);
    let number = format!("{place:.4}");
    let number = number.trim_end_matches('0');
    format!("{}{}", AXIS_NAMES[axis], if number == "-0." { "0." } else { number })
}

/// What to say of a motion with a tool that a field knows nothing of.
pub(crate) fn other_tool(error: &SolveError, whole: std::ops::Range<u64>) -> Diagnostic {
    Diagnostic::error(OTHER_TOOL, error.text())
        .at(whole, both!("moved with this tool", "движение с этим инструментом"))
        .help(both!(
            "measure a field with this tool's length, or use `--engine rigid-body` with tables of angles; before G43 the tool vector is default_mm of the profile",
            "измерьте поле с длиной этого инструмента или примените `--engine rigid-body` с таблицами углов; до G43 вектор инструмента — default_mm профиля"
        ))
}

/// Axis command of the program's zero, mm, where it lies farther beside the volume than that is long: a part is not so
/// far from its zero, but the zeros of another machine or unit are.
fn far_zero(axis: char, [low_mm, high_mm]: [f64; 2], context: &Context) -> Option<f64> {
    let axis = AXIS_NAMES.iter().position(|name| *name == axis)?;
    let zero_mm = context.frame.to_machine([0.0; 3])[axis];
    let span_mm = high_mm - low_mm;
    (zero_mm < low_mm - span_mm || zero_mm > high_mm + span_mm).then_some(zero_mm)
}

/// A motion, its block, and what is in force there.
type At<'a> = (&'a Motion, &'a Block<'a>, &'a Context);

/// What to say of a motion that leaves the volume.
fn outside_volume(
    axis: char,
    value_mm: f64,
    [low_mm, high_mm]: [f64; 2],
    (motion, block, context): At<'_>,
) -> Diagnostic {
    let span = block.word(axis as u8).map_or_else(|| block.file_range(), |word| block.file_span(word.span));
    let what = if matches!(motion, Motion::Hole(_)) {
        both!("this hole", "это отверстие")
    } else {
        both!("this feed motion", "этот рабочий ход")
    };
    Diagnostic::error(OUTSIDE, both!("{what} leaves the calibrated volume", "{what:#} выходит из калиброванного объёма"))
                .at(span, both!("axis {axis} would be commanded to {value_mm:.3} mm, calibrated is {low_mm} to {high_mm} mm", "ось {axis} пришлось бы вывести в {value_mm:.3} мм, а калибровано от {low_mm} до {high_mm} мм"))
                .help(match far_zero(axis, [low_mm, high_mm], context) {
                    Some(zero_mm) => both!(
                        "the program's zero is at {axis} {zero_mm:.3} mm: is the work offset (profile, `--work-offset` or `--linuxcnc-ini`) of this machine, and in millimetres?",
                        "нуль программы в {axis} {zero_mm:.3} мм: смещение нуля (профиль, `--work-offset` или `--linuxcnc-ini`) от этого станка и в миллиметрах?"
                    ),
                    None => both!("place the workpiece inside the volume: `--work-offset` with {axis} moved by {:+.3} mm or further, or accept the nearest point's correction with `--outside clamp`", "поместите деталь в объём: `--work-offset`, где {axis} сдвинута на {:+.3} мм или дальше; или примите поправку ближайшей точки: `--outside clamp`",
                        if value_mm < low_mm { low_mm - value_mm } else { high_mm - value_mm }
                    ),
                })
}

/// What to say of an axis that needs a word and has none.
fn unnamed(axis: usize, distance_um: f64, said: Text, (motion, block, context): At<'_>) -> Diagnostic {
    let (name, um) = (AXIS_NAMES[axis], distance_um.ceil());
    let since = context.unnamed[axis].map_or(Text::EMPTY, |lost| both!(" since {}", " {:#}", lost.since()));
    let all = (0..3).filter(|i| context.unnamed[*i].is_some() || *i == axis);
    let words: Vec<String> = all.map(|i| stands_at(i, motion, context)).collect();
    Diagnostic::error(UNNAMED, said)
                .at(
                    block.file_range(),
                    both!("{name} is not named{since}; a word for it would rest on a guess of where its zero is", "{name} не названа{since:#}; её слово опиралось бы на догадку, где её нуль"),
                )
                .help(if context.unnamed[axis].is_some_and(|lost| lost.line == block.line) {
                    both!("write what changes {name} in a block of its own, and behind it a rapid that names {name}", "напишите то, что меняет {name}, отдельным кадром, а за ним быстрый ход, в котором названа {name}")
                } else {
                    let words = words.join(" ");
                    both!("before this block say once where the tool is to be, as in `G90 G0 {words}`; or accept it so with `--accept {um}`", "скажите один раз перед этим кадром, где быть инструменту, например `G90 G0 {words}`; или примите такое отклонение: `--accept {um}`")
                })
}

/// What to say of a motion that cannot be corrected.
pub(crate) fn refusal(
    error: &CorrectionError,
    motion: &Motion,
    block: &Block<'_>,
    context: &Context,
) -> Vec<Diagnostic> {
    let whole = block.file_range();
    let word = |letter: u8| block.word(letter).map(|word| block.file_span(word.span));
    let diagnostic = match error {
        CorrectionError::Solve(SolveError::OutsideVolume { axis, value_mm, low_mm, high_mm }) => {
            outside_volume(*axis, *value_mm, [*low_mm, *high_mm], (motion, block, context))
        }
        CorrectionError::Solve(error @ SolveError::OutsideVectors { .. }) => {
            Diagnostic::error(OUTSIDE, error.text())
                .at(whole, both!("no vector was measured near enough", "достаточно близко нет измеренных векторов"))
                .help(both!(
                    "place the workpiece where vectors were measured with `--work-offset`, measure there, or accept the nearest place's correction with `--outside clamp`",
                    "поместите деталь туда, где векторы измерены (`--work-offset`), измерьте там или примите поправку ближайшей точки: `--outside clamp`"
                ))
        }
        CorrectionError::Solve(error @ SolveError::OtherTool { .. }) => other_tool(error, whole),
        CorrectionError::Solve(error @ SolveError::NotConverged { .. }) => {
            Diagnostic::error(NOT_CONVERGED, error.text())
                .at(whole, both!("here", "здесь"))
                .help(both!("an error table with steps this steep is no machine: run `vpost profile check`", "таблицы погрешностей с такими крутыми ступенями у станка не бывает: запустите `vpost profile check`"))
        }
        CorrectionError::Solve(error @ SolveError::OutsideRotaryRange { axis, .. }) => {
            Diagnostic::error(OUTSIDE, error.text())
                .at(word(*axis as u8).unwrap_or(whole), both!("beyond `travel_deg`, or its tables", "за пределами `travel_deg` или таблиц"))
                .help(both!("turn {axis} back by whole turns before it, or write the angle within its travel; where the machine goes farther, say so as `travel_deg` of {axis} in the profile", "поверните {axis} до этого назад на полные обороты или напишите угол в пределах хода; если станок ходит дальше, скажите об этом ключом `travel_deg` оси {axis} в профиле"))
        }
        CorrectionError::Solve(error) => Diagnostic::error(NOT_CONVERGED, error.text())
            .at(whole, both!("here", "здесь"))
            .help(both!("choose another engine with `--engine`", "выберите другой метод ключом `--engine`")),
        CorrectionError::MustNotSplit { .. } if context.thread => {
            Diagnostic::error(MUST_NOT_SPLIT, error.text())
                .at(whole, both!("a thread must stay one block: it is cut in step with the spindle", "резьба остаётся одним кадром: её нарезают согласованно со шпинделем"))
                .help(both!("accept that much with `--accept`, or cut the thread uncorrected in a program of its own", "примите такое отклонение ключом `--accept` или нарезайте резьбу без исправления, отдельной программой"))
        }
        CorrectionError::MustNotSplit { .. } => Diagnostic::error(MUST_NOT_SPLIT, error.text())
            .at(whole, both!("this block must stay one, with none before it: cutter compensation is active", "кадр остаётся одним, и перед ним ничего не вставить: действует коррекция на радиус"))
            .help(both!("give the profile the radius of a mill's cutter (`radii_mm` under `[tool]`), for pieces that the control offsets alike; or post with compensation computed in CAM, or accept more with `--accept`; where an axis with play turns at the start-up, come to it from the side to which it goes on", "задайте в профиле радиус фрезы (`radii_mm` в разделе `[tool]`), чтобы делить кадры, не меняя смещения; или считайте коррекцию в CAM, или допустите больше ключом `--accept`; если при включении коррекции меняет направление ось с люфтом, подходите с той стороны, в которую она пойдёт дальше")),
        CorrectionError::TooManyPecks { .. } => Diagnostic::error(TOO_MANY_PECKS, error.text())
            .at(word(b'Q').unwrap_or(whole), both!("far below what a drill bites", "столько сверло не снимает"))
            .help(both!("correct Q: it is the depth of one peck", "исправьте Q: это глубина одного прохода")),
        CorrectionError::Unnamed { axis, distance_um } => unnamed(*axis, *distance_um, error.text(), (motion, block, context)),
        CorrectionError::TurnedFrame { .. } => Diagnostic::error(nc_program::codes::FRAME, error.text())
            .at(whole, both!("each word moves several axes here, so that none of them can be held where it stands", "здесь каждое слово двигает несколько осей, и ни одну не удержать на месте"))
            .help(both!("let the CAM write the rotated coordinates, or accept more with `--tolerance`", "выводите из CAM повёрнутые координаты или допустите больше ключом `--tolerance`")),
        CorrectionError::Sideways { distance_um, .. } => Diagnostic::error(SIDEWAYS, error.text())
            .at(whole, both!("before this motion an axis turns", "перед этим движением ось меняет направление"))
            .help(both!("no command undoes what changes at once: accept it with `--tolerance {:.1}` or more, or let the axis turn in a rapid above the part", "скачок не убрать никакой командой: примите его ключом `--tolerance {:.1}` или больше или разверните ось быстрым ходом над деталью",
                (distance_um * 10.0).ceil() / 10.0
            )),
        CorrectionError::NoBoundsForTurns => Diagnostic::error(NO_BOUNDS_FOR_TURNS, error.text())
            .at(whole, both!("this motion", "это движение"))
            .help(both!("use `--engine rigid-body`, and a profile without [[effect]] entries: both other engines and effects have bounds for rotary axes that stand only", "возьмите `--engine rigid-body` и профиль без разделов [[effect]]: у других методов и у эффектов есть границы только для неподвижных поворотных осей")),
        CorrectionError::Direction { .. } => Diagnostic::error(DIRECTION, error.text())
            .at(whole, both!("this motion", "это движение"))
            .help(both!("give the rotary axes a finer `resolution_deg` in the profile, if the control takes it; or raise `orientation_urad` under [correction]", "задайте поворотным осям в профиле меньший `resolution_deg`, если стойка его принимает; или увеличьте `orientation_urad` в разделе [correction]")),
        CorrectionError::Leans { .. } => Diagnostic::error(LEANS, error.text())
            .at(whole, both!("this motion", "это движение"))
            .help(both!("turn the rotary axes in a rapid that names both of them where the tool begins to cut; give them a finer `resolution_deg`, if the control takes it; raise `orientation_urad` under [correction]; or correct the tip alone with `--orientation xyz`", "поверните поворотные оси быстрым ходом, в котором названы обе, там, где инструмент начинает резать; задайте им меньший `resolution_deg`, если стойка его принимает; увеличьте `orientation_urad` в разделе [correction] или исправляйте только вершину: `--orientation xyz`")),
        CorrectionError::DirectionInPlane => Diagnostic::error(DIRECTION_IN_PLANE, error.text())
            .at(whole, both!("the control brings the tip to places of a plane on which the tool stands upright by the angles as they are", "стойка ведёт вершину по плоскости, на которой инструмент стоит перпендикулярно при углах, какие они есть"))
            .help(both!("correct the tip alone with `--orientation xyz`, or post without tilted planes", "исправляйте только вершину: `--orientation xyz`; или выводите без наклонных плоскостей")),
        CorrectionError::NotWithinTolerance { .. } => Diagnostic::error(NOT_WITHIN_TOLERANCE, error.text())
            .at(whole, both!("this motion", "это движение"))
            .help(both!("the engine's model jumps here (interval methods do at their nodes) or the profile's minimum_segment_mm is too long: use `--engine rigid-body` or `tracker`, or raise `--tolerance`", "модель метода здесь скачет (интервальные — в узлах) или minimum_segment_mm профиля слишком велик: возьмите `--engine rigid-body` или `tracker` или увеличьте `--tolerance`")),
    };
    vec![diagnostic]
}

/// An arc whose radii differ by less is as round as words of two decimals make it, mm.
pub(crate) const SPIRAL_MM: f64 = 0.01;
