//! Refusals of turning.

use std::fmt::Display;

use diagnostic::{Refusal, refusal};

use crate::codes;

pub(crate) const WITHOUT_LIMIT_OF_SPEED: Refusal = refusal!(const codes::UNLIMITED_SPEED;
    "without a limit of the spindle's speed", "без ограничения частоты вращения шпинделя";
    "towards the axis the speed rises without end", "к оси частота растёт без предела";
    "write the limit before it: G50 S3000 (Fanuc system A), G92 S3000 (B and C), G96 D3000 (LinuxCNC), LIMS=3000 (Sinumerik)",
    "напишите перед ней ограничение: G50 S3000 (Fanuc, система A), G92 S3000 (B и C), G96 D3000 (LinuxCNC), LIMS=3000 (Sinumerik)"
);

pub(crate) fn thread_without(name: impl Display) -> Refusal {
    refusal!(codes::NO_TURNING;
        "a thread without {name}", "резьба без {name}";
        "{name} is its lead", "{name} — её ход";
        "write {name} in this block", "напишите {name} в этом кадре"
    )
}

pub(crate) fn turning_below_axis(start: f64) -> Refusal {
    refusal!(codes::BELOW_THE_AXIS;
        "turning below the axis", "точение ниже оси";
        "X is negative here: {start:.4} mm on the radius", "X здесь отрицателен: {start:.4} мм по радиусу";
        "a face may pass the centre; what is turned needs X above zero",
        "торец может зайти за центр, а для точения X должен быть больше нуля"
    )
}

pub(crate) const DIAMETER_OR_RADIUS: Refusal = refusal!(const codes::X_UNSTATED;
    "whether X is a diameter or a radius is not said", "не сказано, диаметр X или радиус";
    "half of what is written, or all of it?", "половина написанного или всё?";
    "write `x = \"diameter\"` (or \"radius\") under `[program]` in the profile, or G7 or G8 where the control has them",
    "впишите `x = \"diameter\"` (или \"radius\") в раздел `[program]` профиля или G7, G8 в программу, если они есть у стойки"
);

pub(crate) const INCREMENT_FOR_PLACE: Refusal = refusal!(const codes::NO_TURNING;
    "an increment where a place was expected", "приращение там, где ожидалась координата";
    "U and W add to X and Z", "U и W прибавляются к X и Z";
    "write the place with X and Z", "напишите координаты словами X и Z"
);

pub(crate) const ARC_OUT_OF_PLANE: Refusal = refusal!(const codes::NO_TURNING;
    "an arc out of the plane of X and Z", "дуга не в плоскости X и Z";
    "a lathe turns arcs in G18", "на токарном станке дуги выполняются в G18";
    "write G18 before it", "напишите перед ней G18"
);
