//! Refusals of offsets and transforms.

use std::fmt::Display;

use diagnostic::{Refusal, Text, both};

use crate::codes;

pub(crate) fn two_codes_in_one_block(code: &str, motion: &str) -> Refusal {
    Refusal {
        code: codes::FRAME,
        message: both!("{code} and {motion} in one block", "{code} и {motion} в одном кадре"),
        label: both!(
            "moves the frame: before or after the motion?",
            "смещает систему координат: до движения или после?"
        ),
        help: both!("write the two codes in two blocks", "напишите эти две функции двумя кадрами"),
    }
}

pub(crate) fn shifts_another_axis(code: &str) -> Refusal {
    Refusal {
        code: codes::FRAME,
        message: both!(
            "{code} shifts an axis that is not X, Y or Z",
            "{code} смещает ось, которая не X, не Y и не Z"
        ),
        label: both!("no offset of such an axis is known", "смещения такой оси неизвестны"),
        help: both!(
            "remove the word where it is zero; else set the offset on the control",
            "уберите слово, если оно нулевое; иначе задайте смещение на стойке"
        ),
    }
}

pub(crate) const UNDER_CUTTER_COMPENSATION: Refusal = Refusal {
    code: codes::FRAME,
    message: Text::pair("under cutter compensation", "при коррекции на радиус"),
    label: Text::pair(
        "the compensated path jumps with it",
        "эквидистанта скачком сместилась бы вместе с ней",
    ),
    help: Text::pair(
        "cancel the compensation with G40 before it",
        "отмените перед ней коррекцию функцией G40",
    ),
};

pub(crate) const DURING_DRILLING_CYCLE: Refusal = Refusal {
    code: codes::FRAME,
    message: Text::pair("while a drilling cycle is in force", "во время цикла сверления"),
    label: Text::pair("a cycle is running here", "здесь действует цикл"),
    help: Text::pair(
        "cancel the cycle with G80 before, and write it again with R and Z afterwards",
        "отмените цикл до этого функцией G80, а после напишите его снова, с R и Z",
    ),
};

pub(crate) const BESIDE_ANOTHER_OFFSET: Refusal = Refusal {
    code: codes::FRAME,
    message: Text::pair("beside another offset", "рядом с другим смещением"),
    label: Text::pair("in which order? controls differ", "в каком порядке? у стоек по-разному"),
    help: Text::pair("write the two codes in two blocks", "напишите эти две функции двумя кадрами"),
};

pub(crate) fn under_transform(name: &Text) -> Refusal {
    Refusal {
        code: codes::FRAME,
        message: both!("under {name}", "при действующем преобразовании ({name:#})"),
        label: both!(
            "its words may be turned, scaled or not",
            "её слова могут быть повёрнуты и масштабированы, а могут и нет"
        ),
        help: both!(
            "cancel the rotation, scaling or mirror before it",
            "отмените перед этим поворот, масштабирование или зеркальное отображение"
        ),
    }
}

pub(crate) const WITHOUT_SHIFT_OF_THIS_PROGRAM: Refusal = Refusal {
    code: codes::FRAME,
    message: Text::pair("without a shift of this program", "без сдвига в этой программе"),
    label: Text::pair(
        "brings back what an earlier program left",
        "возвращает то, что осталось от прежней программы",
    ),
    help: Text::pair(
        "write the shift with G92 or G52, or use a work offset",
        "задайте сдвиг функцией G92 или G52 или возьмите смещение нуля",
    ),
};

pub(crate) fn first_motion_must_be_whole(names: impl Display) -> Refusal {
    Refusal {
        code: codes::FRAME,
        message: both!(
            "the first motion after a rotation, scaling or mirror was switched must be absolute and whole",
            "первое движение после смены поворота, масштаба или зеркального отображения должно быть абсолютным и полным"
        ),
        label: both!(
            "{names} were expected, in G90: controls differ in where they start otherwise",
            "ожидались {names} при G90: откуда иначе начинать, у стоек по-разному"
        ),
        help: both!("write {names} in this block, in G90", "напишите {names} в этом кадре, при G90"),
    }
}

pub(crate) fn takes_no_words(code: &str) -> Refusal {
    Refusal {
        code: codes::FRAME,
        message: both!("{code} takes no words", "{code} не принимает слов"),
        label: both!("whose are they?", "чьи они?"),
        help: both!("write them in a block of their own", "напишите их отдельным кадром"),
    }
}

pub(crate) fn takes_no_letters(code: &str, letters: &str) -> Refusal {
    Refusal {
        code: codes::FRAME,
        message: both!("{code} takes no {letters}", "{code} не принимает {letters}"),
        label: both!("X, Y and Z were expected", "ожидались X, Y и Z"),
        help: both!("remove the word", "уберите слово"),
    }
}

pub(crate) const WITHOUT_X_Y_OR_Z: Refusal = Refusal {
    code: codes::FRAME,
    message: Text::pair("without X, Y or Z", "без X, Y и Z"),
    label: Text::pair("shifts what, by how much?", "смещает что и насколько?"),
    help: Text::pair(
        "write the axes and their values, or remove the code",
        "напишите оси и их значения или уберите функцию",
    ),
};

pub(crate) const UNDER_G91: Refusal = Refusal {
    code: codes::FRAME,
    message: Text::pair("under G91", "при G91"),
    label: Text::pair("added or set? controls differ", "прибавить или установить? у стоек по-разному"),
    help: Text::pair("write G90 before it", "напишите перед ней G90"),
};

pub(crate) const AFTER_G92: Refusal = Refusal {
    code: codes::FRAME,
    message: Text::pair("after G92", "после G92"),
    label: Text::pair(
        "whether the two shifts add up depends on the control",
        "складываются ли два сдвига, зависит от стойки",
    ),
    help: Text::pair("use one of the two", "обойдитесь одним из двух"),
};

pub(crate) const AFTER_G52: Refusal = Refusal {
    code: codes::FRAME,
    message: Text::pair("after G52", "после G52"),
    label: Text::pair(
        "whether the two shifts add up depends on the control",
        "складываются ли два сдвига, зависит от стойки",
    ),
    help: Text::pair("use one of the two", "обойдитесь одним из двух"),
};

pub(crate) const WITH_TOOL_LENGTH_IN_FORCE: Refusal = Refusal {
    code: codes::FRAME,
    message: Text::pair("with a tool length in force", "при действующей коррекции на длину"),
    label: Text::pair(
        "with or without the length? a parameter decides",
        "с учётом длины или без него? решает параметр",
    ),
    help: Text::pair(
        "write G49 before it, or use a work offset",
        "напишите перед ней G49 или возьмите смещение нуля",
    ),
};

pub(crate) const WITHOUT_AXES: Refusal = Refusal {
    code: codes::FRAME,
    message: Text::pair("without axes", "без осей"),
    label: Text::pair("which axes lose their shift?", "у каких осей снимается сдвиг?"),
    help: Text::pair("write X0 Y0 Z0 beside it", "напишите рядом X0 Y0 Z0"),
};

pub(crate) fn writes_no_work_offset(code: &str) -> Refusal {
    Refusal {
        code: codes::FRAME,
        message: both!("{code} that writes no work offset", "{code} записывает не смещение нуля"),
        label: both!("L2 or L20 was expected", "ожидалось L2 или L20"),
        help: both!(
            "tool tables and parameters: set them on the control, give lengths with --tool, and delete the block",
            "таблицы инструментов и параметры задайте на стойке, длины дайте ключом --tool, а кадр удалите"
        ),
    }
}

pub(crate) const WORK_OFFSET_WITH_ROTATION: Refusal = Refusal {
    code: codes::FRAME,
    message: Text::pair("a work offset with a rotation", "смещение нуля с поворотом"),
    label: Text::pair("turns the frame", "поворачивает систему координат"),
    help: Text::pair(
        "rotate in the CAM, or align the workpiece, and remove R",
        "поверните в CAM или выставьте деталь и уберите R",
    ),
};

pub(crate) const WITHOUT_P: Refusal = Refusal {
    code: codes::FRAME,
    message: Text::pair("without P", "без P"),
    label: Text::pair("which work offset?", "какое смещение нуля?"),
    help: Text::pair("write P1 for G54, P2 for G55", "напишите P1 для G54, P2 для G55"),
};

pub(crate) const WITHOUT_WORK_OFFSET_IN_FORCE: Refusal = Refusal {
    code: codes::FRAME,
    message: Text::pair("without a work offset in force", "без действующего смещения нуля"),
    label: Text::pair("P0 is the one in force", "P0 — то, которое действует"),
    help: Text::pair("write P1 for G54, or G54 before it", "напишите P1 для G54 или G54 перед ней"),
};

pub(crate) const WRITES_EXTERNAL_WORK_OFFSET: Refusal = Refusal {
    code: codes::FRAME,
    message: Text::pair("writes the external work offset", "записывает внешнее смещение нуля"),
    label: Text::pair("shifts all work offsets", "смещает все смещения нуля"),
    help: Text::pair(
        "add it to the work offsets, which P1 to P6 write",
        "прибавьте его к смещениям нуля, которые записывают P1–P6",
    ),
};

pub(crate) fn no_such_work_offset(p: impl Display) -> Refusal {
    Refusal {
        code: codes::FRAME,
        message: both!("there is no work offset P{p}", "смещения нуля P{p} нет"),
        label: both!("P1 is G54, P2 is G55 and so on", "P1 — это G54, P2 — G55 и так далее"),
        help: both!(
            "write the number of a work offset of this control",
            "напишите номер смещения нуля этой стойки"
        ),
    }
}

pub(crate) fn work_offset_written_in_part(name: impl Display) -> Refusal {
    Refusal {
        code: codes::WORK_OFFSET,
        message: both!(
            "work offset {name} is written in part, and the rest is not given",
            "смещение нуля {name} записано частично, а остальное не задано"
        ),
        label: both!(
            "the axes left out keep what nobody said",
            "у опущенных осей остаётся то, чего никто не сказал"
        ),
        help: both!(
            "write X, Y and Z here, or give it with `--work-offset {name}=X,Y,Z`",
            "напишите здесь X, Y и Z или задайте его ключом `--work-offset {name}=X,Y,Z`"
        ),
    }
}

pub(crate) fn beside_something_else(code: &str) -> Refusal {
    Refusal {
        code: codes::FRAME,
        message: both!("{code} beside something else", "{code} рядом с чем-то ещё"),
        label: both!("a block of its own was expected", "ожидался отдельный кадр"),
        help: both!("write it in a block of its own", "напишите её отдельным кадром"),
    }
}

pub(crate) const WITHOUT_WORDS: Refusal = Refusal {
    code: codes::FRAME,
    message: Text::pair("without words", "без слов"),
    label: Text::pair("adds what to the frame?", "что прибавить к системе координат?"),
    help: Text::pair(
        "write the axes and their values, or remove it",
        "напишите оси и их значения или уберите её",
    ),
};

pub(crate) const IN_FRAME_WITHOUT_INVERSE: Refusal = Refusal {
    code: codes::FRAME,
    message: Text::pair("in a frame without inverse", "в необратимой системе координат"),
    label: Text::pair("leads nowhere", "никуда не ведёт"),
    help: Text::pair(
        "cancel the frame with TRANS alone before it",
        "отмените перед этим систему координат: TRANS отдельным кадром",
    ),
};

pub(crate) const MIRROR_ABOUT_ANOTHER_PLACE: Refusal = Refusal {
    code: codes::FRAME,
    message: Text::pair(
        "a mirror about a place that is not zero",
        "зеркальное отображение не относительно нуля",
    ),
    label: Text::pair("0 was expected", "ожидался 0"),
    help: Text::pair(
        "shift the zero with ATRANS before it, and write 0",
        "сместите перед ним нуль командой ATRANS и напишите 0",
    ),
};

pub(crate) fn under_another_transform(name: &Text) -> Refusal {
    Refusal {
        code: codes::FRAME,
        message: both!("under {name}", "при действующем преобразовании ({name:#})"),
        label: both!("the two together are neither", "вместе они ни то, ни другое"),
        help: both!("write one of the two in the CAM", "выполните одно из двух в CAM"),
    }
}

pub(crate) const ROTATION_OUT_OF_PLANE: Refusal = Refusal {
    code: codes::FRAME,
    message: Text::pair("a rotation out of the plane", "поворот из плоскости"),
    label: Text::pair("tilts the frame", "наклоняет систему координат"),
    help: Text::pair("post without tilted planes", "выводите программу без наклонных плоскостей"),
};

pub(crate) const BY_TWO_ANGLES: Refusal = Refusal {
    code: codes::FRAME,
    message: Text::pair("by two angles", "с двумя углами"),
    label: Text::pair("RPL= or the plane's normal was expected", "ожидалось RPL= или нормаль плоскости"),
    help: Text::pair("write RPL= alone", "напишите одно RPL="),
};

pub(crate) fn in_which_order(name: &Text) -> Refusal {
    Refusal {
        code: codes::FRAME,
        message: both!("under {name}", "при действующем преобразовании ({name:#})"),
        label: both!(
            "in which order? controls and parameters differ",
            "в каком порядке? зависит от стойки и её параметров"
        ),
        help: both!(
            "cancel the one before it, or do one of the two in the CAM",
            "отмените перед ней прежнюю или выполните одно из двух в CAM"
        ),
    }
}

pub(crate) const ROTATION_THAT_TILTS: Refusal = Refusal {
    code: codes::FRAME,
    message: Text::pair("a rotation out of the plane", "поворот из плоскости"),
    label: Text::pair("tilts the frame", "наклоняет систему координат"),
    help: Text::pair(
        "select the plane with G17, G18 or G19; post tilted planes as plain axes",
        "выберите плоскость функцией G17, G18 или G19; наклонные плоскости выводите обычными осями",
    ),
};

pub(crate) fn rotation_without(names: impl Display) -> Refusal {
    Refusal {
        code: codes::FRAME,
        message: both!("a rotation without {names}", "поворот без {names}"),
        label: both!("about which point?", "вокруг какой точки?"),
        help: both!("write {names} of the centre, and R", "напишите {names} центра и R"),
    }
}

pub(crate) const ROTATION_WITHOUT_R: Refusal = Refusal {
    code: codes::FRAME,
    message: Text::pair("a rotation without R", "поворот без R"),
    label: Text::pair("by a parameter's angle", "на угол из параметра"),
    help: Text::pair("write the angle as R", "напишите угол словом R"),
};

pub(crate) const SCALING_WITHOUT_CENTRE: Refusal = Refusal {
    code: codes::FRAME,
    message: Text::pair("a scaling without X, Y and Z", "масштабирование без X, Y и Z"),
    label: Text::pair("about which point?", "вокруг какой точки?"),
    help: Text::pair("write X, Y and Z of the centre", "напишите X, Y и Z центра"),
};

pub(crate) const SCALING_WITHOUT_FACTOR: Refusal = Refusal {
    code: codes::FRAME,
    message: Text::pair("a scaling without its factor", "масштабирование без коэффициента"),
    label: Text::pair("P above zero, or I, J and K, were expected", "ожидалось P больше нуля или I, J и K"),
    help: Text::pair(
        "write P2. to double; negative factors are mirrors: G51.1",
        "напишите P2., чтобы удвоить; отрицательный коэффициент — это зеркальное отображение: G51.1",
    ),
};

pub(crate) fn mirrored_already(letter: char) -> Refusal {
    Refusal {
        code: codes::FRAME,
        message: both!("{letter} is mirrored already", "{letter} уже отражена"),
        label: both!("twice, or anew? controls differ", "дважды или заново? у стоек по-разному"),
        help: both!(
            "cancel the mirror with G50.1 before it",
            "отмените перед этим зеркальное отображение функцией G50.1"
        ),
    }
}

pub(crate) const MIRROR_WITHOUT_AXES: Refusal = Refusal {
    code: codes::FRAME,
    message: Text::pair("without axes", "без осей"),
    label: Text::pair("which axes are no longer mirrored?", "какие оси больше не отражать?"),
    help: Text::pair(
        "write the mirrored axes beside it, as in G50.1 X0 Y0",
        "напишите рядом отражённые оси, например G50.1 X0 Y0",
    ),
};
