//! What is said of each effect: its name, a sentence with its size, what to do. One constant an effect, one line in [`of`].

use diagnostic::{Text, both};
use machine_model::effects::{EffectKind, TRACKER as TRACKER_FAULTS};

/// What is said of an effect.
pub(super) struct Said {
    /// In Russian; in English its id.
    pub(super) name: &'static str,
    /// What it does, as a metrologist would say it.
    pub(super) words: fn(&Size<'_>) -> Text,
    /// One sentence for the shop floor.
    pub(super) remedy: Text,
}

/// How large an effect is, and where.
pub(super) struct Size<'a> {
    /// What stands behind the point of its id, without the E of a symbol.
    pub(super) of: &'a str,
    /// `X` of one axis, `X` and `Y` of two, `Y` and `X` of what shows along Y as X moves.
    pub(super) a: &'a str,
    pub(super) b: &'a str,
    /// The first number, and the same without its sign: whole, a tenth, twice.
    pub(super) first: f64,
    pub(super) size: f64,
    pub(super) per_100_mm: f64,
    pub(super) twice: f64,
    /// From the least to the most that it displaces, µm.
    pub(super) swing: f64,
    pub(super) pitch_mm: f64,
    pub(super) tau_min: f64,
    /// When it came: at a time, or from a line of the file on.
    pub(super) moment: &'a Text,
    pub(super) centre_mm: f64,
    pub(super) width_mm: f64,
    /// Until a spike is gone.
    pub(super) way_mm: f64,
}

/// What a tracker reads wrong, in Russian, and the same as an object.
pub(super) const FAULTS: [[&str; 2]; TRACKER_FAULTS.len()] = [
    ["масштаб", "масштаб дальности"],
    ["нуль дальности", "нуль дальности"],
    ["круг азимута", "круг азимута"],
    ["круг угла места", "круг угла места"],
    ["ось качания", "ось качания трубы"],
    ["коллимация", "коллимацию"],
];

/// What is said of an effect.
pub(super) fn of(kind: EffectKind) -> &'static Said {
    match kind {
        EffectKind::Scale(_) => &SCALE,
        EffectKind::Squareness(..) => &SQUARENESS,
        EffectKind::Backlash(_) => &BACKLASH,
        EffectKind::LostMotion { .. } => &LOST_MOTION,
        EffectKind::Thermal(_) => &THERMAL,
        EffectKind::Warmup(_) => &WARMUP,
        EffectKind::Positioning(_) => &POSITIONING,
        EffectKind::Straightness { .. } => &STRAIGHTNESS,
        EffectKind::Pitch(_) => &PITCH,
        EffectKind::Angular { .. } => &ANGULAR,
        EffectKind::Sag(_) => &SAG,
        EffectKind::Load(_) => &LOAD,
        EffectKind::ServoLag(_) => &SERVO_LAG,
        EffectKind::ServoMismatch(..) => &SERVO_MISMATCH,
        EffectKind::Rotary { .. } => &ROTARY,
        EffectKind::Eccentricity(_) => &ECCENTRICITY,
        EffectKind::ProbeLobing => &PROBE_LOBING,
        EffectKind::InstrumentDrift => &INSTRUMENT_DRIFT,
        EffectKind::Step(_) => &STEP,
        EffectKind::Joint(_) => &JOINT,
        EffectKind::Spike(_) => &SPIKE,
        EffectKind::Contraction => &CONTRACTION,
        EffectKind::SpindleTilt(_) => &SPINDLE_TILT,
        EffectKind::Tracker(_) => &TRACKER,
        EffectKind::Local(_) => &LOCAL,
    }
}

static SCALE: Said = Said {
    name: "масштаб",
    words: |&Size { a, first, size, .. }| {
        let way =
            if first > 0.0 { Text::pair("far", "больше") } else { Text::pair("short", "меньше") };
        both!(
            "{a} travels {size:.1} µm per metre too {way}",
            "{a} проходит на {size:.1} мкм на метр {way:#} заданного"
        )
    },
    remedy: Text::pair(
        "Set the scale factor of the axis (screw pitch compensation end value), or let the correction do it; check the scale's temperature first.",
        "Задайте масштабный коэффициент оси (конечное значение компенсации шага винта) или предоставьте это коррекции; сначала проверьте температуру шкалы.",
    ),
};

static SQUARENESS: Said = Said {
    name: "перпендикулярность",
    words: |&Size { a, b, size, per_100_mm, .. }| {
        both!(
            "{b} leans {size:.0} µrad against {a}: {per_100_mm:.1} µm per 100 mm",
            "{b} наклонена на {size:.0} мкрад относительно {a}: {per_100_mm:.1} мкм на 100 мм"
        )
    },
    remedy: Text::pair(
        "Enter the squareness in the profile, or realign the axes if it exceeds the machine's tolerance.",
        "Внесите отклонение от перпендикулярности в профиль или выверьте оси, если оно больше допуска станка.",
    ),
};

static BACKLASH: Said = Said {
    name: "люфт",
    words: |&Size { a, first, twice, .. }| {
        if first < 0.0 {
            both!(
                "{a} reverses with {twice:.1} µm too much, not too little: over-compensated, or the sensor sits on the motor's side",
                "{a} при реверсе проходит на {twice:.1} мкм больше, а не меньше: люфт перекомпенсирован или датчик стоит со стороны двигателя"
            )
        } else {
            both!(
                "{a} loses {twice:.1} µm of travel when it reverses",
                "{a} теряет при реверсе {twice:.1} мкм хода"
            )
        }
    },
    remedy: Text::pair(
        "Set the control's backlash compensation to twice the half width, or have screw, nut and bearing preload checked.",
        "Задайте в ЧПУ компенсацию люфта, равную удвоенной полуширине, или дайте проверить натяг винта, гайки и подшипников.",
    ),
};

static LOST_MOTION: Said = Said {
    name: "мёртвый ход",
    words: |&Size { a, b, twice, .. }| {
        both!(
            "{b} steps {twice:.1} µm along {a} when it reverses",
            "{b} при реверсе смещается на {twice:.1} мкм вдоль {a}"
        )
    },
    remedy: Text::pair(
        "Check gibs and guideway preload: the carriage steps sideways when it reverses.",
        "Проверьте клинья и натяг направляющих: при реверсе каретку уводит вбок.",
    ),
};

static THERMAL: Said = Said {
    name: "тепловое расширение",
    words: |&Size { a, swing, .. }| {
        both!(
            "{a} grows with its temperature: {swing:.1} µm over what was measured",
            "{a} удлиняется от нагрева: {swing:.1} мкм на измеренном участке"
        )
    },
    remedy: Text::pair(
        "Measure at reference temperature, or compensate with the axis' own temperature and this coefficient.",
        "Измеряйте при нормальной температуре или компенсируйте по собственной температуре оси с этим коэффициентом.",
    ),
};

static WARMUP: Said = Said {
    name: "прогрев",
    words: |&Size { a, size, tau_min, .. }| {
        both!(
            "{a} creeps by {size:.1} µm with a time constant of {tau_min:.0} min",
            "{a} при прогреве уходит на {size:.1} мкм с постоянной времени {tau_min:.0} мин"
        )
    },
    remedy: Text::pair(
        "Warm the machine up before measuring and cutting, for at least three time constants.",
        "Прогревайте станок перед измерением и обработкой не меньше трёх постоянных времени.",
    ),
};

static POSITIONING: Said = Said {
    name: "позиционирование",
    words: |&Size { a, swing, .. }| {
        both!(
            "the positions of {a} err along a curve of {swing:.1} µm",
            "отклонение позиционирования {a} идёт по кривой размахом {swing:.1} мкм"
        )
    },
    remedy: Text::pair(
        "Measure the axis with an interferometer and enter its table.",
        "Измерьте ось интерферометром и внесите её таблицу.",
    ),
};

static STRAIGHTNESS: Said = Said {
    name: "прямолинейность",
    words: |&Size { a, b, swing, .. }| {
        both!(
            "{b} runs {swing:.1} µm out of straight along {a}",
            "отклонение от прямолинейности {b} вдоль {a}: {swing:.1} мкм"
        )
    },
    remedy: Text::pair(
        "Measure the axis' straightness and enter its table; check the levelling of the bed.",
        "Измерьте отклонение оси от прямолинейности и внесите её таблицу; проверьте выставку станины по уровню.",
    ),
};

static PITCH: Said = Said {
    name: "шаг винта",
    words: |&Size { a, swing, pitch_mm, .. }| {
        both!(
            "{a} errs by {swing:.1} µm once every {pitch_mm:.2} mm: one turn of its screw",
            "{a} даёт погрешность {swing:.1} мкм с периодом {pitch_mm:.2} мм: это один оборот винта"
        )
    },
    remedy: Text::pair(
        "Check the screw's end bearing and the encoder coupling; a table with steps below a quarter of the pitch corrects it.",
        "Проверьте концевую опору винта и муфту датчика; исправит таблица с шагом меньше четверти шага винта.",
    ),
};

static ANGULAR: Said = Said {
    name: "угол",
    words: |&Size { a, b, swing, .. }| {
        let turns = match (a, b) {
            ("A", "X") | ("B", "Y") | ("C", "Z") => Text::pair("rolls", "отклоняется по крену"),
            ("C", _) => Text::pair("yaws", "отклоняется по рысканию"),
            _ => Text::pair("pitches", "отклоняется по тангажу"),
        };
        both!(
            "{b} {turns} as it travels: {swing:.1} µm at the tool",
            "{b} на ходу {turns:#}: {swing:.1} мкм на инструменте"
        )
    },
    remedy: Text::pair(
        "Measure the axis' angles with level or interferometer and enter its table; check the guideways.",
        "Измерьте углы оси уровнем или интерферометром и внесите её таблицу; проверьте направляющие.",
    ),
};

static SAG: Said = Said {
    name: "провисание",
    words: |&Size { a, swing, .. }| {
        both!("{a} droops by {swing:.1} µm as it reaches out", "{a} провисает на {swing:.1} мкм с вылетом")
    },
    remedy: Text::pair(
        "Use the control's droop compensation over the overhang, or check the ram's counterbalance.",
        "Включите в ЧПУ компенсацию провисания по вылету или проверьте противовес ползуна.",
    ),
};

static LOAD: Said = Said {
    name: "прогиб от нагрузки",
    words: |&Size { a, swing, .. }| {
        both!(
            "the load bends the machine along {a} by {swing:.1} µm",
            "нагрузка прогибает станок вдоль {a} на {swing:.1} мкм"
        )
    },
    remedy: Text::pair(
        "Enter the load with the effect, or compensate the counterbalance; keep the load near the calibrated one.",
        "Внесите нагрузку вместе с эффектом или отрегулируйте противовес; держите нагрузку близкой к той, что была при калибровке.",
    ),
};

static SERVO_LAG: Said = Said {
    name: "отставание привода",
    words: |&Size { a, size, .. }| {
        both!("{a} runs {size:.2} ms behind its command", "{a} отстаёт от задания на {size:.2} мс")
    },
    remedy: Text::pair(
        "Switch feed-forward on or measure at low feed: the error is made by the speed, not by the place.",
        "Включите упреждение по скорости или измеряйте на малой подаче: погрешность создаёт скорость, а не место.",
    ),
};

static SERVO_MISMATCH: Said = Said {
    name: "разница приводов",
    words: |&Size { a, b, size, .. }| {
        both!("{a} and {b} run {size:.2} ms apart", "{a} и {b} расходятся на {size:.2} мс")
    },
    remedy: Text::pair(
        "Match the position loop gains of the two axes.",
        "Согласуйте добротности контуров положения двух осей.",
    ),
};

static ROTARY: Said = Said {
    name: "положение оси",
    words: |&Size { of, swing, .. }| {
        let axis = &of[of.len() - 1..];
        both!(
            "the rotary axis {axis} does not stand where the model has it: {swing:.1} µm",
            "поворотная ось {axis} стоит не там, где в модели: {swing:.1} мкм"
        )
    },
    remedy: Text::pair(
        "Calibrate the location of the rotary axis and enter it in the profile.",
        "Откалибруйте положение поворотной оси и внесите его в профиль.",
    ),
};

static ECCENTRICITY: Said = Said {
    name: "эксцентриситет",
    words: |&Size { a, swing, .. }| {
        both!("{a} errs once per turn by {swing:.1} µm", "{a} даёт погрешность раз за оборот: {swing:.1} мкм")
    },
    remedy: Text::pair(
        "Check the mounting of the rotary encoder or table: the error comes once per turn.",
        "Проверьте установку углового датчика или стола: погрешность повторяется раз за оборот.",
    ),
};

static PROBE_LOBING: Said = Said {
    name: "направление щупа",
    words: |&Size { swing, .. }| {
        both!(
            "the probe triggers {swing:.1} µm apart from direction to direction",
            "измерительная головка срабатывает в разных направлениях с разницей {swing:.1} мкм"
        )
    },
    remedy: Text::pair(
        "Calibrate the probe in the directions used; the machine is not the cause.",
        "Откалибруйте измерительную головку в тех направлениях, в которых меряете; станок не причина.",
    ),
};

static INSTRUMENT_DRIFT: Said = Said {
    name: "дрейф прибора",
    words: |&Size { swing, .. }| {
        both!(
            "the instrument drifts: {swing:.1} µm while it measured",
            "прибор дрейфует: {swing:.1} мкм за время измерения"
        )
    },
    remedy: Text::pair(
        "Let the instrument settle and return to a reference point between lines; the machine is not the cause.",
        "Дайте прибору выйти на режим и между линиями возвращайтесь к опорной точке; станок не причина.",
    ),
};

static STEP: Said = Said {
    name: "скачок",
    words: |&Size { a, size, moment, .. }| {
        both!(
            "something moved by {size:.1} µm along {a} {moment}",
            "что-то сдвинулось на {size:.1} мкм вдоль {a} {moment:#}"
        )
    },
    remedy: Text::pair(
        "Ask what happened at that time (collision, clamping, restart) and measure again.",
        "Выясните, что произошло в это время (столкновение, закрепление, перезапуск), и измерьте снова.",
    ),
};

static JOINT: Said = Said {
    name: "стык направляющих",
    words: |&Size { a, swing, centre_mm, .. }| {
        both!(
            "the rails of {a} do not meet at {centre_mm:.0} mm: a step of {swing:.1} µm",
            "направляющие {a} не сходятся на {centre_mm:.0} мм: ступенька {swing:.1} мкм"
        )
    },
    remedy: Text::pair(
        "Realign the rails where they join, or enter a table with a node on each side of the joint.",
        "Выверьте направляющие в месте стыка или внесите таблицу с узлом по каждую сторону стыка.",
    ),
};

static SPIKE: Said = Said {
    name: "выброс при реверсе",
    words: |&Size { a, size, way_mm, .. }| {
        both!(
            "{a} sticks where it turns: {size:.1} µm, gone after {way_mm:.1} mm of way",
            "{a} залипает в точке реверса: {size:.1} мкм, проходит через {way_mm:.1} мм пути"
        )
    },
    remedy: Text::pair(
        "Set the control's friction (quadrant) compensation for this axis; check lubrication and gibs.",
        "Задайте в ЧПУ компенсацию трения (квадрантных выбросов) для этой оси; проверьте смазку и клинья.",
    ),
};

static CONTRACTION: Said = Said {
    name: "сжатие окружностей",
    words: |&Size { swing, .. }| {
        both!(
            "circles shrink with the square of the feed: {swing:.1} µm over what was measured",
            "окружности сжимаются с квадратом подачи: {swing:.1} мкм в измеренных пределах"
        )
    },
    remedy: Text::pair(
        "Raise the position loop gain or use acceleration feed-forward; until then finish round parts at the slower feed.",
        "Поднимите добротность контура положения или включите упреждение по ускорению; до тех пор обрабатывайте круглые детали начисто на меньшей подаче.",
    ),
};

static SPINDLE_TILT: Said = Said {
    name: "наклон шпинделя",
    words: |&Size { a, size, per_100_mm, .. }| {
        both!(
            "the spindle leans {size:.0} µrad towards {a}: {per_100_mm:.1} µm per 100 mm of tool",
            "шпиндель наклонён на {size:.0} мкрад в сторону {a}: {per_100_mm:.1} мкм на 100 мм инструмента"
        )
    },
    remedy: Text::pair(
        "Tram the spindle, or correct each tool by its length: the axes are not the cause.",
        "Выверьте шпиндель или корректируйте каждый инструмент по его длине: оси не причина.",
    ),
};

static TRACKER: Said = Said {
    name: "трекер",
    words: |&Size { of, swing, .. }| {
        let place = TRACKER_FAULTS.iter().position(|fault| *fault == of);
        let (name, russian) = (of.replace('-', " "), place.map_or(of, |place| FAULTS[place][1]));
        Text::new(
            format!("the tracker reads its {name} wrong: {swing:.1} µm"),
            format!("трекер неверно отсчитывает {russian}: {swing:.1} мкм"),
        )
    },
    remedy: Text::pair(
        "Run the tracker's own two-face and ranging checks and compensate it; the machine is not the cause.",
        "Проведите собственные проверки трекера (два положения трубы, дальность) и его компенсацию; станок не причина.",
    ),
};

static LOCAL: Said = Said {
    name: "местный дефект",
    words: |&Size { a, swing, centre_mm, width_mm, .. }| {
        both!(
            "{a} errs by {swing:.1} µm near {centre_mm:.0} mm, over {width_mm:.0} mm",
            "{a} даёт погрешность {swing:.1} мкм около {centre_mm:.0} мм, на участке {width_mm:.0} мм"
        )
    },
    remedy: Text::pair(
        "Inspect the guideway or scale at that place for damage or dirt.",
        "Осмотрите направляющую или шкалу в этом месте: повреждение или грязь.",
    ),
};
