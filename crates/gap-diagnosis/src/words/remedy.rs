//! What to do about each cause.

use diagnostic::Text;
use machine_model::effects::EffectKind;

/// One sentence for the shop floor.
#[must_use]
pub const fn remedy(kind: EffectKind) -> Text {
    match kind {
        EffectKind::Scale(_) => Text::pair(
            "Set the scale factor of the axis (screw pitch compensation end value), or let the correction do it; check the scale's temperature first.",
            "Задайте масштабный коэффициент оси (конечное значение компенсации шага винта) или предоставьте это коррекции; сначала проверьте температуру шкалы.",
        ),
        EffectKind::Thermal(_) => Text::pair(
            "Measure at reference temperature, or compensate with the axis' own temperature and this coefficient.",
            "Измеряйте при нормальной температуре или компенсируйте по собственной температуре оси с этим коэффициентом.",
        ),
        EffectKind::Warmup(_) => Text::pair(
            "Warm the machine up before measuring and cutting, for at least three time constants.",
            "Прогревайте станок перед измерением и обработкой не меньше трёх постоянных времени.",
        ),
        EffectKind::Backlash(_) => Text::pair(
            "Set the control's backlash compensation to twice the half width, or have screw, nut and bearing preload checked.",
            "Задайте в ЧПУ компенсацию люфта, равную удвоенной полуширине, или дайте проверить натяг винта, гайки и подшипников.",
        ),
        EffectKind::LostMotion { .. } => Text::pair(
            "Check gibs and guideway preload: the carriage steps sideways when it reverses.",
            "Проверьте клинья и натяг направляющих: при реверсе каретку уводит вбок.",
        ),
        EffectKind::Squareness(..) => Text::pair(
            "Enter the squareness in the profile, or realign the axes if it exceeds the machine's tolerance.",
            "Внесите отклонение от перпендикулярности в профиль или выверьте оси, если оно больше допуска станка.",
        ),
        EffectKind::Positioning(_) => Text::pair(
            "Measure the axis with an interferometer and enter its table.",
            "Измерьте ось интерферометром и внесите её таблицу.",
        ),
        EffectKind::Straightness { .. } => Text::pair(
            "Measure the axis' straightness and enter its table; check the levelling of the bed.",
            "Измерьте отклонение оси от прямолинейности и внесите её таблицу; проверьте выставку станины по уровню.",
        ),
        EffectKind::Pitch(_) => Text::pair(
            "Check the screw's end bearing and the encoder coupling; a table with steps below a quarter of the pitch corrects it.",
            "Проверьте концевую опору винта и муфту датчика; исправит таблица с шагом меньше четверти шага винта.",
        ),
        EffectKind::Angular { .. } => Text::pair(
            "Measure the axis' angles with level or interferometer and enter its table; check the guideways.",
            "Измерьте углы оси уровнем или интерферометром и внесите её таблицу; проверьте направляющие.",
        ),
        EffectKind::Sag(_) => Text::pair(
            "Use the control's droop compensation over the overhang, or check the ram's counterbalance.",
            "Включите в ЧПУ компенсацию провисания по вылету или проверьте противовес ползуна.",
        ),
        EffectKind::Load(_) => Text::pair(
            "Enter the load with the effect, or compensate the counterbalance; keep the load near the calibrated one.",
            "Внесите нагрузку вместе с эффектом или отрегулируйте противовес; держите нагрузку близкой к той, что была при калибровке.",
        ),
        EffectKind::ServoLag(_) => Text::pair(
            "Switch feed-forward on or measure at low feed: the error is made by the speed, not by the place.",
            "Включите упреждение по скорости или измеряйте на малой подаче: погрешность создаёт скорость, а не место.",
        ),
        EffectKind::ServoMismatch(..) => Text::pair(
            "Match the position loop gains of the two axes.",
            "Согласуйте добротности контуров положения двух осей.",
        ),
        EffectKind::Rotary { .. } => Text::pair(
            "Calibrate the location of the rotary axis and enter it in the profile.",
            "Откалибруйте положение поворотной оси и внесите его в профиль.",
        ),
        EffectKind::Eccentricity(_) => Text::pair(
            "Check the mounting of the rotary encoder or table: the error comes once per turn.",
            "Проверьте установку углового датчика или стола: погрешность повторяется раз за оборот.",
        ),
        EffectKind::ProbeLobing => Text::pair(
            "Calibrate the probe in the directions used; the machine is not the cause.",
            "Откалибруйте измерительную головку в тех направлениях, в которых меряете; станок не причина.",
        ),
        EffectKind::InstrumentDrift => Text::pair(
            "Let the instrument settle and return to a reference point between lines; the machine is not the cause.",
            "Дайте прибору выйти на режим и между линиями возвращайтесь к опорной точке; станок не причина.",
        ),
        EffectKind::Step(_) => Text::pair(
            "Ask what happened at that time (collision, clamping, restart) and measure again.",
            "Выясните, что произошло в это время (столкновение, закрепление, перезапуск), и измерьте снова.",
        ),
        EffectKind::Local(_) => Text::pair(
            "Inspect the guideway or scale at that place for damage or dirt.",
            "Осмотрите направляющую или шкалу в этом месте: повреждение или грязь.",
        ),
        EffectKind::Joint(_) => Text::pair(
            "Realign the rails where they join, or enter a table with a node on each side of the joint.",
            "Выверьте направляющие в месте стыка или внесите таблицу с узлом по каждую сторону стыка.",
        ),
        EffectKind::Spike(_) => Text::pair(
            "Set the control's friction (quadrant) compensation for this axis; check lubrication and gibs.",
            "Задайте в ЧПУ компенсацию трения (квадрантных выбросов) для этой оси; проверьте смазку и клинья.",
        ),
        EffectKind::Contraction => Text::pair(
            "Raise the position loop gain or use acceleration feed-forward; until then finish round parts at the slower feed.",
            "Поднимите добротность контура положения или включите упреждение по ускорению; до тех пор обрабатывайте круглые детали начисто на меньшей подаче.",
        ),
        EffectKind::SpindleTilt(_) => Text::pair(
            "Tram the spindle, or correct each tool by its length: the axes are not the cause.",
            "Выверьте шпиндель или корректируйте каждый инструмент по его длине: оси не причина.",
        ),
        EffectKind::Tracker(_) => Text::pair(
            "Run the tracker's own two-face and ranging checks and compensate it; the machine is not the cause.",
            "Проведите собственные проверки трекера (два положения трубы, дальность) и его компенсацию; станок не причина.",
        ),
    }
}
