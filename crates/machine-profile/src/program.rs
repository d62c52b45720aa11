//! How a profile has programs read, and what it says of the control.

use std::ops::Bound::{Excluded, Included};

use diagnostic::{Text, both};
use machine_model::{Axis, Chain};
use toolpath::{DrillPecks, DrillR, FlankFrom, TiltRule, TurningParameters, WholeTurns};

use crate::error::{CONFLICT, VALUE};
use crate::format::{
    self, ChangePlace, ContourCompensation, DecimalName, DrawingWords, DrillRName, FlankName, PecksName,
    ToolChange, XName,
};
use crate::loader::{Bounds, Loader, triple};
use crate::number::{Finite, Spanned};
use crate::profile::{AfterChange, BareLengths, Kinematics, LeftAlone, ProgramRules};

/// Arcs whose radii differ by more are none on any control, mm.
const MOST_ARC_TOLERANCE_MM: f64 = 10.0;
/// Parameter 5130 of Fanuc goes to 12.7 leads.
const MOST_CHAMFER_LEADS: f64 = 12.7;
/// Parameter 5131 of Fanuc.
const MOST_CHAMFER_DEG: f64 = 89.0;
/// Parameters 5133 and 5139 are clearances; more is a slip of the unit.
const MOST_ESCAPE_MM: f64 = 50.0;
/// Parameter 5121 ends there.
const MOST_RETURN_PERCENT: f64 = 2000.0;
/// Finishing passes of a thread: P of the first block has two digits for them.
const MOST_FINISHING_PASSES: f64 = 99.0;

/// Bounds of a parameter of the control, with its unit.
fn up_to((most, unit): &(f64, Text)) -> Bounds {
    Bounds {
        range: (Included(0.0), Included(*most)),
        label: both!("expected 0 to {most} {unit}", "ожидалось от 0 до {most} {unit:#}"),
        help: Text::pair(
            "give what the parameter of the control is set to",
            "укажите значение параметра стойки",
        ),
    }
}

impl Loader<'_> {
    pub(crate) fn program_rules(
        &mut self,
        document: &format::Document,
        chain: Option<&Chain>,
    ) -> ProgramRules {
        let program = &document.program;
        let bare_lengths = program.decimal.map(|name| match name {
            DecimalName::Increments => BareLengths::Increments,
            DecimalName::Millimetres => BareLengths::Millimetres,
        });
        let tool_change = program
            .tool_change
            .as_ref()
            .map_or([AfterChange::Unknown; 3], |written| self.tool_change(written));
        let harmless_m_codes = self.m_codes(&document.m_codes.harmless);
        let calls = document.calls.iter().filter_map(|(call, moves)| self.left_alone(call, moves)).collect();
        let of_arcs = Bounds {
            range: (Excluded(0.0), Included(MOST_ARC_TOLERANCE_MM)),
            label: both!(
                "expected above 0, up to {MOST_ARC_TOLERANCE_MM} mm",
                "ожидалось больше 0 и не больше {MOST_ARC_TOLERANCE_MM} мм"
            ),
            help: both!(
                "give what the control is set to (parameter 3410, CENTER_ARC_RADIUS_TOLERANCE_MM)",
                "укажите то, что задано на стойке (параметр 3410, CENTER_ARC_RADIUS_TOLERANCE_MM)"
            ),
        };
        let arc_tolerance_mm = self.number(program.arc_tolerance_mm.as_ref(), "arc_tolerance_mm", &of_arcs);
        ProgramRules {
            zero: program.zero.unwrap_or_default(),
            bare_lengths,
            tool_change,
            arc_tolerance_mm,
            edge_at_change: self.edge_at_change(program),
            t_means_h: program.t_means_h.unwrap_or_default(),
            rotary_start_deg: self.rotary_start(program, chain),
            harmless_m_codes,
            calls,
            diameters: program.x.map(|x| matches!(x, XName::Diameter)),
            g_code_system: program.g_code_system.clone(),
            turning: self.turning_rules(program),
        }
    }

    fn turning_rules(&mut self, program: &format::Program) -> TurningParameters {
        let thread_finishing_passes = self.finishing_passes(program);
        let mut number = |written: &Option<_>, name, most| self.number(written.as_ref(), name, &up_to(most));
        let mm = (MOST_ESCAPE_MM, Text::pair("mm", "мм"));
        let leads = (MOST_CHAMFER_LEADS, Text::pair("leads", "ходов"));
        let degrees = (MOST_CHAMFER_DEG, Text::pair("degrees", "градусов"));
        let percent = (MOST_RETURN_PERCENT, Text::pair("per cent", "процентов"));
        TurningParameters {
            thread_chamfer_leads: number(&program.thread_chamfer_leads, "thread_chamfer_leads", &leads),
            thread_chamfer_deg: number(&program.thread_chamfer_deg, "thread_chamfer_deg", &degrees),
            roughing_escape_mm: number(&program.roughing_escape_mm, "roughing_escape_mm", &mm),
            groove_return_mm: number(&program.groove_return_mm, "groove_return_mm", &mm),
            thread_finishing_passes,
            thread_least_mm: number(&program.thread_least_mm, "thread_least_mm", &mm),
            thread_allowance_mm: number(&program.thread_allowance_mm, "thread_allowance_mm", &mm),
            thread_flank_from: program.thread_flank_from.map(|name| match name {
                FlankName::Start => FlankFrom::Start,
                FlankName::FirstPass => FlankFrom::FirstPass,
                FlankName::LastPass => FlankFrom::LastPass,
            }),
            drill_pecks: program.drill_pecks.map(|name| match name {
                PecksName::Full => DrillPecks::Full,
                PecksName::Chip => DrillPecks::Chip,
            }),
            drill_return_mm: number(&program.drill_return_mm, "drill_return_mm", &mm),
            drill_r: program.drill_r.map(|name| match name {
                DrillRName::Place => DrillR::Place,
                DrillRName::Way => DrillR::Way,
            }),
            bore_return_percent: number(&program.bore_return_percent, "bore_return_percent", &percent),
            nose_in_finishing: matches!(program.contour_compensation, Some(ContourCompensation::Finishing)),
            plain_drawing: matches!(program.drawing_words, Some(DrawingWords::Plain)),
        }
    }

    fn finishing_passes(&mut self, program: &format::Program) -> Option<f64> {
        let written = program.thread_finishing_passes.as_ref()?;
        let Finite(passes) = *written.get_ref();
        if !(1.0..=MOST_FINISHING_PASSES).contains(&passes) || passes.fract() != 0.0 {
            let message = both!("thread_finishing_passes is {passes}", "thread_finishing_passes — {passes}");
            let label = both!(
                "expected a whole number from 1 to {MOST_FINISHING_PASSES}",
                "ожидалось целое число от 1 до {MOST_FINISHING_PASSES}"
            );
            let help =
                both!("give the control's value (parameter 5142)", "укажите значение стойки (параметр 5142)");
            self.refuse(written, VALUE, message, label, help);
        }
        Some(passes)
    }

    fn edge_at_change(&mut self, program: &format::Program) -> Option<u32> {
        let written = program.edge_at_change.as_ref()?;
        let edge = *written.get_ref();
        if edge > 1 {
            let message = both!("edge_at_change is {edge}", "edge_at_change — {edge}");
            let help = both!(
                "1 where a tool change brings in the first edge, 0 where it brings in none (MD20270)",
                "1, если смена инструмента вводит первую кромку, 0, если никакой (MD20270)"
            );
            self.refuse(written, VALUE, message, both!("expected 0 or 1", "ожидалось 0 или 1"), help);
        }
        Some(edge)
    }

    /// Axes that a tool change leaves, and where it puts the others.
    fn tool_change(&mut self, written: &Spanned<format::ToolChange>) -> [AfterChange; 3] {
        let mut change = [AfterChange::Unknown; 3];
        let (keeps, place) = match written.get_ref() {
            ToolChange::At(place) => ("", Some(ChangePlace::All(*place))),
            ToolChange::By(rules) => (rules.keeps.as_deref().unwrap_or_default(), rules.position_mm),
        };
        for axis in keeps.chars() {
            match "XYZ".find(axis) {
                Some(index) => change[index] = AfterChange::Stays,
                None => {
                    let message = both!("`{axis}` is not X, Y or Z", "`{axis}` — не X, не Y и не Z");
                    let label = both!("expected some of X, Y, Z", "ожидались какие-то из X, Y, Z");
                    let help = both!(
                        "name the axes that stay where they were, like keeps = \"XYZ\"",
                        "назовите оси, которые остаются на месте, например keeps = \"XYZ\""
                    );
                    self.refuse(written, VALUE, message, label, help);
                }
            }
        }
        let place = match place {
            None => [None; 3],
            Some(ChangePlace::All(place)) => place.map(Some),
            Some(ChangePlace::Some(format::ChangeAxes { X, Y, Z })) => [X, Y, Z],
        };
        for (axis, (change, place)) in "XYZ".chars().zip(change.iter_mut().zip(place)) {
            let Some(Finite(place_mm)) = place else { continue };
            if *change == AfterChange::Stays {
                let message = both!(
                    "a tool change both keeps {axis} and brings it to {place_mm} mm",
                    "смена инструмента и оставляет {axis} на месте, и выводит её в {place_mm} мм"
                );
                let label = both!("this tool change", "эта смена инструмента");
                let help = both!(
                    "name the axis under `keeps` or under `position_mm`",
                    "назовите ось в `keeps` или в `position_mm`"
                );
                self.refuse(written, CONFLICT, message, label, help);
            }
            *change = AfterChange::At(place_mm);
        }
        change
    }

    fn rotary_start(&mut self, program: &format::Program, chain: Option<&Chain>) -> [Option<f64>; 3] {
        let mut start_deg = [None; 3];
        for (name, written) in &program.rotary_start {
            let label = both!("no such axis", "такой оси нет");
            let help = both!("remove it, or name it in `chain`", "уберите её или назовите в `chain`");
            if let Some(axis) = self.rotary_named(chain, name, written, label, help) {
                start_deg[axis] = Some(written.get_ref().0);
            }
        }
        start_deg
    }

    pub(crate) fn kinematics(
        &mut self,
        written: &Spanned<format::Kinematics>,
        chain: Option<&Chain>,
    ) -> Option<Kinematics> {
        let section = written.get_ref();
        if *section.straight.get_ref() == format::StraightName::Axes {
            let message = both!(
                "a control that leads the axes straight, not the tip",
                "стойка, которая ведёт по прямой оси, а не вершину"
            );
            let label = both!("expected \"tip\"", "ожидалось \"tip\"");
            let help = both!(
                "what the tip does between the ends of a block is another path then: leave the section out and post without tool centre point control",
                "тогда между концами кадра вершина идёт другим путём: уберите раздел и выводите без управления по вершине инструмента"
            );
            self.refuse(&section.straight, VALUE, message, label, help);
        }
        let axes: Vec<Axis> = chain?.axes().filter(|axis| !axis.is_linear()).collect();
        let mut centres_mm = [None; 3];
        for (name, centre) in &section.centres_mm {
            let label = both!("this centre", "этот центр");
            let help = both!(
                "give a centre for each rotary axis, like C = [0, 0, 0]",
                "дайте центр каждой поворотной оси, например C = [0, 0, 0]"
            );
            if let Some(axis) = self.rotary_named(chain, name, centre, label, help) {
                centres_mm[axis] = Some(triple(Some(*centre.get_ref())));
            }
        }
        for axis in axes.iter().filter(|axis| centres_mm[axis.direction()].is_none()) {
            let letter = axis.letter();
            let message = both!(
                "the control's centre of {letter} is missing",
                "нет центра {letter}, который держит стойка"
            );
            let help = both!(
                "add {letter} = [X, Y, Z] to centres_mm: as the control has it in its parameters, which need not be where the axis is",
                "добавьте {letter} = [X, Y, Z] в centres_mm: так, как он записан в параметрах стойки, хотя бы ось была и не там"
            );
            self.refuse(written, VALUE, message, both!("this section", "этот раздел"), help);
        }
        let [on, off] = [&section.on, &section.off].map(|codes| self.m_codes(codes));
        if let Some(both) =
            section.on.iter().zip(&on).find_map(|(code, number)| off.contains(number).then_some(code))
        {
            let message = both!("{} switches on and off", "{} и включает, и выключает", both.get_ref());
            let help = both!("name each M code once", "назовите каждую функцию M один раз");
            self.refuse(both, VALUE, message, both!("also under `off`", "она же в `off`"), help);
        }
        let branch = section.branch.as_ref().and_then(|written| self.branch(written, &axes));
        let turns = section.turn.map(|turn| match turn {
            format::TurnName::Shortest => WholeTurns::Shortest,
            format::TurnName::Principal => WholeTurns::Principal,
        });
        let reference = section.direction_reference.as_ref().and_then(|written| {
            let help = both!(
                "name the axis whose angle `_DIR` of CYCLE800 asks for, like \"A\"",
                "назовите ось, об угле которой говорит `_DIR` функции CYCLE800, например \"A\""
            );
            self.rotary_named(chain, written.get_ref(), written, both!("this axis", "эта ось"), help)
        });
        Some(Kinematics {
            centres_mm: centres_mm.map(Option::unwrap_or_default),
            tilt_rule: TiltRule { branch, turns, reference },
            great_circle: section.vectors.map(|vectors| matches!(vectors, format::VectorsName::GreatCircle)),
            at_start: section.at_start,
            on,
            off,
        })
    }

    /// The rotary axis of a branch, and whether its angle is above zero there.
    fn branch(&mut self, written: &Spanned<String>, axes: &[Axis]) -> Option<(usize, bool)> {
        let axis = |letter: char| axes.iter().find(|axis| axis.letter() == letter);
        let mut letters = written.get_ref().chars();
        match (letters.next().and_then(axis), letters.next(), letters.next()) {
            (Some(axis), Some(sign @ ('+' | '-')), None) => Some((axis.direction(), sign == '+')),
            _ => {
                let message = both!("`{}` is no branch", "`{}` — не ветвь", written.get_ref());
                let help = both!(
                    "name a rotary axis of the chain and its sign where the tool has been turned to a tilted plane, like \"A+\"",
                    "назовите поворотную ось цепи и её знак, когда инструмент повёрнут к наклонной плоскости, например \"A+\""
                );
                self.refuse(written, VALUE, message, both!("this branch", "эта ветвь"), help);
                None
            }
        }
    }

    /// Of A, B, C the rotary axis of the chain with this letter; one that the chain lacks is refused.
    fn rotary_named<T>(
        &mut self,
        chain: Option<&Chain>,
        name: &str,
        at: &Spanned<T>,
        label: Text,
        help: Text,
    ) -> Option<usize> {
        let mut axes = chain.into_iter().flat_map(Chain::axes).filter(|axis| !axis.is_linear());
        let named = axes.find(|axis| name.chars().eq([axis.letter()]));
        if named.is_none() {
            let message =
                both!("`{name}` is no rotary axis of the chain", "`{name}` — не поворотная ось цепи");
            self.refuse(at, VALUE, message, label, help);
        }
        named.map(|axis| axis.direction())
    }

    /// Numbers of M codes; what is none is refused.
    fn m_codes(&mut self, written: &[Spanned<String>]) -> Vec<u16> {
        let mut numbers = Vec::with_capacity(written.len());
        for code in written {
            match code.get_ref().strip_prefix(['M', 'm']).and_then(|digits| digits.parse().ok()) {
                Some(number) => numbers.push(number),
                None => {
                    let message = both!("`{}` is no M code", "`{}` — не функция M", code.get_ref());
                    let label = both!("expected an M code", "ожидалась функция M");
                    let help = both!(
                        "write the letter and its number, like \"M777\"",
                        "напишите букву и номер, например \"M777\""
                    );
                    self.refuse(code, VALUE, message, label, help);
                }
            }
        }
        numbers
    }

    fn left_alone(&mut self, call: &str, moves: &Spanned<format::Moves>) -> Option<LeftAlone> {
        let mut unknown = [false; 6];
        let axes = match moves.get_ref() {
            format::Moves::Nothing(_) => "",
            format::Moves::Some(some) => some.unknown.as_str(),
        };
        let axis = |letter| "XYZABC".find(letter);
        let all = axes.chars().all(|letter| axis(letter).is_some());
        axes.chars().filter_map(axis).for_each(|at| unknown[at] = true);
        let (code, program) =
            call.split_once(' ').map_or((call, None), |(code, program)| (code, Some(program)));
        let number = |text: &str, letter| text.strip_prefix(letter)?.parse::<u32>().ok();
        let letter = code.chars().next().filter(|letter| matches!(letter, 'G' | 'M'));
        let tenths = letter.and_then(|letter| u16::try_from(number(code, letter)?.checked_mul(10)?).ok());
        let program = program.map(|program| number(program, 'P'));
        if let (Some(letter), Some(tenths), true, None | Some(Some(_))) = (letter, tenths, all, program) {
            return Some(LeftAlone { letter, tenths, program: program.flatten(), unknown });
        }
        let message = both!("`{call}` under [calls] is not understood", "`{call}` в [calls] непонятно");
        let help = both!(
            "write a call and axes, like `\"G65 P9810\" = {{ unknown = \"XYZ\" }}`, or `\"M200\" = \"harmless\"`",
            "напишите вызов и оси, например `\"G65 P9810\" = {{ unknown = \"XYZ\" }}` или `\"M200\" = \"harmless\"`"
        );
        let label = both!(
            "a code with its number, and letters of X Y Z A B C",
            "функция с номером и буквы из X Y Z A B C"
        );
        self.refuse(moves, VALUE, message, label, help);
        None
    }
}
