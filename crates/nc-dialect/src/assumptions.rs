//! The Russian of what the shipped tables assume of their controls, and of their titles.
//!
//! As with the phrases in `russian.rs`, a text of somebody else's table is printed as it is.

use diagnostic::Text;

/// A title or an assumption of a table, in every language.
#[must_use]
pub fn assumption(phrase: &str) -> Text {
    let known = PHRASES.iter().find(|(english, _)| *english == phrase);
    known.map_or_else(|| Text::same(phrase), |(english, russian)| Text::pair(english, russian))
}

/// English and Russian, in the order in which the tables have them.
#[rustfmt::skip]
const PHRASES: &[(&str, &str)] = &[
    ("Balt-System NC-110 to NC-230", "Балт-Систем NC-110 — NC-230"),
    ("A number without a point is in millimetres or inches: numbers.without_point.", "Число без точки — в миллиметрах или дюймах: numbers.without_point."),
    ("The control starts in mm (G71), G17, G90, G94, and in the origin that the profile calls G54: start.codes.", "При включении действуют мм (G71), G17, G90, G94 и начало отсчёта, которое в профиле названо G54: start.codes."),
    ("Origins, mirrors, rotations, scales, repeats and calls in brackets are refused by name, any other command in brackets too, unless its row says otherwise: commands.", "Начала отсчёта, зеркальные отображения, повороты, масштабы, повторы и вызовы в скобках отклоняются по имени, любая другая команда в скобках — тоже, если её строка не говорит иного: commands."),
    ("Arcs are refused: whether I and J are measured from the start or from the origin depends on G90 and G91 there: codes.G2, codes.G3.", "Дуги отклоняются: от начала дуги или от нуля отсчитываются I и J, зависит там от G90 и G91: codes.G2, codes.G3."),
    ("Drilling cycles are refused: their R and Z differ from ISO 6983-1: codes.G81 and following.", "Циклы сверления отклоняются: их R и Z не такие, как в ISO 6983-1: codes.G81 и далее."),
    ("G4 pauses at the end of its block for the time that TMR= sets; no word of the block is that time, and one beside it is a motion's (NC-110 programming manual, G04): codes.G4.", "G4 даёт паузу в конце своего кадра на время, заданное TMR=; ни одно слово кадра этого времени не задаёт, а слово рядом относится к перемещению (руководство программиста NC-110, G04): codes.G4."),
    ("G27, G28 and G29 choose how corners are passed; they are no reference returns: codes.", "G27, G28 и G29 выбирают способ прохождения углов; это не выход в референтную точку: codes."),
    ("M6 brings in a tool length that no word names, and is refused: m_codes.M6.", "M6 вводит длину инструмента, которой не называет ни одно слово, и отклоняется: m_codes.M6."),
    ("M codes without a row here move no axis of the path: they pass, and a warning counts them.", "Функции M, для которых здесь нет строки, осей траектории не двигают: они пропускаются, предупреждение их считает."),
    ("A program of a lathe is known by its blocks and refused: lathe.", "Токарная программа узнаётся по кадрам и отклоняется: lathe."),
    ("Centroid CNC12, milling", "Centroid CNC12, фрезерные станки"),
    ("A length without a decimal point is in millimetres or inches: numbers.without_point.", "Длина без десятичной точки — в миллиметрах или дюймах: numbers.without_point."),
    ("The control starts in G17 G21 G54 G90 G94 G98 with G0 in force: start.codes (a machine set to inches: G20).", "При включении действуют G17 G21 G54 G90 G94 G98 и G0: start.codes (на станке, настроенном на дюймы, G20)."),
    ("; starts a comment and ( ) hold one: text.", "; начинает комментарий, ( ) его заключают: text."),
    ("A : that is first on its line makes it a comment that the operator sees (CNC12 Mill Operator's Manual, program symbols); elsewhere it is refused: text.colon.", "Знак : первым в строке делает её комментарием, который видит оператор (CNC12 Mill Operator's Manual, program symbols); в других местах он отклоняется: text.colon."),
    ("Whether K or L counts the holes of a cycle's block is not known: cycles.repeats.", "Что считает отверстия в кадре цикла, K или L, неизвестно: cycles.repeats."),
    ("M128 moves an axis by encoder counts, M333 and M334 give an axis another role (CNC12 Mill Operator's Manual, M functions): refused, the latter unless the profile declares them: m_codes.M333.", "M128 перемещает ось на отсчёты датчика, M333 и M334 меняют роль оси (CNC12 Mill Operator's Manual, M functions): отклоняются, последние — если профиль их не объявляет: m_codes.M333."),
    ("M25 moves Z to its home: m_codes.M25.", "M25 отводит Z в исходное положение: m_codes.M25."),
    ("M99 stands only at the end of a main program, which is what CAM posts write: m_codes.M99.", "M99 стоит только в конце главной программы, как её пишут постпроцессоры: m_codes.M99."),
    ("A tool change (M6) leaves X, Y and Z anywhere, unless the profile's tool_change says: m_codes.M6.", "После смены инструмента (M6) X, Y и Z могут стоять где угодно, если tool_change в профиле не говорит иного: m_codes.M6."),
    ("Fanuc, milling (0i, 16i, 18i, 30i) and look-alikes", "Fanuc, фрезерные станки (0i, 16i, 18i, 30i), и похожие стойки"),
    ("A length without a decimal point counts least increments of 0.001 mm or 0.0001 inch (IS-B, parameter 3401.0 = 0): numbers.without_point, numbers.least_increment_decimals_*.", "Длина без десятичной точки — в дискретах 0.001 мм или 0.0001 дюйма (IS-B, параметр 3401.0 = 0): numbers.without_point, numbers.least_increment_decimals_*."),
    ("The control starts in G17 G21 G54 G90 G94 G98 with G0 in force and every offset, cycle and rotation cancelled: start.codes.", "При включении действуют G17 G21 G54 G90 G94 G98 и G0, все коррекции, циклы и повороты отменены: start.codes."),
    ("I, J and K are measured from the start of the arc, G90 or G91 alike.", "I, J и K отсчитываются от начала дуги и в G90, и в G91."),
    ("The end of an arc may lie up to 0.02 mm off its radius (parameter 3410): output.arc_radius_tolerance_mm.", "Конец дуги может отходить от её радиуса до 0.02 мм (параметр 3410): output.arc_radius_tolerance_mm."),
    ("R and Z of a drilling cycle are turned into levels where they are written, and the levels hold: cycles.levels.", "R и Z цикла сверления превращаются в уровни там, где написаны, и уровни сохраняются: cycles.levels."),
    ("M98 P31000 without L calls O1000 three times: flow.packed_repeats.", "M98 P31000 без L вызывает O1000 трижды: flow.packed_repeats."),
    ("ATAN[y]/[x] lies between 0 and 360 degrees (parameter 6004.0 = 0): flow.full_circle_atan.", "ATAN[y]/[x] лежит между 0 и 360 градусами (параметр 6004.0 = 0): flow.full_circle_atan."),
    ("The unit (G20, G21) of the program before may still be in force, so that a program that states none is doubtful (B-63844EN, \"the power-off state is kept\"): start.unit.", "Единица (G20, G21) прежней программы может ещё действовать, поэтому программа без неё сомнительна (B-63844EN, «состояние при выключении сохраняется»): start.unit."),
    ("K counts the holes of a cycle's block (B-63844EN, canned cycles); L does on Haas alone, and K beside I and J is a peck there (Haas Mill Operator's Manual 96-8210, G73 and G83): cycles.repeats.", "Отверстия в кадре цикла считает K (B-63844EN, canned cycles); L — только на Haas, где K рядом с I и J — врезание (Haas Mill Operator's Manual 96-8210, G73 и G83): cycles.repeats."),
    ("G110 to G129 choose work offsets and G150 mills a pocket on Haas (96-8210), where Fanuc has polar interpolation (G112, G113) and normal direction control (G150): refused.", "На Haas G110–G129 выбирают смещения нуля, а G150 фрезерует карман (96-8210), тогда как у Fanuc это полярная интерполяция (G112, G113) и управление по нормали (G150): отклоняются."),
    ("M21 to M23 mirror axes and M128 holds the tool's tip on many machines, and are free for the builder on others: refused unless the profile declares them: m_codes.M21, m_codes.M128.", "На многих станках M21–M23 зеркально отображают оси, а M128 ведёт вершину инструмента, на других их занимает изготовитель станка: отклоняются, если профиль их не объявляет: m_codes.M21, m_codes.M128."),
    ("M codes without a row here are the machine builder's: they pass, and a warning counts them.", "Функции M, для которых здесь нет строки, — изготовителя станка: они пропускаются, предупреждение их считает."),
    ("A program of a lathe is known by its blocks and refused (B-63944EN, the same codes on the T series): lathe.", "Токарная программа узнаётся по кадрам и отклоняется (B-63944EN, те же функции в серии T): lathe."),
    ("G68.2 tilts the plane by I about Z, J about the new X, K about the new Z (P0); with Q123 by one angle about X, Y or Z (P1); by three points (P2) or two vectors (P3); the plane lies in the workpiece as with all rotary axes at 0: codes.G68.2.", "G68.2 наклоняет плоскость на I вокруг Z, J вокруг новой X, K вокруг новой Z (P0); с Q123 — на углы вокруг X, Y, Z (P1); по трём точкам (P2) или двум векторам (P3); плоскость лежит в детали, как при нулевых поворотных осях: codes.G68.2."),
    ("`G54 P1` is `G54.1 P1`, the first of the numbered work offsets; the external offset is zero: frames.p_selects_numbered.", "`G54 P1` — это `G54.1 P1`, первое из нумерованных смещений нуля; внешнее смещение равно нулю: frames.p_selects_numbered."),
    ("G52 shifts all work offsets, holds when another is chosen, and adds to the shift of G92: frames.local_is_preset.", "G52 сдвигает все смещения нуля, сохраняется при выборе другого и складывается со сдвигом G92: frames.local_is_preset."),
    ("G51 scales X, Y and Z, a P without a point counting thousandths (parameters 5400.7 = 0, 5401.0 = 1): frames.scaling_step.", "G51 масштабирует X, Y и Z, P без точки — в тысячных (параметры 5400.7 = 0, 5401.0 = 1): frames.scaling_step."),
    ("R of G68 is the whole angle, not one added to an earlier one (parameter 5400.0 = 0): codes.G68.", "R в G68 — полный угол, а не прибавка к прежнему (параметр 5400.0 = 0): codes.G68."),
    ("`,R` and `,C` are the optional corner rounding and chamfer between two lines, and G16 takes radius and angle about the program's zero in G90: flow.corner_words, codes.G16.", "`,R` и `,C` — опционные скругление и фаска между двумя прямыми, а G16 в G90 берёт радиус и угол относительно нуля программы: flow.corner_words, codes.G16."),
    ("M codes without a row here move no axis of the path.", "Функции M, для которых здесь нет строки, осей траектории не двигают."),
    ("Fanuc, lathes (0i-T, 16i-T, 18i-T, 30i-T), G-code systems A, B, C", "Fanuc, токарные станки (0i-T, 16i-T, 18i-T, 30i-T), системы функций G A, B, C"),
    ("Which of the systems A, B and C the control has (parameter 3401), and whether X is a diameter (parameter 1006.3), is said in the profile: turning.systems.", "Какая из систем A, B, C у стойки (параметр 3401) и диаметр ли X (параметр 1006.3), говорит профиль: turning.systems."),
    ("[codes] is system A; what B and C have in its place stands under turning.systems.", "[codes] — система A; что вместо этого в B и C, стоит в turning.systems."),
    ("X and U words are diameters where the profile says so, and so is the step of the output; I, K and R of arcs are radii (B-64304EN-1, Circular interpolation).", "Слова X и U — диаметры, если так говорит профиль, дискрета вывода — тоже; I, K и R дуг — радиусы (B-64304EN-1, Circular interpolation)."),
    ("The last two digits of T choose the offset (parameter 5028), which is in force from that block on: turning.offset_in_t.", "Последние две цифры T выбирают коррекцию (параметр 5028), она действует с этого кадра: turning.offset_in_t."),
    ("G50 (G92 in B and C) limits the spindle's speed with S, and says where the axes stand with X and Z: codes.G50.", "G50 (в B и C G92) с S ограничивает обороты шпинделя, а с X и Z говорит, где стоят оси: codes.G50."),
    ("The control starts in G18 G54, feed per revolution, G97, every offset and cycle cancelled: start.codes.", "При включении действуют G18 G54, подача на оборот, G97, все коррекции и циклы отменены: start.codes."),
    ("The unit (G20, G21; G70, G71 in C) of the program before may still be in force: start.unit.", "Единица (G20, G21; в C G70, G71) прежней программы может ещё действовать: start.unit."),
    ("G96 turns the spindle faster as X falls; the corrections of X, micrometres, change no speed worth a word: codes.G96.", "С G96 шпиндель вращается быстрее при меньшем X; поправки X в микрометры обороты заметно не меняют: codes.G96."),
    ("Threads (G32) are one block each, in step with the spindle, and never split; F is their lead: turning.thread_lead.", "Резьба (G32) — по одному кадру, синхронно со шпинделем, и никогда не делится; F — её шаг: turning.thread_lead."),
    ("Cycles (G90, G92, G94, G70 to G76 and their like) are written out as moves; parameters of the control that decide how they move are said in the profile.", "Циклы (G90, G92, G94, G70–G76 и подобные) расписываются движениями; параметры стойки, от которых те зависят, называет профиль."),
    ("Under G41 and G42 the programmed contour is corrected, each block staying one; radius and direction of the nose are those of the offset that T brings in: codes.G41.", "Под G41 и G42 исправляется запрограммированный контур, каждый кадр остаётся одним; радиус и положение вершины — из коррекции, которую вводит T: codes.G41."),
    ("G83 of system A drills on the axis, written out; R counts from where the cycle starts: codes.G83.", "G83 системы A сверлит по оси и расписывается движениями; R отсчитывается от начала цикла: codes.G83."),
    ("Other drilling and tapping cycles, cycles under G41 and G42, and ,C ,R A words are refused as yet.", "Другие циклы сверления и нарезания резьбы, циклы под G41 и G42, слова ,C ,R A пока отклоняются."),
    ("Haas, milling", "Haas, фрезерные станки"),
    ("A length without a decimal point counts 0.001 mm or 0.0001 inch (Setting 162, Default to Float, off): numbers.without_point.", "Длина без десятичной точки — в 0.001 мм или 0.0001 дюйма (Setting 162, Default to Float, выключен): numbers.without_point."),
    ("The control starts in G17 G40 G49 G54 G64 G80 G90 G94 G97 G98 with G0 in force; the unit is that of Setting 9, so that a program that states none is doubtful: start.codes, start.unit.", "При включении действуют G17 G40 G49 G54 G64 G80 G90 G94 G97 G98 и G0; единица — из Setting 9, поэтому программа без неё сомнительна: start.codes, start.unit."),
    ("The end of an arc may lie up to 0.02 mm off its radius: output.arc_radius_tolerance_mm.", "Конец дуги может отходить от её радиуса до 0.02 мм: output.arc_radius_tolerance_mm."),
    ("G110 to G129 are G154 P1 to P20, the same offsets under another name (Mill Operator's Manual 96-8000, G110-G129 Coordinate System #7-26): codes.G110.", "G110–G129 — это G154 P1–P20, те же смещения под другим именем (Mill Operator's Manual 96-8000, G110-G129 Coordinate System #7-26): codes.G110."),
    ("M97 P1000 calls the blocks from N1000 on, in the same program, L times; M99 returns (96-8000, M97 Local Sub-Program Call): flow.local_calls.", "M97 P1000 вызывает кадры с N1000 этой же программы L раз; M99 возвращает (96-8000, M97 Local Sub-Program Call): flow.local_calls."),
    ("L counts the holes of a cycle's block; L0 only says what the next blocks do. K beside I and J is a peck and refused (96-8210, G73 and G83): cycles.repeats.", "Отверстия в кадре цикла считает L; L0 лишь задаёт, что делают следующие кадры. K рядом с I и J — врезание и отклоняется (96-8210, G73 и G83): cycles.repeats."),
    ("M98 P31000 is a call of O31000: L alone counts calls (96-8000, M98): flow.packed_repeats.", "M98 P31000 — вызов O31000: вызовы считает только L (96-8000, M98): flow.packed_repeats."),
    ("R of G68 is the whole angle (Setting 73, G68 Incremental Angle, off); what G68 without a centre or without R does depends on where the machine stands and on Setting 72: refused.", "R в G68 — полный угол (Setting 73, G68 Incremental Angle, выключен); что делает G68 без центра или без R, зависит от положения станка и от Setting 72: отклоняется."),
    ("G12, G13 and G150 mill pockets and G70 to G72 place holes by cycles of the control: refused. G100 and G101 mirror: refused, write G51.1 where the control has it.", "G12, G13 и G150 фрезеруют карманы, а G70–G72 размещают отверстия циклами стойки: отклоняются. G100 и G101 отображают зеркально: отклоняются, напишите G51.1, если он есть в стойке."),
    ("G54 takes no P; G154 P1 to P99 are the numbered offsets: frames.p_selects_numbered.", "У G54 нет P; нумерованные смещения — G154 P1–P99: frames.p_selects_numbered."),
    ("M21 to M28 drive the user's own relays and move no axis of the path: m_codes.M21.", "M21–M28 включают реле пользователя и осей траектории не двигают: m_codes.M21."),
    ("LinuxCNC 2.8, 2.9", "LinuxCNC 2.8, 2.9"),
    ("The machine's INI file starts the interpreter in mm: start.codes (G21).", "INI-файл станка запускает интерпретатор в мм: start.codes (G21)."),
    ("The control starts in G17 G54 G90 G91.1 G94 G98 with no motion code, offset or cycle in force: start.codes.", "При включении действуют G17 G54 G90 G91.1 G94 G98, без функции движения, коррекций и циклов: start.codes."),
    ("The end of an arc may lie up to 0.0279 mm or 0.1 % of the radius off it, CENTER_ARC_RADIUS_TOLERANCE_INCH being as shipped (0.0011): output.arc_radius_tolerance_mm, output.arc_radius_tolerance_share.", "Конец дуги может отходить от радиуса до 0.0279 мм или 0.1 % радиуса, если CENTER_ARC_RADIUS_TOLERANCE_INCH заводской (0.0011): output.arc_radius_tolerance_mm, output.arc_radius_tolerance_share."),
    ("A tool change (M6) leaves X, Y and Z anywhere (TOOL_CHANGE_POSITION, remapped M6), unless the profile's tool_change says: m_codes.M6.", "После смены инструмента (M6) X, Y и Z могут стоять где угодно (TOOL_CHANGE_POSITION, переназначенный M6), если tool_change в профиле не говорит иного: m_codes.M6."),
    ("G43 without H, and with H0, takes the length of the tool in the spindle (G-code reference, G43: H0 on tool changers that are not random): tool_length.without_h.", "G43 без H и с H0 берёт длину инструмента в шпинделе (справочник по G-кодам, G43: H0 при магазине с постоянными гнёздами): tool_length.without_h."),
    ("L counts the holes of a cycle's block; K does not, and L0 is an error (G-code reference, canned cycles): cycles.repeats.", "Отверстия в кадре цикла считает L, а не K; L0 — ошибка (справочник по G-кодам, canned cycles): cycles.repeats."),
    ("Inch words may have six decimals, since the interpreter reads every digit: output.decimals_inch.", "У слов в дюймах может быть шесть знаков: интерпретатор читает каждую цифру: output.decimals_inch."),
    ("M428 to M430 switch the kinematics where the machine has several (switchable kinematics, remapped M codes): refused unless the profile declares them: m_codes.M428.", "M428–M430 переключают кинематику, если у станка их несколько (switchable kinematics, переназначенные функции M): отклоняются, если профиль их не объявляет: m_codes.M428."),
    ("User M codes (M100 to M199) move no axis of the path: they pass, and a warning counts them.", "Функции M пользователя (M100–M199) осей траектории не двигают: они пропускаются, предупреждение их считает."),
    ("LinuxCNC 2.8, 2.9 on lathes", "LinuxCNC 2.8, 2.9 на токарных станках"),
    ("X words are diameters behind G7 and radii behind G8; a program that says neither needs the profile's `x`: codes.G7.", "Слова X после G7 — диаметры, после G8 — радиусы; программе без того и другого нужен `x` в профиле: codes.G7."),
    ("The interpreter starts in G17, and arcs need G18: start.codes.", "Интерпретатор начинает с G17, а дугам нужен G18: start.codes."),
    ("A thread (G33) is one block in step with the spindle, and never split; K is its lead: turning.thread_lead.", "Резьба (G33) — один кадр синхронно со шпинделем и никогда не делится; K — её шаг: turning.thread_lead."),
    ("The thread of several passes (G76) is written out as moves; without L and E: codes.G76.", "Многопроходная резьба (G76) расписывается движениями; без L и E: codes.G76."),
    ("Under G41 and G42 the programmed contour is corrected, each block staying one: codes.G41.", "Под G41 и G42 исправляется запрограммированный контур, каждый кадр остаётся одним: codes.G41."),
    ("Cycles (G70 to G72, G73, G74, G81 to G89) are refused as yet.", "Циклы (G70–G72, G73, G74, G81–G89) пока отклоняются."),
    ("Перспектива (GOST 20999-83, ISO 6983-1)", "Перспектива (ГОСТ 20999-83, ISO 6983-1)"),
    ("Words are ASCII; comments may hold any bytes (CP1251) and are kept: nothing is decoded.", "Слова — в ASCII; комментарии могут содержать любые байты (CP1251) и сохраняются: ничего не перекодируется."),
    ("( ) and ; both mark comments; whichever the program uses is kept: text.round_brackets, text.semicolon.", "Комментарий обозначают и ( ), и ;: сохраняется то, что в программе: text.round_brackets, text.semicolon."),
    ("A length without a decimal point is in millimetres or inches; corrected words always carry a point: numbers.without_point.", "Длина без десятичной точки — в миллиметрах или дюймах; исправленные слова всегда пишутся с точкой: numbers.without_point."),
    ("The control starts in mm, G17, G90, G94 and G54 with no motion code, offset or cycle in force: start.codes.", "При включении действуют мм, G17, G90, G94 и G54, без функции движения, коррекций и циклов: start.codes."),
    ("G20 and G70 choose inches, G21 and G71 millimetres: codes.", "G20 и G70 выбирают дюймы, G21 и G71 — миллиметры: codes."),
    ("I, J and K are measured from the start of the arc, and R is taken too: output.centre_words, output.radius_word.", "I, J и K отсчитываются от начала дуги, R тоже принимается: output.centre_words, output.radius_word."),
    ("The end of an arc may lie up to 0.01 mm off its radius: output.arc_radius_tolerance_mm.", "Конец дуги может отходить от её радиуса до 0.01 мм: output.arc_radius_tolerance_mm."),
    ("Drilling cycles G81 to G89 take X, Y, R and Z like ISO 6983-1 and return with G98 and G99; where two readings of a repeated R or Z under G91 differ, the program is refused: cycles.levels.", "Циклы сверления G81–G89 берут X, Y, R и Z по ISO 6983-1 и возвращаются по G98 и G99; если повторные R или Z под G91 можно прочесть двояко, программа отклоняется: cycles.levels."),
    ("G43 and G44 take the tool length named by H: tool_length.without_h.", "G43 и G44 берут длину инструмента, названную H: tool_length.without_h."),
    ("GOST 20999-83 has G49 in the series G43 to G52 of tool offsets, later controls end the length with it: G49 is refused while a tool length is in force, and with H or D beside it: tool_length.under_g49.", "По ГОСТ 20999-83 G49 входит в ряд коррекций инструмента G43–G52, в более поздних стойках он отменяет длину: G49 отклоняется, пока действует длина инструмента, и рядом с H или D: tool_length.under_g49."),
    ("Whether G40 ends a tool length too, as GOST 20999-83 can be read, is not known: G40 is refused while one is in force and is not written again beside it: tool_length.under_g40.", "Отменяет ли G40 и длину инструмента, как можно прочесть в ГОСТ 20999-83, неизвестно: G40 отклоняется, пока она действует и не написана рядом снова: tool_length.under_g40."),
    ("G63 taps and holds for its own block (GOST 20999-83): codes.G63.", "G63 нарезает резьбу метчиком и действует в своём кадре (ГОСТ 20999-83): codes.G63."),
    ("M15 and M16 (motion + and -), M55 and M56 (shift of the tool), M61 and M62 (shift of the workpiece), M71 and M72 (turn of the workpiece) move what the program does not name (GOST 20999-83, M functions): refused unless the profile declares them: m_codes.M55.", "M15 и M16 (движение + и -), M55 и M56 (сдвиг инструмента), M61 и M62 (сдвиг детали), M71 и M72 (поворот детали) двигают то, чего программа не называет (ГОСТ 20999-83, функции M): отклоняются, если профиль их не объявляет: m_codes.M55."),
    ("G53 is refused: ISO 6983-1 makes it cancel the work offset until further notice, other controls for one block: codes.G53.", "G53 отклоняется: по ISO 6983-1 он отменяет смещение нуля до новой функции, на других стойках — на один кадр: codes.G53."),
    ("Inserted blocks carry no N number; block skip is copied to each of them: output.number_inserted_blocks.", "Вставленные кадры идут без номера N; пропуск кадра повторяется в каждом: output.number_inserted_blocks."),
    ("The control's own compensation of geometric errors is switched off: what is corrected here must not be corrected twice.", "Собственная компенсация геометрических погрешностей в стойке отключена: исправленное здесь нельзя исправлять дважды."),
    ("Sinumerik 840D and 828D, milling", "Sinumerik 840D и 828D, фрезерные станки"),
    ("The control starts in G17 G90 G94 and in millimetres (G71), in a mode without frames, transformations or tool: start.codes.", "При включении действуют G17 G90 G94 и миллиметры (G71), без фреймов, трансформаций и инструмента: start.codes."),
    ("A work offset is in force only where the program writes it: after reset the control has G500 or what MD20150 says: start.codes.", "Смещение нуля действует, только если его пишет программа: после сброса в стойке G500 или то, что в MD20150: start.codes."),
    ("I, J and K are measured from the start of the arc, `I=AC()` from the zero; CR= is the radius, negative for more than half a turn: text.long_words.", "I, J и K отсчитываются от начала дуги, `I=AC()` — от нуля; CR= — радиус, отрицательный для дуги больше полуокружности: text.long_words."),
    ("T selects, M6 changes the tool (MD22550 is 1) and may move every axis; D1 behind it brings in the profile's H of the tool's number, D0 none; which edge M6 itself brings in (MD20270) is not known unless the profile says `edge_at_change`: tool_length.edge_in_d.", "T выбирает, M6 меняет инструмент (MD22550 равен 1) и может двигать все оси; D1 после неё вводит H из профиля по номеру инструмента, D0 — никакой; какую кромку вводит сама M6 (MD20270), неизвестно, если профиль не называет `edge_at_change`: tool_length.edge_in_d."),
    ("TRANS, ROT and MIRROR take the place of all programmed frames, ATRANS, AROT and AMIRROR add to them: commands.", "TRANS, ROT и MIRROR заменяют все программируемые фреймы, ATRANS, AROT и AMIRROR к ним добавляют: commands."),
    ("R parameters and variables of DEF are executed with IF, loops and jumps to labels; comparisons beside AND and OR need brackets around each: flow.", "R-параметры и переменные DEF исполняются вместе с IF, циклами и переходами к меткам; рядом с AND и OR каждое сравнение берётся в скобки: flow."),
    ("SUPA is taken for G153, no handwheel or external shift in force: commands.SUPA.", "SUPA читается как G153, смещения маховичком и внешнего нет: commands.SUPA."),
    ("CYCLE81, CYCLE82, CYCLE83, HOLES1 and HOLES2 are written out as the moves that the Programming Manual Cycles gives them: commands.", "CYCLE81, CYCLE82, CYCLE83, HOLES1 и HOLES2 расписываются движениями по руководству Programming Manual Cycles: commands."),
    ("CYCLE832 with more than the tolerance may switch TRAORI (840D Programming Manual Cycles, CYCLE832, the digits of its second argument): commands.CYCLE832.", "CYCLE832 с чем-то кроме допуска может переключать TRAORI (840D Programming Manual Cycles, CYCLE832, цифры второго аргумента): commands.CYCLE832."),
    ("M70 makes the spindle an axis: refused unless the profile declares it: m_codes.M70.", "M70 делает шпиндель осью: отклоняется, если профиль её не объявляет: m_codes.M70."),
    ("A program of a lathe is known by its blocks (DIAMON, LIMS, G96) and refused: lathe.", "Токарная программа узнаётся по кадрам (DIAMON, LIMS, G96) и отклоняется: lathe."),
    ("The end of an arc may lie up to 0.01 mm (MD21000 CIRCLE_ERROR_CONST) or 0.1 % of the radius (MD21010 CIRCLE_ERROR_FACTOR) off it: output.arc_radius_tolerance_mm, output.arc_radius_tolerance_share.", "Конец дуги может отходить от радиуса до 0.01 мм (MD21000 CIRCLE_ERROR_CONST) или 0.1 % радиуса (MD21010 CIRCLE_ERROR_FACTOR): output.arc_radius_tolerance_mm, output.arc_radius_tolerance_share."),
    ("Dynamics (SOFT, BRISK, FFWON, G64x, compressors) change speed, and the path within their own tolerance: commands, codes.", "Динамика (SOFT, BRISK, FFWON, G64x, компрессоры) меняет скорость, а траекторию — в пределах собственного допуска: commands, codes."),
    ("Sinumerik 840D and 828D, turning, ISO subset", "Sinumerik 840D и 828D, токарные станки, подмножество ISO"),
    ("The control starts in G18 G90 G95 and in millimetres (G71), in a mode without frames, transformations or tool: start.codes.", "При включении действуют G18 G90 G95 и миллиметры (G71), без фреймов, трансформаций и инструмента: start.codes."),
    ("I, J and K are measured from the start of the arc; CR= is refused: codes, commands.CR.", "I, J и K отсчитываются от начала дуги; CR= отклоняется: codes, commands.CR."),
    ("T brings in its tool with the first edge; D1 is that edge, D0 no offset; the profile's H1 is the offset of T1: turning.offset_in_d.", "T вводит свой инструмент с первой кромкой; D1 — эта кромка, D0 — без коррекции; H1 в профиле — коррекция T1: turning.offset_in_d."),
    ("X words are diameters behind DIAMON, radii behind DIAMOF, and behind DIAM90 diameters in G90 alone; a program that says none of them needs the profile's `x`: commands.DIAMON.", "Слова X после DIAMON — диаметры, после DIAMOF — радиусы, после DIAM90 диаметры только в G90; программе без них нужен `x` в профиле: commands.DIAMON."),
    ("LIMS limits the spindle under G96: commands.LIMS.", "LIMS ограничивает шпиндель под G96: commands.LIMS."),
    ("Cycles and threads are refused as yet.", "Циклы и резьба пока отклоняются."),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_assumption_of_a_shipped_table_is_known() {
        let mut unknown = Vec::new();
        for name in crate::builtin_names() {
            let dialect = crate::builtin(name).expect("shipped");
            let said = dialect.assumptions.iter().chain([&dialect.title]);
            unknown.extend(said.filter(|text| PHRASES.iter().all(|(english, _)| english != text)));
        }
        assert!(unknown.is_empty(), "no Russian for {unknown:#?}");
    }
}
