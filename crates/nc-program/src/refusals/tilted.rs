//! Refusals of tilted planes.

use std::fmt::Display;

use diagnostic::{Refusal, Text, refusal};

use crate::codes;

pub(crate) fn defines_plane_otherwise(code: impl Display, form: impl Display, what: &Text) -> Refusal {
    refusal!(codes::TILTED_PLANE;
        "{code} P{form} defines a plane {what}", "{code} P{form} задаёт плоскость {what:#}";
        "which turn that is, is not certain", "какой это поворот, неясно";
        "write the plane by Euler angles: P0 and I, J, K about Z, the new X and the new Z",
        "задайте плоскость углами Эйлера: P0 и I, J, K вокруг Z, новой X и новой Z"
    )
}

pub(crate) const UNDER_TOOL_CENTRE_POINT_CONTROL: Refusal = refusal!(const codes::TILTED_PLANE;
    "under tool centre point control", "при управлении по вершине инструмента";
    "are X, Y and Z in the plane's coordinates then, or in the workpiece's?",
    "в чьих координатах тогда X, Y и Z: плоскости или детали?";
    "switch tool centre point control off before", "отключите до этого управление по вершине инструмента"
);

pub(crate) const INSIDE_TILTED_PLANE: Refusal = refusal!(const codes::TILTED_PLANE;
    "inside a tilted plane", "в наклонной плоскости";
    "in the coordinates of which plane?", "в координатах какой плоскости?";
    "cancel the plane before with G69", "отмените до этого плоскость функцией G69"
);

pub(crate) const WITH_TOOL_LENGTH_IN_FORCE: Refusal = refusal!(const codes::TILTED_PLANE;
    "with a tool length in force", "при действующей коррекции на длину";
    "along which axis is the length then?", "вдоль какой оси тогда длина?";
    "write G49 before it, and G43 with its H behind G53.1, or in the plane",
    "напишите перед ней G49, а G43 с H — после G53.1 или в плоскости"
);

pub(crate) const ON_A_MACHINE_THAT_TURNS_THE_TOOL: Refusal = refusal!(const codes::TILTED_PLANE;
    "on a machine that turns the tool", "на станке, который поворачивает инструмент";
    "what follows the head, the offset or the tool?",
    "что следует за головкой: смещение нуля или инструмент?";
    "write G234 in its place", "напишите вместо неё G234"
);

pub(crate) const DEFINITION_NOT_WHOLE: Refusal = refusal!(const codes::TILTED_PLANE;
    "the definition of a tilted plane is not whole", "наклонная плоскость задана не полностью";
    "points and vectors of one plane stand in blocks one behind the other",
    "точки и векторы одной плоскости стоят в кадрах, идущих подряд";
    "write all its blocks, Q1 and Q2, of three points Q3 too, before anything else",
    "напишите прежде всего остального все её кадры: Q1 и Q2, для трёх точек ещё Q3"
);

pub(crate) const WITHOUT_X_Y_AND_Z: Refusal = refusal!(const codes::TILTED_PLANE;
    "without X, Y and Z", "без X, Y и Z";
    "where the axes stand, or at zero? controls differ", "там, где стоят оси, или в нуле? у стоек по-разному";
    "write X, Y and Z of the plane's zero, or of the point", "напишите X, Y и Z нуля плоскости или точки"
);

pub(crate) const WITHOUT_ANGLE: Refusal = refusal!(const codes::TILTED_PLANE;
    "without an angle", "без угла";
    "a plane that is not tilted, or as the last one?", "без наклона или как прошлая плоскость?";
    "write I, J and K in degrees", "напишите I, J и K в градусах"
);

pub(crate) fn p1_without_q123(code: &str) -> Refusal {
    refusal!(codes::TILTED_PLANE;
        "{code} P1 without Q123", "{code} P1 без Q123";
        "whether I, J, K then change places, controls differ",
        "меняются ли тогда местами I, J, K, у стоек по-разному";
        "write Q123, and one angle: I about X, J about Y or K about Z; or the plane by Euler angles (P0)",
        "напишите Q123 и один угол: I вокруг X, J вокруг Y или K вокруг Z; или задайте плоскость углами Эйлера (P0)"
    )
}

pub(crate) fn p1_with_more_than_one_angle(code: &str) -> Refusal {
    refusal!(codes::TILTED_PLANE;
        "{code} P1 with more than one angle", "{code} P1 больше чем с одним углом";
        "about axes that stand, or that turn? controls differ",
        "вокруг неподвижных осей или поворачивающихся? у стоек по-разному";
        "write the plane by Euler angles: P0 and I, J, K about Z, the new X and the new Z",
        "задайте плоскость углами Эйлера: P0 и I, J, K вокруг Z, новой X и новой Z"
    )
}

pub(crate) fn without_number_of_block(
    code: impl Display,
    form: impl Display,
    least: impl Display,
    last: impl Display,
) -> Refusal {
    refusal!(codes::TILTED_PLANE;
        "{code} P{form} without the number of its block", "{code} P{form} без номера своего кадра";
        "Q{least} to Q{last} were expected", "ожидались Q{least}–Q{last}";
        "write Q1 beside the plane's zero", "напишите Q1 рядом с нулём плоскости"
    )
}

pub(crate) fn block_stands_twice(code: impl Display, form: impl Display, q: impl Display) -> Refusal {
    refusal!(codes::TILTED_PLANE;
        "{code} P{form} Q{q} stands twice", "{code} P{form} Q{q} стоит дважды";
        "which one?", "какое из двух?";
        "remove one of the two", "уберите одно из двух"
    )
}

pub(crate) fn vector_of_no_length(code: impl Display, q: impl Display) -> Refusal {
    refusal!(codes::TILTED_PLANE;
        "{code} P3 Q{q} with a vector of no length", "{code} P3 Q{q} с нулевым вектором";
        "no direction", "направления нет";
        "write I, J and K of the direction", "напишите I, J и K направления"
    )
}

pub(crate) const POINTS_ON_ONE_LINE: Refusal = refusal!(const codes::TILTED_PLANE;
    "three points of a tilted plane lie on one line", "три точки наклонной плоскости лежат на одной прямой";
    "no plane, or any", "плоскости нет или подходит любая";
    "write three points that span the plane", "напишите три точки не на одной прямой"
);

pub(crate) fn vectors_not_square(angle_deg: f64) -> Refusal {
    refusal!(codes::TILTED_PLANE;
        "the two vectors of a tilted plane are not at right angles",
        "два вектора наклонной плоскости не под прямым углом";
        "by {angle_deg:.4} degrees: which of the two stays is not certain",
        "на {angle_deg:.4} градуса: какой из двух остаётся, неясно";
        "write the vectors with more decimals, or the plane by angles or points",
        "напишите векторы с большим числом знаков или задайте плоскость углами или точками"
    )
}

pub(crate) const WITHOUT_TILTED_PLANE: Refusal = refusal!(const codes::TILTED_PLANE;
    "without a tilted plane", "без наклонной плоскости";
    "turns the tool to which plane?", "к какой плоскости повернуть инструмент?";
    "write G68.2 before it", "напишите перед ней G68.2"
);

pub(crate) fn tool_not_upright(angle: impl Display) -> Refusal {
    refusal!(codes::PLANE_ANGLES;
        "the rotary axes do not stand the tool upright on the tilted plane",
        "поворотные оси не ставят инструмент перпендикулярно наклонной плоскости";
        "it leans by {angle} degrees", "наклон {angle}°";
        "write the angles that belong to the plane before G68.2, with as many decimals as the plane has, or G53.1 behind it",
        "напишите до G68.2 углы этой плоскости с тем же числом знаков, что и у неё, или после неё G53.1"
    )
}

pub(crate) const TOOL_BESIDE_SPINDLE_AXIS: Refusal = refusal!(const codes::TILTED_PLANE;
    "a tool beside the spindle's axis in a tilted plane",
    "в наклонной плоскости инструмент не на оси шпинделя";
    "along which axes is it then?", "вдоль каких осей он тогда?";
    "give the tool's length along Z alone, or post without tilted planes",
    "задайте длину инструмента только вдоль Z или выводите без наклонных плоскостей"
);

pub(crate) const TURN_ABOUT_THE_ZERO: Refusal = refusal!(const codes::TILTED_PLANE; Text::EMPTY;
    "turns the plane about its zero, before or behind its own angles?",
    "поворачивает плоскость вокруг её нуля: до её углов или после?";
    "write the turn into the plane's angles, points or vectors, and remove R",
    "учтите поворот в углах, точках или векторах плоскости и уберите R"
);

pub(crate) const MOTION_BESIDE: Refusal = refusal!(const codes::TILTED_PLANE; Text::EMPTY;
    "before or behind the motion?", "до движения или после?";
    "write the code alone in its block", "напишите функцию отдельным кадром"
);

pub(crate) const OTHER_ORDER_OF_EULER: Refusal = refusal!(const codes::TILTED_PLANE; Text::EMPTY;
    "another order of Euler angles on some controls", "на некоторых стойках другой порядок углов Эйлера";
    "write the plane by I about Z, J about the new X and K about the new Z, and remove Q",
    "задайте плоскость словами I вокруг Z, J вокруг новой X и K вокруг новой Z и уберите Q"
);

pub(crate) const NO_MEANING_IN_THIS_BLOCK: Refusal = refusal!(const codes::TILTED_PLANE; Text::EMPTY;
    "has no meaning in this block of the plane", "в этом кадре плоскости ничего не значит";
    "remove the word, or write it in the block that it belongs to",
    "уберите слово или напишите его в том кадре, к которому оно относится"
);

pub(crate) const SHIFT_IN_PLANE_OR_WORKPIECE: Refusal = refusal!(const codes::TILTED_PLANE; Text::EMPTY;
    "a shift in the plane, or in the workpiece? controls differ",
    "сдвиг в плоскости или в детали? у стоек по-разному";
    "write the plane's zero as its first point, and zeros or nothing as Q0",
    "напишите нуль плоскости первой точкой, а Q0 — с нулями или совсем не пишите"
);

pub(crate) const AXES_CHOSEN_BY_THE_CONTROL: Refusal = refusal!(const codes::TILTED_PLANE; Text::EMPTY;
    "chooses or moves something, as the control has it", "что-то выбирает или двигает, у каждой стойки своё";
    "write the code alone in its block, and say which way the control turns as `branch` and `turn` under `[kinematics]` in the profile",
    "напишите функцию отдельным кадром, а куда поворачивает стойка, скажите ключами `branch` и `turn` раздела `[kinematics]` профиля"
);
