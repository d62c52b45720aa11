//! Refusals of tool lengths.

use std::fmt::Display;

use diagnostic::{Refusal, Text, both, refusal};
use nc_dialect::Turning;

use crate::codes;

pub(crate) const MAY_CHANGE_TOOL_AT_ONCE: Refusal = refusal!(const codes::TOOL_LENGTH;
    "may change the tool at once", "может сразу сменить инструмент";
    "brings in a length that no word of the program names, and moves the axes",
    "вводит длину, которой не называет ни одно слово программы, и двигает оси";
    "correct the operations of each tool apart, without T and M6, the length given in the profile's tool.default_mm; or write t_word = \"selects\" in a copy of the grammar where M6 changes the tool",
    "исправляйте переходы каждого инструмента отдельно, без T и M6, задав длину ключом tool.default_mm профиля; или, если инструмент меняет M6, впишите t_word = \"selects\" в копию таблицы диалекта"
);

pub(crate) const NO_TOOL_CALLED: Refusal = refusal!(const codes::TOOL_LENGTH;
    "a tool change, and no tool was called before",
    "смена инструмента, а до неё ни один инструмент не вызван";
    "which tool?", "какой инструмент?";
    "write T and the tool's number before it", "напишите перед ним T и номер инструмента"
);

pub(crate) const NOT_A_TOOL_AND_ITS_OFFSET: Refusal = refusal!(const codes::TOOL_LENGTH;
    "is not a tool and its offset", "— не номер инструмента с номером корректора";
    "which digits are the offset's depends on a parameter (5028)",
    "какие цифры относятся к корректору, зависит от параметра 5028";
    "write two digits for the tool and two for its offset, like T0101; T0100 for no offset",
    "напишите две цифры инструмента и две корректора, например T0101; T0100 — без коррекции"
);

pub(crate) const OFFSET_OF_TOOL_NOT_CALLED: Refusal = refusal!(const codes::TOOL_LENGTH;
    "an offset of a tool that the program has not called",
    "корректор инструмента, который программа не вызывала";
    "of which tool?", "какого инструмента?";
    "write T before it", "напишите перед ним T"
);

pub(crate) fn further_edge(edge: impl Display) -> Refusal {
    refusal!(codes::TOOL_LENGTH;
        "D{edge} is a further edge of the tool", "D{edge} — ещё одна режущая кромка инструмента";
        "the profile has one offset for each tool", "в профиле у каждого инструмента один корректор";
        "write D1, or give the edge a tool of its own",
        "напишите D1 или заведите для кромки отдельный инструмент"
    )
}

pub(crate) fn tool_not_given(name: impl Display) -> Refusal {
    refusal!(codes::TOOL_LENGTH;
        "the tool \"{name}\" is not given", "инструмент \"{name}\" не задан";
        "which length has it?", "какая у него длина?";
        "write `names = {{ \"{name}\" = 1 }}` and its length `lengths_mm = {{ H1 = 120.0 }}` under `[tool]` in the profile",
        "впишите `names = {{ \"{name}\" = 1 }}` и его длину `lengths_mm = {{ H1 = 120.0 }}` в раздел `[tool]` профиля"
    )
}

pub(crate) const TOOL_NOT_SAID: Refusal = refusal!(const codes::TOOL_LENGTH;
    "which tool is in, and which of its edges counts, is not said",
    "не сказано, какой инструмент в шпинделе и какая его кромка считается";
    "moves by a tool length that a parameter chooses (MD20270 CUTTING_EDGE_DEFAULT)",
    "идёт с длиной, которую выбирает параметр MD20270 CUTTING_EDGE_DEFAULT";
    "write T, M6 and D1 before it; or, where D alone is missing, `edge_at_change = 1` under `[program]` in the profile, where MD20270 is 1",
    "напишите перед ним T, M6 и D1; если нет только D, а MD20270 равен 1, впишите `edge_at_change = 1` в раздел `[program]` профиля"
);

pub(crate) const LENGTH_NOT_SAID: Refusal = refusal!(const codes::TOOL_LENGTH;
    "whether the length of the tool that came in holds is not said",
    "не сказано, действует ли длина вошедшего инструмента";
    "with its length on some controls, without it on others",
    "на одних стойках с его длиной, на других без неё";
    "write G43 behind the tool change, in this block or before it",
    "напишите G43 после смены инструмента, в этом кадре или раньше"
);

pub(crate) fn shifts_by_a_length(name: &Text, z: impl Display) -> Refusal {
    refusal!(codes::TOOL_LENGTH;
        "{name} shifts Z by {z} mm: a tool {z} mm long",
        "{name:#} смещает Z на {z} мм: длина инструмента {z} мм";
        "the machine's angles act along the tool: how long is it?",
        "угловые погрешности станка действуют на вылете инструмента: каков он?";
        "where tools are touched off, write what the control's length would be with the bare spindle nose touched off, like `gauge_point_mm = -470.0` under `[tool]` in the profile; a tool is as long as its length lies above that",
        "если длины сняты касанием, впишите в раздел `[tool]` профиля длину, которую стойка получила бы при касании самим торцом шпинделя, например `gauge_point_mm = -470.0`; инструмент длиннее ровно на разницу"
    )
}

pub(crate) const WHILE_TOOL_LENGTH_IN_FORCE: Refusal = refusal!(const codes::TOOL_LENGTH;
    "while a tool length is in force", "при действующей коррекции на длину";
    "ends every tool offset on some controls, cutter compensation alone on others",
    "на одних стойках отменяет все коррекции инструмента, на других только коррекцию на радиус";
    "write the tool length (G43 and its H) again in this block, or what the control's manual says as tool_length.under_g40 in a copy of the grammar",
    "напишите коррекцию на длину (G43 и H) в этом кадре заново или укажите сказанное в руководстве стойки как tool_length.under_g40 в копии таблицы диалекта"
);

pub(crate) const WITH_TOOL_LENGTH: Refusal = refusal!(const codes::TOOL_LENGTH;
    "with a tool length", "с коррекцией на длину";
    "adds a tool offset on some controls, ends the length on others",
    "на одних стойках прибавляет коррекцию инструмента, на других отменяет длину";
    "end the length with G43 H0, or write what the control's manual says as tool_length.under_g49 in a copy of the grammar",
    "отмените длину кадром G43 H0 или укажите сказанное в руководстве стойки как tool_length.under_g49 в копии таблицы диалекта"
);

pub(crate) const NO_TOOL_LOADED: Refusal = refusal!(const codes::TOOL_LENGTH;
    "the length of the loaded tool, and no tool was loaded before",
    "длина инструмента в шпинделе, а до этого инструмент не устанавливали";
    "takes the tool in the spindle: which one?", "берёт инструмент в шпинделе: какой?";
    "program T and M6 before it, or H in this block", "запрограммируйте перед ней T и M6 или H в этом кадре"
);

pub(crate) const TOOL_LENGTH_WITHOUT_H: Refusal = refusal!(const codes::TOOL_LENGTH;
    "tool length without H", "коррекция на длину без H";
    "an H word was expected in this block", "в этом кадре ожидалось слово H";
    "write the number of the length, e.g. H1; H0 is no length",
    "напишите номер длины, например H1; H0 — без длины"
);

pub(crate) fn tool_length_h_not_given(number: impl Display) -> Refusal {
    refusal!(codes::TOOL_LENGTH;
        "tool length H{number} is not given", "длина инструмента H{number} не задана";
        "given by no profile, file or option", "его нет ни в профиле, ни в файлах, ни в ключах";
        "`--tool H{number}=120` for a length of 120 mm, or `lengths_mm = {{ H{number} = 120.0 }}` under `[tool]` in the profile",
        "`--tool H{number}=120` для длины 120 мм или `lengths_mm = {{ H{number} = 120.0 }}` в разделе `[tool]` профиля"
    )
}

pub(crate) fn l_without_p_and_r(code: &str, l: impl Display) -> Refusal {
    refusal!(codes::TOOL_LENGTH;
        "{code} L{l} without P and R", "{code} L{l} без P и R";
        "which length, and how long?", "какая длина и сколько?";
        "write P1 for H1, and its length as R", "напишите P1 для H1 и длину словом R"
    )
}

pub(crate) fn l_under_g91(code: &str, l: impl Display) -> Refusal {
    refusal!(codes::TOOL_LENGTH;
        "{code} L{l} under G91", "{code} L{l} при G91";
        "adds to what the control has", "прибавляет к тому, что есть в стойке";
        "write the whole value in G90", "напишите всё значение при G90"
    )
}

pub(crate) fn rewritten_in_force(number: impl Display) -> Refusal {
    refusal!(codes::TOOL_LENGTH;
        "H{number} is in force and is rewritten", "H{number} действует и переписывается";
        "from which block on? controls differ", "с какого кадра? у стоек по-разному";
        "write it before G43, or end the length with G49",
        "запишите её до G43 или отмените длину функцией G49"
    )
}

/// On a lathe a length has two parts.
pub(crate) fn tool_offset_not_given(offset: u32, turning: Option<&Turning>) -> Refusal {
    let help = if turning.is_some() {
        both!(
            "`--tool H{offset}=X,0,Z` in mm, X a radius, or `lengths_mm = {{ H{offset} = [X, 0, Z] }}` under `[tool]` in the profile",
            "`--tool H{offset}=X,0,Z` в мм, где X — радиус, или `lengths_mm = {{ H{offset} = [X, 0, Z] }}` в разделе `[tool]` профиля"
        )
    } else {
        both!(
            "`--tool H{offset}=120` for a length of 120 mm, or `lengths_mm = {{ H{offset} = 120.0 }}` under `[tool]` in the profile",
            "`--tool H{offset}=120` для длины 120 мм или `lengths_mm = {{ H{offset} = 120.0 }}` в разделе `[tool]` профиля"
        )
    };
    refusal!(codes::TOOL_LENGTH;
        "tool offset {offset:02} is not given", "корректор {offset:02} не задан";
        "given by no profile, file or option", "его нет ни в профиле, ни в файлах, ни в ключах";
        help
    )
}
