//! Refusals of offsets and transforms.

use std::fmt::Display;

use diagnostic::{Refusal, Text, refusal};

use crate::codes;

pub(crate) fn two_codes_in_one_block(code: &str, motion: &str) -> Refusal {
    refusal!(codes::FRAME;
        "{code} and {motion} in one block", "{code} и {motion} в одном кадре";
        "moves the frame: before or after the motion?", "смещает систему координат: до движения или после?";
        "write the two codes in two blocks", "напишите эти две функции двумя кадрами"
    )
}

pub(crate) fn shifts_another_axis(code: &str) -> Refusal {
    refusal!(codes::FRAME;
        "{code} shifts an axis that is not X, Y or Z", "{code} смещает ось, которая не X, не Y и не Z";
        "no offset of such an axis is known", "смещения такой оси неизвестны";
        "remove the word where it is zero; else set the offset on the control",
        "уберите слово, если оно нулевое; иначе задайте смещение на стойке"
    )
}

pub(crate) const UNDER_CUTTER_COMPENSATION: Refusal = refusal!(const codes::FRAME;
    "under cutter compensation", "при коррекции на радиус";
    "the compensated path jumps with it", "эквидистанта скачком сместилась бы вместе с ней";
    "cancel the compensation with G40 before it", "отмените перед ней коррекцию функцией G40"
);

pub(crate) const DURING_DRILLING_CYCLE: Refusal = refusal!(const codes::FRAME;
    "while a drilling cycle is in force", "во время цикла сверления";
    "a cycle is running here", "здесь действует цикл";
    "cancel the cycle with G80 before, and write it again with R and Z afterwards",
    "отмените цикл до этого функцией G80, а после напишите его снова, с R и Z"
);

pub(crate) const BESIDE_ANOTHER_OFFSET: Refusal = refusal!(const codes::FRAME;
    "beside another offset", "рядом с другим смещением";
    "in which order? controls differ", "в каком порядке? у стоек по-разному";
    "write the two codes in two blocks", "напишите эти две функции двумя кадрами"
);

pub(crate) fn under_transform(name: &Text) -> Refusal {
    refusal!(codes::FRAME;
        "under {name}", "при действующем преобразовании ({name:#})";
        "its words may be turned, scaled or not",
        "её слова могут быть повёрнуты и масштабированы, а могут и нет";
        "cancel the rotation, scaling or mirror before it",
        "отмените перед этим поворот, масштабирование или зеркальное отображение"
    )
}

pub(crate) const WITHOUT_SHIFT_OF_THIS_PROGRAM: Refusal = refusal!(const codes::FRAME;
    "without a shift of this program", "без сдвига в этой программе";
    "brings back what an earlier program left", "возвращает то, что осталось от прежней программы";
    "write the shift with G92 or G52, or use a work offset",
    "задайте сдвиг функцией G92 или G52 или возьмите смещение нуля"
);

pub(crate) fn first_motion_must_be_whole(names: impl Display) -> Refusal {
    refusal!(codes::FRAME;
        "the first motion after a rotation, scaling or mirror was switched must be absolute and whole",
        "первое движение после смены поворота, масштаба или зеркального отображения должно быть абсолютным и полным";
        "{names} were expected, in G90: controls differ in where they start otherwise",
        "ожидались {names} при G90: откуда иначе начинать, у стоек по-разному";
        "write {names} in this block, in G90", "напишите {names} в этом кадре, при G90"
    )
}

pub(crate) fn takes_no_words(code: &str) -> Refusal {
    refusal!(codes::FRAME;
        "{code} takes no words", "{code} не принимает слов";
        "whose are they?", "чьи они?";
        "write them in a block of their own", "напишите их отдельным кадром"
    )
}

pub(crate) fn takes_no_letters(code: &str, letters: &str) -> Refusal {
    refusal!(codes::FRAME;
        "{code} takes no {letters}", "{code} не принимает {letters}";
        "X, Y and Z were expected", "ожидались X, Y и Z";
        "remove the word", "уберите слово"
    )
}

pub(crate) const WITHOUT_X_Y_OR_Z: Refusal = refusal!(const codes::FRAME;
    "without X, Y or Z", "без X, Y и Z";
    "shifts what, by how much?", "смещает что и насколько?";
    "write the axes and their values, or remove the code", "напишите оси и их значения или уберите функцию"
);

pub(crate) const UNDER_G91: Refusal = refusal!(const codes::FRAME;
    "under G91", "при G91";
    "added or set? controls differ", "прибавить или установить? у стоек по-разному";
    "write G90 before it", "напишите перед ней G90"
);

pub(crate) const AFTER_G92: Refusal = refusal!(const codes::FRAME;
    "after G92", "после G92";
    "whether the two shifts add up depends on the control", "складываются ли два сдвига, зависит от стойки";
    "use one of the two", "обойдитесь одним из двух"
);

pub(crate) const AFTER_G52: Refusal = refusal!(const codes::FRAME;
    "after G52", "после G52";
    "whether the two shifts add up depends on the control", "складываются ли два сдвига, зависит от стойки";
    "use one of the two", "обойдитесь одним из двух"
);

pub(crate) const WITH_TOOL_LENGTH_IN_FORCE: Refusal = refusal!(const codes::FRAME;
    "with a tool length in force", "при действующей коррекции на длину";
    "with or without the length? a parameter decides", "с учётом длины или без него? решает параметр";
    "write G49 before it, or use a work offset", "напишите перед ней G49 или возьмите смещение нуля"
);

pub(crate) const WITHOUT_AXES: Refusal = refusal!(const codes::FRAME;
    "without axes", "без осей";
    "which axes lose their shift?", "у каких осей снимается сдвиг?";
    "write X0 Y0 Z0 beside it", "напишите рядом X0 Y0 Z0"
);

pub(crate) fn writes_no_work_offset(code: &str) -> Refusal {
    refusal!(codes::FRAME;
        "{code} that writes no work offset", "{code} записывает не смещение нуля";
        "L2 or L20 was expected", "ожидалось L2 или L20";
        "tool tables and parameters: set them on the control, give lengths with --tool, and delete the block",
        "таблицы инструментов и параметры задайте на стойке, длины дайте ключом --tool, а кадр удалите"
    )
}

pub(crate) const WORK_OFFSET_WITH_ROTATION: Refusal = refusal!(const codes::FRAME;
    "a work offset with a rotation", "смещение нуля с поворотом";
    "turns the frame", "поворачивает систему координат";
    "rotate in the CAM, or align the workpiece, and remove R",
    "поверните в CAM или выставьте деталь и уберите R"
);

pub(crate) const WITHOUT_P: Refusal = refusal!(const codes::FRAME;
    "without P", "без P";
    "which work offset?", "какое смещение нуля?";
    "write P1 for G54, P2 for G55", "напишите P1 для G54, P2 для G55"
);

pub(crate) const WITHOUT_WORK_OFFSET_IN_FORCE: Refusal = refusal!(const codes::FRAME;
    "without a work offset in force", "без действующего смещения нуля";
    "P0 is the one in force", "P0 — то, которое действует";
    "write P1 for G54, or G54 before it", "напишите P1 для G54 или G54 перед ней"
);

pub(crate) const WRITES_EXTERNAL_WORK_OFFSET: Refusal = refusal!(const codes::FRAME;
    "writes the external work offset", "записывает внешнее смещение нуля";
    "shifts all work offsets", "смещает все смещения нуля";
    "add it to the work offsets, which P1 to P6 write",
    "прибавьте его к смещениям нуля, которые записывают P1–P6"
);

pub(crate) fn no_such_work_offset(p: impl Display) -> Refusal {
    refusal!(codes::FRAME;
        "there is no work offset P{p}", "смещения нуля P{p} нет";
        "P1 is G54, P2 is G55 and so on", "P1 — это G54, P2 — G55 и так далее";
        "write the number of a work offset of this control", "напишите номер смещения нуля этой стойки"
    )
}

pub(crate) fn work_offset_written_in_part(name: impl Display) -> Refusal {
    refusal!(codes::WORK_OFFSET;
        "work offset {name} is written in part, and the rest is not given",
        "смещение нуля {name} записано частично, а остальное не задано";
        "the axes left out keep what nobody said", "у опущенных осей остаётся то, чего никто не сказал";
        "write X, Y and Z here, or give it with `--work-offset {name}=X,Y,Z`",
        "напишите здесь X, Y и Z или задайте его ключом `--work-offset {name}=X,Y,Z`"
    )
}

pub(crate) fn beside_something_else(code: &str) -> Refusal {
    refusal!(codes::FRAME;
        "{code} beside something else", "{code} рядом с чем-то ещё";
        "a block of its own was expected", "ожидался отдельный кадр";
        "write it in a block of its own", "напишите её отдельным кадром"
    )
}

pub(crate) const WITHOUT_WORDS: Refusal = refusal!(const codes::FRAME;
    "without words", "без слов";
    "adds what to the frame?", "что прибавить к системе координат?";
    "write the axes and their values, or remove it", "напишите оси и их значения или уберите её"
);

pub(crate) const IN_FRAME_WITHOUT_INVERSE: Refusal = refusal!(const codes::FRAME;
    "in a frame without inverse", "в необратимой системе координат";
    "leads nowhere", "никуда не ведёт";
    "cancel the frame with TRANS alone before it",
    "отмените перед этим систему координат: TRANS отдельным кадром"
);

pub(crate) const MIRROR_ABOUT_ANOTHER_PLACE: Refusal = refusal!(const codes::FRAME;
    "a mirror about a place that is not zero", "зеркальное отображение не относительно нуля";
    "0 was expected", "ожидался 0";
    "shift the zero with ATRANS before it, and write 0",
    "сместите перед ним нуль командой ATRANS и напишите 0"
);

pub(crate) fn under_another_transform(name: &Text) -> Refusal {
    refusal!(codes::FRAME;
        "under {name}", "при действующем преобразовании ({name:#})";
        "the two together are neither", "вместе они ни то, ни другое";
        "write one of the two in the CAM", "выполните одно из двух в CAM"
    )
}

pub(crate) const ROTATION_OUT_OF_PLANE: Refusal = refusal!(const codes::FRAME;
    "a rotation out of the plane", "поворот из плоскости";
    "tilts the frame", "наклоняет систему координат";
    "post without tilted planes", "выводите программу без наклонных плоскостей"
);

pub(crate) const BY_TWO_ANGLES: Refusal = refusal!(const codes::FRAME;
    "by two angles", "с двумя углами";
    "RPL= or the plane's normal was expected", "ожидалось RPL= или нормаль плоскости";
    "write RPL= alone", "напишите одно RPL="
);

pub(crate) fn in_which_order(name: &Text) -> Refusal {
    refusal!(codes::FRAME;
        "under {name}", "при действующем преобразовании ({name:#})";
        "in which order? controls and parameters differ",
        "в каком порядке? зависит от стойки и её параметров";
        "cancel the one before it, or do one of the two in the CAM",
        "отмените перед ней прежнюю или выполните одно из двух в CAM"
    )
}

pub(crate) const ROTATION_THAT_TILTS: Refusal = refusal!(const codes::FRAME;
    "a rotation out of the plane", "поворот из плоскости";
    "tilts the frame", "наклоняет систему координат";
    "select the plane with G17, G18 or G19; post tilted planes as plain axes",
    "выберите плоскость функцией G17, G18 или G19; наклонные плоскости выводите обычными осями"
);

pub(crate) fn rotation_without(names: impl Display) -> Refusal {
    refusal!(codes::FRAME;
        "a rotation without {names}", "поворот без {names}";
        "about which point?", "вокруг какой точки?";
        "write {names} of the centre, and R", "напишите {names} центра и R"
    )
}

pub(crate) const ROTATION_WITHOUT_R: Refusal = refusal!(const codes::FRAME;
    "a rotation without R", "поворот без R";
    "by a parameter's angle", "на угол из параметра";
    "write the angle as R", "напишите угол словом R"
);

pub(crate) const SCALING_WITHOUT_CENTRE: Refusal = refusal!(const codes::FRAME;
    "a scaling without X, Y and Z", "масштабирование без X, Y и Z";
    "about which point?", "вокруг какой точки?";
    "write X, Y and Z of the centre", "напишите X, Y и Z центра"
);

pub(crate) const SCALING_WITHOUT_FACTOR: Refusal = refusal!(const codes::FRAME;
    "a scaling without its factor", "масштабирование без коэффициента";
    "P above zero, or I, J and K, were expected", "ожидалось P больше нуля или I, J и K";
    "write P2. to double; negative factors are mirrors: G51.1",
    "напишите P2., чтобы удвоить; отрицательный коэффициент — это зеркальное отображение: G51.1"
);

pub(crate) fn mirrored_already(letter: char) -> Refusal {
    refusal!(codes::FRAME;
        "{letter} is mirrored already", "{letter} уже отражена";
        "twice, or anew? controls differ", "дважды или заново? у стоек по-разному";
        "cancel the mirror with G50.1 before it", "отмените перед этим зеркальное отображение функцией G50.1"
    )
}

pub(crate) const MIRROR_WITHOUT_AXES: Refusal = refusal!(const codes::FRAME;
    "without axes", "без осей";
    "which axes are no longer mirrored?", "какие оси больше не отражать?";
    "write the mirrored axes beside it, as in G50.1 X0 Y0",
    "напишите рядом отражённые оси, например G50.1 X0 Y0"
);
