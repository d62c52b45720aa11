//! From TOML text to a checked [`Profile`].

use std::collections::BTreeSet;

use diagnostic::{Diagnostic, Speaks, Text, both, of_system};
use machine_model::effects::EffectTerm;
use machine_model::{
    Axis, Chain, Description, EngineId, Interpolation, LinearAxis, Range, RigidBody, RotaryAxis, Singularity,
    Squareness, Tilt, Traverse, Vector,
};
use toml::Spanned;
use toolpath::{TiltRule, WholeTurns};
use units::{Angle, Length};

use crate::error::{CHAIN, CONFLICT, EFFECT, FILE, FORMAT, KEY, ProfileError, TILT, VALUE, span};
use crate::field::Around;
use crate::format::{
    self, ChangePlace, ContourCompensation, DecimalName, Document, DrawingWords, DrillRName, FlankName,
    InterpolationName, OutsideName, PecksName, ToolChange, XName,
};
use crate::number::{Finite, Length as WrittenLength};
use crate::profile::{
    AfterChange, BareLengths, Calibrated, CorrectionOptions, EffectEntry, FlankFrom, Kinematics, LeftAlone,
    MeasuringFrame, Outside, Profile, ProgramRules, TurningRules,
};
use crate::tables::{ErrorRows, error_rows, traverse};
use crate::toml_error;

/// Gives the bytes of a file by the path the profile uses.
pub type Read<'r> = &'r dyn Fn(&str) -> std::io::Result<Vec<u8>>;

/// Reads a profile. Paths of tables are handed to `read` as they are written: it resolves them against
/// the profile's place.
///
/// # Errors
/// Everything found wrong, VP0301 to VP0311, with spans into the profile or the table named.
pub fn load(text: &str, read: Read<'_>) -> Result<Profile, Vec<ProfileError>> {
    let document: Document =
        toml::from_str(text).map_err(|e| vec![ProfileError::profile(toml_error::diagnostic(text, &e))])?;
    let mut loader = Loader { read, errors: Vec::new() };
    let profile = loader.profile(document);
    match profile {
        Some(profile) if loader.errors.is_empty() => Ok(profile),
        _ => Err(loader.errors),
    }
}

pub(crate) struct Loader<'r> {
    read: Read<'r>,
    pub(crate) errors: Vec<ProfileError>,
}

fn triple(values: Option<[Finite; 3]>) -> [f64; 3] {
    values.map_or([0.0; 3], |v| v.map(|Finite(v)| v))
}

fn vector(values: Option<[Finite; 3]>) -> Vector {
    triple(values).into()
}

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
static MM: Text = Text::pair("mm", "мм");
/// Finishing passes of a thread: P of the first block has two digits for them.
const MOST_FINISHING_PASSES: f64 = 99.0;
/// No control of a machine whose errors are worth correcting has a coarser step, mm; a resolution in µm would be.
const COARSEST_MM: f64 = 0.1;
/// No rotary axis of a machine tool has so much play: a fifth of a degree, in µrad.
const MOST_BACKLASH_URAD: f64 = 3500.0;
/// The finest step that decimals are counted for, mm.
const FINEST_MM: f64 = 1e-6;
/// The Y that a lathe does not have stands at 0; so far it may be named.
const STANDING_MM: f64 = 1.0;

impl Loader<'_> {
    pub(crate) fn refuse<T>(&mut self, at: &Spanned<T>, diagnostic: Diagnostic, label: Text) {
        self.errors.push(ProfileError::profile(diagnostic.at(span(&at.span()), label)));
    }

    fn profile(&mut self, document: Document) -> Option<Profile> {
        if *document.format.get_ref() != 1 {
            let message = both!(
                "format {} of the profile is not known",
                "формат профиля {} неизвестен",
                document.format.get_ref()
            );
            let diagnostic = Diagnostic::error(FORMAT, message).help(both!(
                "write format = 1, or use a newer vpost",
                "напишите format = 1 или возьмите vpost новее"
            ));
            self.refuse(&document.format, diagnostic, both!("expected 1", "ожидалось 1"));
            return None;
        }
        let lathe_chain = self.lathe_chain(&document);
        let is_lathe = lathe_chain.is_some();
        let lathe = is_lathe.then(|| self.lathe(&document));
        let written = lathe_chain.as_ref().unwrap_or(document.chain.get_ref());
        let chain = match Chain::parse(written) {
            Ok(chain) => Some(chain),
            Err(e) => {
                let diagnostic = Diagnostic::error(CHAIN, e.text()).help(both!(
                    "write the axes from workpiece (w) to tool (t), b for the bed, like \"[w X Y b Z t]\"",
                    "напишите оси от детали (w) к инструменту (t), станина — b, например \"[w X Y b Z t]\""
                ));
                self.refuse(&document.chain, diagnostic, both!("this chain", "эта цепь"));
                None
            }
        };
        let interpolation = match document.interpolation {
            InterpolationName::Linear => Interpolation::Linear,
            InterpolationName::Monotone => Interpolation::Monotone,
        };
        let control = self.control(document.control.as_ref());
        let calibrated = document.calibrated.as_ref().map(|c| self.calibrated(c));
        let mut rows: [Option<ErrorRows>; 3] = [None, None, None];
        let mut resolution_mm = [0.001; 3];
        let axes = &document.axis;
        let mut linear = Vec::new();
        for (axis, written) in Axis::ALL.into_iter().zip([&axes.X, &axes.Y, &axes.Z]) {
            if is_lathe && axis == Axis::Y && written.is_none() {
                // It has no words that rounding could move it by.
                resolution_mm[1] = FINEST_MM;
                linear.push(Some(LinearAxis::perfect(Range { low: -STANDING_MM, high: STANDING_MM })));
                continue;
            }
            linear.push(self.linear(axis, written.as_ref(), interpolation, &mut rows, &mut resolution_mm));
        }
        let mut resolution_deg = [0.001; 3];
        let rotary = self.rotary(&document, chain.as_ref(), interpolation, &mut resolution_deg);
        let squareness = self.squareness(&document.squareness);
        let traverses = document.tracker.as_ref().and_then(|tracker| self.traverses(tracker));
        let mut tools = self.tools(&document.tool);
        let tool_names = self.tool_names(&document.tool, &tools);
        let cutter_radii_mm = self.cutter_radii(&document);
        let gauge_point_mm = self.gauge_point(&document, is_lathe);
        let has_rotary = [Axis::A, Axis::B, Axis::C]
            .map(|axis| chain.as_ref().is_some_and(|chain| chain.axes().any(|own| own == axis)));
        let (work_offsets, zeros) = self.work_offsets(&document.work_offsets_mm, has_rotary);
        let correction = self.correction(&document.correction);
        let program = self.program_rules(&document, chain.as_ref());
        let kinematics =
            document.kinematics.as_ref().and_then(|written| self.kinematics(written, chain.as_ref()));
        let effects = self.effects(&document.effect);
        let setup = MeasuringFrame {
            shift_mm: triple(document.setup.shift_mm),
            rotation_rad: triple(document.setup.rotation_urad).map(|v| Angle::from_urad(v).rad()),
        };
        let linear: [LinearAxis; 3] = linear.into_iter().collect::<Option<Vec<_>>>()?.try_into().ok()?;
        let field = document.field.as_ref().and_then(|written| {
            let turning = if is_lathe {
                Some(both!("a spindle", "шпиндель"))
            } else {
                rotary_axes(chain.as_ref())
            };
            let around = Around {
                travel_mm: linear.each_ref().map(|axis| axis.travel_mm),
                default_tool_mm: triple(document.tool.default_mm),
                noise_um: None,
            };
            self.field(written, turning, around)
        });
        let description = Description { chain: chain?, linear, rotary, squareness };
        let lathe = lathe.map(|mut parts| {
            parts.noses = self.noses(&document.tool, &mut tools);
            parts.stations = self.stations(&document.tool, &tools);
            parts
        });
        let rigid_body = match RigidBody::new(description.clone()) {
            Ok(model) => model,
            Err(e) => {
                let at = [&axes.X, &axes.Y, &axes.Z][Axis::from_letter(e.axis)?.direction()].as_ref()?;
                let diagnostic = Diagnostic::error(CONFLICT, e.text()).help(both!(
                    "travel_mm and the tables' position_mm are both machine coordinates",
                    "и travel_mm, и position_mm таблиц — координаты станка"
                ));
                self.refuse(at, diagnostic, both!("this axis", "эта ось"));
                return None;
            }
        };
        Some(Profile {
            name: document.name,
            control_at: document.control.as_ref().map(|control| span(&control.span())),
            control: control.dialect,
            blending_mm: control.blending_mm,
            calibrated,
            description,
            resolution_mm,
            resolution_deg,
            interpolation,
            rows,
            traverses,
            field,
            default_tool_mm: triple(document.tool.default_mm),
            gauge_point_mm,
            tool_names,
            cutter_radii_mm,
            tools,
            work_offsets,
            zeros,
            lengths_touched_at_mm: document.tool.touched_at_mm.map(|place| triple(Some(place))),
            correction,
            program,
            kinematics,
            effects,
            setup,
            lathe,
            rigid_body,
        })
    }

    fn calibrated(&mut self, written: &format::Calibrated) -> Calibrated {
        if let Some(date) = &written.date
            && !is_date(date.get_ref())
        {
            let diagnostic =
                Diagnostic::error(VALUE, both!("`{}` is not a date", "`{}` — не дата", date.get_ref())).help(
                    both!(
                        "write year-month-day, like \"2023-05-15\"",
                        "напишите год-месяц-день, например \"2023-05-15\""
                    ),
                );
            self.refuse(date, diagnostic, both!("expected year-month-day", "ожидалось год-месяц-день"));
        }
        for (name, given) in
            [("repeatability_um", &written.repeatability_um), ("uncertainty_um", &written.uncertainty_um)]
        {
            if let Some(given) = given
                && given.get_ref().0 < 0.0
            {
                let diagnostic =
                    Diagnostic::error(VALUE, both!("{name} is {}", "{name} — {}", given.get_ref().0));
                self.refuse(given, diagnostic, both!("expected 0 or more", "ожидалось 0 или больше"));
            }
        }
        let number = |given: &Option<Spanned<Finite>>| given.as_ref().map(|v| v.get_ref().0);
        Calibrated {
            repeatability_um: number(&written.repeatability_um),
            uncertainty_um: number(&written.uncertainty_um),
            date: written.date.as_ref().map(|d| d.get_ref().clone()),
            temperature_c: written.temperature_c.map(|Finite(t)| t),
            instrument: written.instrument.clone(),
        }
    }

    /// Numbers of M codes; what is none is refused.
    fn m_codes(&mut self, written: &[Spanned<String>]) -> Vec<u16> {
        let mut numbers = Vec::with_capacity(written.len());
        for code in written {
            match code.get_ref().strip_prefix(['M', 'm']).and_then(|digits| digits.parse().ok()) {
                Some(number) => numbers.push(number),
                None => {
                    let diagnostic = Diagnostic::error(
                        VALUE,
                        both!("`{}` is no M code", "`{}` — не функция M", code.get_ref()),
                    )
                    .help(both!(
                        "write the letter and its number, like \"M777\"",
                        "напишите букву и номер, например \"M777\""
                    ));
                    self.refuse(code, diagnostic, both!("expected an M code", "ожидалась функция M"));
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
        self.refuse(moves, Diagnostic::error(VALUE, message).help(help), label);
        None
    }

    fn kinematics(
        &mut self,
        written: &Spanned<format::Kinematics>,
        chain: Option<&Chain>,
    ) -> Option<Kinematics> {
        let section = written.get_ref();
        if *section.straight.get_ref() == format::StraightName::Axes {
            let diagnostic = Diagnostic::error(VALUE, both!("a control that leads the axes straight, not the tip", "стойка, которая ведёт по прямой оси, а не вершину"))
                .help(both!("what the tip does between the ends of a block is another path then: leave the section out and post without tool centre point control", "тогда между концами кадра вершина идёт другим путём: уберите раздел и выводите без управления по вершине инструмента"));
            self.refuse(&section.straight, diagnostic, both!("expected \"tip\"", "ожидалось \"tip\""));
        }
        let axes: Vec<Axis> = chain?.axes().filter(|axis| !axis.is_linear()).collect();
        let mut centres_mm = [None; 3];
        for (name, centre) in &section.centres_mm {
            match axes.iter().find(|axis| name.len() == 1 && name.starts_with(axis.letter())) {
                Some(axis) => centres_mm[axis.direction()] = Some(triple(Some(*centre.get_ref()))),
                None => {
                    let diagnostic = Diagnostic::error(
                        VALUE,
                        both!("`{name}` is no rotary axis of the chain", "`{name}` — не поворотная ось цепи"),
                    )
                    .help(both!(
                        "give a centre for each rotary axis, like C = [0, 0, 0]",
                        "дайте центр каждой поворотной оси, например C = [0, 0, 0]"
                    ));
                    self.refuse(centre, diagnostic, both!("this centre", "этот центр"));
                }
            }
        }
        for axis in axes.iter().filter(|axis| centres_mm[axis.direction()].is_none()) {
            let letter = axis.letter();
            let diagnostic = Diagnostic::error(VALUE, both!("the control's centre of {letter} is missing", "нет центра {letter}, который держит стойка"))
                .help(both!("add {letter} = [X, Y, Z] to centres_mm: as the control has it in its parameters, which need not be where the axis is", "добавьте {letter} = [X, Y, Z] в centres_mm: так, как он записан в параметрах стойки, хотя бы ось была и не там"));
            self.refuse(written, diagnostic, both!("this section", "этот раздел"));
        }
        let [on, off] = [&section.on, &section.off].map(|codes| self.m_codes(codes));
        if let Some(both) =
            section.on.iter().zip(&on).find_map(|(code, number)| off.contains(number).then_some(code))
        {
            let diagnostic = Diagnostic::error(
                VALUE,
                both!("{} switches on and off", "{} и включает, и выключает", both.get_ref()),
            )
            .help(both!("name each M code once", "назовите каждую функцию M один раз"));
            self.refuse(both, diagnostic, both!("also under `off`", "она же в `off`"));
        }
        let branch = section.branch.as_ref().and_then(|written| {
            let axis = |letter: char| axes.iter().find(|axis| axis.letter() == letter);
            let mut letters = written.get_ref().chars();
            match (letters.next().and_then(axis), letters.next(), letters.next()) {
                (Some(axis), Some(sign @ ('+' | '-')), None) => Some((axis.direction(), sign == '+')),
                _ => {
                    let message = both!("`{}` is no branch", "`{}` — не ветвь", written.get_ref());
                    let diagnostic = Diagnostic::error(VALUE, message)
                        .help(both!("name a rotary axis of the chain and its sign where the tool has been turned to a tilted plane, like \"A+\"", "назовите поворотную ось цепи и её знак, когда инструмент повёрнут к наклонной плоскости, например \"A+\""));
                    self.refuse(written, diagnostic, both!("this branch", "эта ветвь"));
                    None
                }
            }
        });
        let turns = section.turn.map(|turn| match turn {
            format::TurnName::Shortest => WholeTurns::Shortest,
            format::TurnName::Principal => WholeTurns::Principal,
        });
        let reference = section.direction_reference.as_ref().and_then(|written| {
            let named = axes.iter().find(|axis| written.get_ref().chars().eq([axis.letter()]));
            if named.is_none() {
                let message = both!(
                    "`{}` is no rotary axis of the chain",
                    "`{}` — не поворотная ось цепи",
                    written.get_ref()
                );
                let diagnostic = Diagnostic::error(VALUE, message).help(both!(
                    "name the axis whose angle `_DIR` of CYCLE800 asks for, like \"A\"",
                    "назовите ось, об угле которой говорит `_DIR` функции CYCLE800, например \"A\""
                ));
                self.refuse(written, diagnostic, both!("this axis", "эта ось"));
            }
            named.map(|axis| axis.direction())
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

    fn program_rules(&mut self, document: &format::Document, chain: Option<&Chain>) -> ProgramRules {
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
        let mut arc_tolerance_mm = None;
        if let Some(written) = &program.arc_tolerance_mm {
            let Finite(mm) = *written.get_ref();
            if mm > 0.0 && mm <= MOST_ARC_TOLERANCE_MM {
                arc_tolerance_mm = Some(mm);
            } else {
                let message = both!("arc_tolerance_mm is {mm}", "arc_tolerance_mm — {mm}");
                let help = both!(
                    "give what the control is set to (parameter 3410, CENTER_ARC_RADIUS_TOLERANCE_MM)",
                    "укажите то, что задано на стойке (параметр 3410, CENTER_ARC_RADIUS_TOLERANCE_MM)"
                );
                let diagnostic = Diagnostic::error(VALUE, message).help(help);
                self.refuse(
                    written,
                    diagnostic,
                    both!(
                        "expected above 0, up to {MOST_ARC_TOLERANCE_MM} mm",
                        "ожидалось больше 0 и не больше {MOST_ARC_TOLERANCE_MM} мм"
                    ),
                );
            }
        }
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

    fn turning_rules(&mut self, program: &format::Program) -> TurningRules {
        let thread_finishing_passes = self.finishing_passes(program);
        let mut number = |written: &Option<Spanned<Finite>>, name: &str, most: f64, unit: &Text| {
            let written = written.as_ref()?;
            let Finite(value) = *written.get_ref();
            if (0.0..=most).contains(&value) {
                return Some(value);
            }
            let diagnostic =
                Diagnostic::error(VALUE, both!("{name} is {value}", "{name} — {value}")).help(both!(
                    "give what the parameter of the control is set to",
                    "укажите значение параметра стойки"
                ));
            self.refuse(
                written,
                diagnostic,
                both!("expected 0 to {most} {unit}", "ожидалось от 0 до {most} {unit:#}"),
            );
            None
        };
        TurningRules {
            thread_chamfer_leads: number(
                &program.thread_chamfer_leads,
                "thread_chamfer_leads",
                MOST_CHAMFER_LEADS,
                &Text::pair("leads", "ходов"),
            ),
            thread_chamfer_deg: number(
                &program.thread_chamfer_deg,
                "thread_chamfer_deg",
                MOST_CHAMFER_DEG,
                &Text::pair("degrees", "градусов"),
            ),
            roughing_escape_mm: number(
                &program.roughing_escape_mm,
                "roughing_escape_mm",
                MOST_ESCAPE_MM,
                &MM,
            ),
            groove_return_mm: number(&program.groove_return_mm, "groove_return_mm", MOST_ESCAPE_MM, &MM),
            thread_finishing_passes,
            thread_least_mm: number(&program.thread_least_mm, "thread_least_mm", MOST_ESCAPE_MM, &MM),
            thread_allowance_mm: number(
                &program.thread_allowance_mm,
                "thread_allowance_mm",
                MOST_ESCAPE_MM,
                &MM,
            ),
            thread_flank_from: program.thread_flank_from.map(|name| match name {
                FlankName::Start => FlankFrom::Start,
                FlankName::FirstPass => FlankFrom::FirstPass,
                FlankName::LastPass => FlankFrom::LastPass,
            }),
            drill_chips: program.drill_pecks.map(|name| matches!(name, PecksName::Chip)),
            drill_return_mm: number(&program.drill_return_mm, "drill_return_mm", MOST_ESCAPE_MM, &MM),
            drill_r_is_place: program.drill_r.map(|name| matches!(name, DrillRName::Place)),
            bore_return_percent: number(
                &program.bore_return_percent,
                "bore_return_percent",
                MOST_RETURN_PERCENT,
                &Text::pair("per cent", "процентов"),
            ),
            nose_in_finishing: matches!(program.contour_compensation, Some(ContourCompensation::Finishing)),
            plain_drawing: matches!(program.drawing_words, Some(DrawingWords::Plain)),
        }
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
                    let diagnostic = Diagnostic::error(
                        VALUE,
                        both!("`{axis}` is not X, Y or Z", "`{axis}` — не X, не Y и не Z"),
                    )
                    .help(both!(
                        "name the axes that stay where they were, like keeps = \"XYZ\"",
                        "назовите оси, которые остаются на месте, например keeps = \"XYZ\""
                    ));
                    self.refuse(
                        written,
                        diagnostic,
                        both!("expected some of X, Y, Z", "ожидались какие-то из X, Y, Z"),
                    );
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
                let diagnostic = Diagnostic::error(
                    CONFLICT,
                    both!(
                        "a tool change both keeps {axis} and brings it to {place_mm} mm",
                        "смена инструмента и оставляет {axis} на месте, и выводит её в {place_mm} мм"
                    ),
                )
                .help(both!(
                    "name the axis under `keeps` or under `position_mm`",
                    "назовите ось в `keeps` или в `position_mm`"
                ));
                self.refuse(written, diagnostic, both!("this tool change", "эта смена инструмента"));
            }
            *change = AfterChange::At(place_mm);
        }
        change
    }

    /// The bytes of a table; an error where it cannot be read.
    pub(crate) fn file(&mut self, name: &Spanned<String>) -> Option<Vec<u8>> {
        match (self.read)(name.get_ref()) {
            Ok(bytes) => Some(bytes),
            Err(e) => {
                let diagnostic = Diagnostic::error(
                    FILE,
                    both!(
                        "cannot read the table {}: {}",
                        "таблица {} не читается: {:#}",
                        name.get_ref(),
                        of_system(&e)
                    ),
                )
                .help(both!(
                    "paths are relative to the profile's own folder",
                    "пути считаются от папки профиля"
                ));
                self.refuse(name, diagnostic, both!("named here", "названа здесь"));
                None
            }
        }
    }

    /// The result, or its error put on the list.
    pub(crate) fn keep<T>(&mut self, result: Result<T, Box<ProfileError>>) -> Option<T> {
        result.map_err(|e| self.errors.push(*e)).ok()
    }

    fn table(&mut self, name: Option<&Spanned<String>>, axis: Axis) -> Option<ErrorRows> {
        let name = name?;
        let bytes = self.file(name)?;
        self.keep(error_rows(name.get_ref(), &bytes, axis))
    }

    /// Lower and upper end, in order.
    fn range(&mut self, written: &Spanned<[Finite; 2]>, what: &Text) -> Option<Range> {
        let [Finite(low), Finite(high)] = *written.get_ref();
        if low < high {
            return Some(Range { low, high });
        }
        let diagnostic = Diagnostic::error(
            VALUE,
            both!("{what} runs from {low} to {high}", "{what:#}: от {low} до {high}"),
        )
        .help(both!(
            "write the lower end first: [{high}, {low}]",
            "напишите сначала нижний конец: [{high}, {low}]"
        ));
        self.refuse(
            written,
            diagnostic,
            both!("the lower end must lie below the upper", "нижний конец должен быть меньше верхнего"),
        );
        None
    }

    /// Refuses tables of one direction without those of the other, and play that is said twice.
    fn both_directions(
        &mut self,
        axis: Axis,
        has_errors: bool,
        negative: Option<&Spanned<String>>,
        backlash: Option<(&Spanned<Finite>, &str)>,
    ) {
        let Some(negative) = negative else { return };
        if !has_errors {
            let diagnostic = Diagnostic::error(
                CONFLICT,
                both!(
                    "axis {axis} has errors_negative, but no errors",
                    "у оси {axis} есть errors_negative, а errors нет"
                ),
            )
            .help(both!(
                "errors is the table of the positive direction; a table for both directions is errors alone",
                "errors — таблица движения в плюс; таблица для обоих направлений — одно errors"
            ));
            self.refuse(
                negative,
                diagnostic,
                both!("the other direction is missing", "нет другого направления"),
            );
        }
        if let Some((backlash, key)) = backlash {
            let message = both!(
                "axis {axis} has both errors_negative and {key}",
                "у оси {axis} и errors_negative, и {key}"
            );
            let diagnostic = Diagnostic::error(CONFLICT, message).help(both!(
                "two tables already hold the reversal value: leave {key} out",
                "погрешность реверса уже есть в двух таблицах: уберите {key}"
            ));
            self.refuse(backlash, diagnostic, both!("counted twice", "учтено дважды"));
        }
    }

    fn linear(
        &mut self,
        axis: Axis,
        written: Option<&Spanned<format::LinearAxis>>,
        interpolation: Interpolation,
        rows: &mut [Option<ErrorRows>; 3],
        resolution_mm: &mut [f64; 3],
    ) -> Option<LinearAxis> {
        let Some(spanned) = written else {
            let diagnostic = Diagnostic::error(
                KEY,
                both!("the profile lacks [axis.{axis}]", "в профиле нет [axis.{axis}]"),
            )
            .help(both!(
                "add [axis.{axis}] with travel_mm = [lowest, highest]",
                "добавьте [axis.{axis}] с travel_mm = [наименьшее, наибольшее]"
            ));
            self.errors.push(ProfileError::profile(diagnostic));
            return None;
        };
        let index = axis.direction();
        let data = spanned.get_ref();
        if let Some(step) = &data.resolution_mm {
            let Finite(value) = *step.get_ref();
            resolution_mm[index] = value;
            if value <= 0.0 || value > COARSEST_MM {
                let diagnostic = Diagnostic::error(
                    VALUE,
                    both!("resolution_mm of {axis} is {value}", "resolution_mm оси {axis} — {value}"),
                )
                .help(both!(
                    "write the smallest step the control takes, like 0.001",
                    "напишите наименьшую дискрету стойки, например 0.001"
                ));
                self.refuse(
                    step,
                    diagnostic,
                    both!(
                        "expected a number above 0, at most {COARSEST_MM}",
                        "ожидалось число больше 0 и не больше {COARSEST_MM}"
                    ),
                );
            }
        }
        let before = self.errors.len();
        let own = self.table(data.errors.as_ref(), axis);
        let negative = self.table(data.errors_negative.as_ref(), axis);
        let travel = data
            .travel_mm
            .as_ref()
            .and_then(|travel| self.range(travel, &both!("travel_mm of {axis}", "travel_mm оси {axis}")));
        let backlash = data.backlash_um.as_ref().map(|value| (value, "backlash_um"));
        self.both_directions(axis, data.errors.is_some(), data.errors_negative.as_ref(), backlash);
        if let Some(place) = &data.measured_at_mm
            && [place.get_ref().X, place.get_ref().Y, place.get_ref().Z][index].is_some()
        {
            let diagnostic = Diagnostic::error(
                CONFLICT,
                both!(
                    "measured_at_mm of {axis} names {axis} itself",
                    "в measured_at_mm оси {axis} названа сама {axis}"
                ),
            )
            .help(both!(
                "it says where the other axes stood while this one was measured",
                "там сказано, где стояли остальные оси, пока измеряли эту"
            ));
            self.refuse(
                place,
                diagnostic,
                both!("{axis} moved along the whole line", "{axis} прошла всю линию"),
            );
        }
        if self.errors.len() > before {
            return None;
        }
        let errors = own.as_ref().and_then(|rows| rows.tables(interpolation));
        let errors_negative = negative.as_ref().and_then(|rows| rows.tables(interpolation));
        let Some(travel_mm) = travel.or_else(|| errors.as_ref().map(machine_model::AxisTables::range)) else {
            let diagnostic = Diagnostic::error(
                KEY,
                both!(
                    "axis {axis} has neither travel_mm nor errors",
                    "у оси {axis} нет ни travel_mm, ни errors"
                ),
            )
            .help(both!(
                "add travel_mm = [lowest, highest], machine coordinates",
                "добавьте travel_mm = [наименьшее, наибольшее], координаты станка"
            ));
            self.refuse(spanned, diagnostic, both!("how far does this axis go?", "каков ход этой оси?"));
            return None;
        };
        let place = data.measured_at_mm.as_ref().map(|place| *place.get_ref()).unwrap_or_default();
        rows[index] = own;
        Some(LinearAxis {
            travel_mm,
            errors,
            errors_negative,
            backlash_mm: data.backlash_um.as_ref().map_or(0.0, |b| Length::from_um(b.get_ref().0).mm()),
            measured_at_mm: Vector::from([place.X, place.Y, place.Z].map(|v| v.map_or(0.0, |Finite(v)| v))),
            measured_tool_mm: vector(place.tool),
        })
    }

    fn rotary(
        &mut self,
        document: &Document,
        chain: Option<&Chain>,
        interpolation: Interpolation,
        resolution_deg: &mut [f64; 3],
    ) -> [RotaryAxis; 3] {
        let written = &document.rotary;
        let parts = [
            written.A.as_ref().map(|axis| (axis.span(), axis.get_ref().parts())),
            written.B.as_ref().map(|axis| (axis.span(), axis.get_ref().parts())),
            written.C.as_ref().map(|axis| (axis.span(), axis.get_ref().parts())),
        ];
        let mut all: [RotaryAxis; 3] = std::array::from_fn(|_| RotaryAxis::perfect(Vector::zeros()));
        for ((axis, parts), result) in Axis::ALL[3..].iter().zip(parts).zip(&mut all) {
            let Some((place, parts)) = parts else { continue };
            if let Some(step) = parts.resolution_deg {
                let Finite(value) = *step.get_ref();
                resolution_deg[axis.direction()] = value;
                if !(1e-7..=1.0).contains(&value) {
                    let diagnostic = Diagnostic::error(
                        VALUE,
                        both!("resolution_deg of {axis} is {value}", "resolution_deg оси {axis} — {value}"),
                    )
                    .help(both!(
                        "the step of its words in degrees, like 0.001",
                        "дискрета её слов в градусах, например 0.001"
                    ));
                    self.refuse(
                        step,
                        diagnostic,
                        both!("expected 0.0000001 to 1", "ожидалось от 0.0000001 до 1"),
                    );
                }
            }
            if chain.is_some_and(|chain| !chain.axes().any(|known| known == *axis)) {
                let diagnostic = Diagnostic::error(
                    CONFLICT,
                    both!(
                        "[rotary.{axis}] is described, but the chain lacks {axis}",
                        "[rotary.{axis}] описана, а в цепи нет {axis}"
                    ),
                )
                .help(both!(
                    "add {axis} to the chain, or remove [rotary.{axis}]",
                    "добавьте {axis} в цепь или уберите [rotary.{axis}]"
                ))
                .at(span(&place), both!("not in the chain", "её нет в цепи"));
                self.errors.push(ProfileError::profile(diagnostic));
            }
            result.centre_mm = vector(parts.centre_mm);
            result.tilt = match parts.tilt {
                Some(format::TiltName::Axis) => Tilt::Axis,
                Some(format::TiltName::Body) | None => Tilt::Body,
            };
            let leans = parts.tilt_urad.iter().any(|tilt| tilt.is_some_and(|Finite(urad)| urad != 0.0));
            if leans && parts.tilt.is_none() {
                let diagnostic = Diagnostic::error(
                    TILT,
                    both!(
                        "what the tilt of {axis} does to the workpiece or the tool is not said",
                        "не сказано, что наклон оси {axis} делает с деталью или инструментом"
                    ),
                )
                .help(both!(
                    "write tilt = \"body\" in [rotary.{axis}] where what the axis carries leans with it, as vpost calibrate \
                     measures it, or tilt = \"axis\" where it only turns about the leaning line",
                    "напишите tilt = \"body\" в [rotary.{axis}], если то, что несёт ось, наклонено вместе с ней (так \
                     измеряет vpost calibrate), или tilt = \"axis\", если оно лишь вращается вокруг наклонной линии"
                ))
                .at(span(&place), both!("a tilt without `tilt`", "наклон без ключа `tilt`"));
                self.errors.push(ProfileError::profile(diagnostic));
            }
            if let Some(direction) = parts.direction {
                let along = vector(Some(*direction.get_ref()));
                let length = along.norm();
                if length > 1e-9 {
                    result.direction = Some(along / length);
                } else {
                    let diagnostic = Diagnostic::error(
                        VALUE,
                        both!(
                            "the direction of {axis} is no direction",
                            "направление {axis} — не направление"
                        ),
                    )
                    .help(both!(
                        "write three numbers, not all zero, like [0, 0.7071, 0.7071]",
                        "напишите три числа, не все нули, например [0, 0.7071, 0.7071]"
                    ));
                    self.refuse(direction, diagnostic, both!("a vector of length 0", "нулевой вектор"));
                }
            }
            result.shift_mm =
                Vector::from(parts.shift_um.map(|v| v.map_or(0.0, |Finite(v)| Length::from_um(v).mm())));
            result.tilt_rad =
                Vector::from(parts.tilt_urad.map(|v| v.map_or(0.0, |Finite(v)| Angle::from_urad(v).rad())));
            if let Some(travel) = parts.travel_deg
                && let Some(range) =
                    self.range(travel, &both!("travel_deg of {axis}", "travel_deg оси {axis}"))
            {
                let rad = |deg: f64| Angle::from_deg(deg).rad();
                result.travel_rad = Range { low: rad(range.low), high: rad(range.high) };
            }
            result.errors = self.table(parts.errors, *axis).and_then(|rows| rows.tables(interpolation));
            result.errors_negative =
                self.table(parts.errors_negative, *axis).and_then(|rows| rows.tables(interpolation));
            let backlash = parts.backlash_urad.map(|value| (value, "backlash_urad"));
            self.both_directions(*axis, parts.errors.is_some(), parts.errors_negative, backlash);
            if let Some(backlash) = parts.backlash_urad {
                let Finite(urad) = *backlash.get_ref();
                result.backlash_rad = Angle::from_urad(urad).rad();
                if urad.abs() > MOST_BACKLASH_URAD {
                    let diagnostic = Diagnostic::error(
                        VALUE,
                        both!("backlash_urad of {axis} is {urad}", "backlash_urad оси {axis} — {urad}"),
                    )
                    .help(both!(
                        "the unit is the microradian: 1 arc second is 4.848 urad",
                        "единица — микрорадиан: 1 угловая секунда — 4.848 мкрад"
                    ));
                    self.refuse(backlash, diagnostic, both!("wrong unit?", "не та единица?"));
                }
            }
        }
        all
    }

    fn squareness(&mut self, written: &format::Squareness) -> Squareness {
        let mut read = |value: &Option<Spanned<Finite>>, name: &str| {
            let Some(value) = value else { return 0.0 };
            let Finite(urad) = *value.get_ref();
            if urad.abs() > 1e5 {
                let diagnostic = Diagnostic::error(
                    VALUE,
                    both!(
                        "{name} of {urad} urad is more than 0.1 rad",
                        "{name} {urad} мкрад — больше 0.1 рад"
                    ),
                )
                .help(both!(
                    "the unit is the microradian: 1 arc second is 4.848 urad",
                    "единица — микрорадиан: 1 угловая секунда — 4.848 мкрад"
                ));
                self.refuse(value, diagnostic, both!("wrong unit?", "не та единица?"));
            }
            Angle::from_urad(urad).rad()
        };
        Squareness {
            ec0y_rad: read(&written.EC0Y_urad, "EC0Y"),
            eb0z_rad: read(&written.EB0Z_urad, "EB0Z"),
            ea0z_rad: read(&written.EA0Z_urad, "EA0Z"),
        }
    }

    fn traverses(&mut self, tracker: &format::Tracker) -> Option<[Traverse; 3]> {
        let mut all = Vec::new();
        for (axis, name) in Axis::ALL.into_iter().zip([&tracker.x, &tracker.y, &tracker.z]) {
            let bytes = self.file(name);
            all.push(bytes.and_then(|bytes| self.keep(traverse(name.get_ref(), &bytes, axis))));
        }
        all.into_iter().collect::<Option<Vec<_>>>()?.try_into().ok()
    }

    fn finishing_passes(&mut self, program: &format::Program) -> Option<f64> {
        let written = program.thread_finishing_passes.as_ref()?;
        let Finite(passes) = *written.get_ref();
        if !(1.0..=MOST_FINISHING_PASSES).contains(&passes) || passes.fract() != 0.0 {
            let diagnostic = Diagnostic::error(
                VALUE,
                both!("thread_finishing_passes is {passes}", "thread_finishing_passes — {passes}"),
            )
            .help(both!(
                "give the control's value (parameter 5142)",
                "укажите значение стойки (параметр 5142)"
            ));
            self.refuse(
                written,
                diagnostic,
                both!(
                    "expected a whole number from 1 to {MOST_FINISHING_PASSES}",
                    "ожидалось целое число от 1 до {MOST_FINISHING_PASSES}"
                ),
            );
        }
        Some(passes)
    }

    fn rotary_start(&mut self, program: &format::Program, chain: Option<&Chain>) -> [Option<f64>; 3] {
        let mut start_deg = [None; 3];
        for (name, written) in &program.rotary_start {
            let mut axes = chain.into_iter().flat_map(Chain::axes).filter(|axis| !axis.is_linear());
            let Finite(deg) = *written.get_ref();
            match axes.find(|axis| name.len() == 1 && name.starts_with(axis.letter())) {
                Some(axis) => start_deg[axis.direction()] = Some(deg),
                None => {
                    let message =
                        both!("`{name}` is no rotary axis of the chain", "`{name}` — не поворотная ось цепи");
                    let help = both!("remove it, or name it in `chain`", "уберите её или назовите в `chain`");
                    let label = both!("no such axis", "такой оси нет");
                    self.refuse(written, Diagnostic::error(VALUE, message).help(help), label);
                }
            }
        }
        start_deg
    }

    fn edge_at_change(&mut self, program: &format::Program) -> Option<u32> {
        let written = program.edge_at_change.as_ref()?;
        let edge = *written.get_ref();
        if edge > 1 {
            let diagnostic =
                Diagnostic::error(VALUE, both!("edge_at_change is {edge}", "edge_at_change — {edge}")).help(
                    both!(
                        "1 where a tool change brings in the first edge, 0 where it brings in none (MD20270)",
                        "1, если смена инструмента вводит первую кромку, 0, если никакой (MD20270)"
                    ),
                );
            self.refuse(written, diagnostic, both!("expected 0 or 1", "ожидалось 0 или 1"));
        }
        Some(edge)
    }

    /// Where lengths count from, where that is not the gauge point.
    fn gauge_point(&mut self, document: &Document, is_lathe: bool) -> Option<f64> {
        let written = document.tool.gauge_point_mm.as_ref()?;
        let conflict = if document.kinematics.is_some() {
            Some((
                both!(
                    "`gauge_point_mm` and `[kinematics]`: the control turns tools about what it takes for the gauge point",
                    "`gauge_point_mm` и `[kinematics]`: стойка поворачивает инструмент вокруг того, что считает базовой точкой"
                ),
                both!(
                    "give lengths from the gauge point, on the control and here, and leave `gauge_point_mm` out",
                    "задайте длины от базовой точки, на стойке и здесь, и уберите `gauge_point_mm`"
                ),
            ))
        } else if is_lathe {
            Some((
                both!(
                    "`gauge_point_mm` in the profile of a lathe",
                    "`gauge_point_mm` в профиле токарного станка"
                ),
                both!(
                    "give `lengths_mm` from the point of the turret that the tables were measured at",
                    "задайте `lengths_mm` от той точки револьверной головки, в которой измерены таблицы"
                ),
            ))
        } else {
            None
        };
        if let Some((message, help)) = conflict {
            self.refuse(
                written,
                Diagnostic::error(CONFLICT, message).help(help),
                both!("this key", "этот ключ"),
            );
        }
        Some(written.get_ref().0)
    }

    /// Names of tools, each with a length that is given.
    fn tool_names(&mut self, written: &format::Tool, tools: &[(u32, [f64; 3])]) -> Vec<(String, u32)> {
        for (name, number) in &written.names {
            if tools.iter().all(|(known, _)| known != number.get_ref()) {
                let message = both!(
                    "the tool \"{name}\" has the length H{}",
                    "у инструмента \"{name}\" длина H{}",
                    number.get_ref()
                );
                let diagnostic = Diagnostic::error(KEY, message).help(both!(
                    "add the length to `lengths_mm`, or correct the number",
                    "добавьте длину в `lengths_mm` или исправьте номер"
                ));
                self.refuse(
                    number,
                    diagnostic,
                    both!("lengths_mm has no such length", "такой длины в lengths_mm нет"),
                );
            }
        }
        written.names.iter().map(|(name, number)| (name.clone(), *number.get_ref())).collect()
    }

    /// Radii of a mill's cutters by D number.
    fn cutter_radii(&mut self, document: &Document) -> Vec<(u32, f64)> {
        let mut radii = Vec::new();
        for (name, radius) in &document.tool.radii_mm {
            let digits = name.strip_prefix('D').filter(|digits| digits.bytes().all(|b| b.is_ascii_digit()));
            let number = digits.and_then(|digits| digits.parse::<u32>().ok()).filter(|number| *number > 0);
            let Finite(mm) = *radius.get_ref();
            match number {
                Some(number) if mm > 0.0 && document.spindle.is_none() => radii.push((number, mm)),
                Some(_) if mm > 0.0 => {
                    let message = both!(
                        "`radii_mm` in the profile of a lathe",
                        "`radii_mm` в профиле токарного станка"
                    );
                    let help = both!(
                        "give the radius of a turning tool under `noses`",
                        "радиус при вершине резца задайте в `noses`"
                    );
                    let diagnostic = Diagnostic::error(CONFLICT, message).help(help);
                    self.refuse(radius, diagnostic, both!("this key", "этот ключ"));
                }
                Some(_) => {
                    let message = both!("the radius of `{name}` is {mm}", "радиус `{name}` — {mm}");
                    let help = both!("write millimetres above 0", "напишите миллиметры больше 0");
                    self.refuse(
                        radius,
                        Diagnostic::error(VALUE, message).help(help),
                        both!("this radius", "этот радиус"),
                    );
                }
                None => {
                    let message = both!("`{name}` is no D number", "`{name}` — не номер D");
                    let help = both!(
                        "write D and a whole number from 1, like D1 = 6.0",
                        "напишите D и целое число от 1, например D1 = 6.0"
                    );
                    self.refuse(
                        radius,
                        Diagnostic::error(KEY, message).help(help),
                        both!("of this entry", "в этой записи"),
                    );
                }
            }
        }
        radii.sort_by_key(|(number, _)| *number);
        radii
    }

    fn tools(&mut self, written: &format::Tool) -> Vec<(u32, [f64; 3])> {
        let mut tools = Vec::new();
        let mut known = BTreeSet::new();
        for (name, length) in &written.lengths_mm {
            let digits = name.strip_prefix('H').unwrap_or_default();
            let number =
                if digits.bytes().all(|b| b.is_ascii_digit()) { digits.parse::<u32>().ok() } else { None };
            match number.filter(|number| *number > 0) {
                Some(number) if !known.insert(number) => {
                    let diagnostic = Diagnostic::error(
                        CONFLICT,
                        both!("tool H{number} stands there twice", "инструмент H{number} стоит там дважды"),
                    );
                    self.refuse(length, diagnostic, both!("again here", "здесь ещё раз"));
                }
                Some(number) => tools.push((
                    number,
                    match length.get_ref() {
                        WrittenLength::Number(Finite(z)) => [0.0, 0.0, *z],
                        WrittenLength::Vector(v) => v.map(|Finite(v)| v),
                    },
                )),
                None => {
                    let diagnostic =
                        Diagnostic::error(KEY, both!("`{name}` is no H number", "`{name}` — не номер H"))
                            .help(both!(
                                "write H and a whole number from 1, like H1 = 120.0",
                                "напишите H и целое число от 1, например H1 = 120.0"
                            ));
                    self.refuse(length, diagnostic, both!("of this entry", "в этой записи"));
                }
            }
        }
        tools.sort_by_key(|(number, _)| *number);
        tools
    }

    fn correction(&mut self, written: &format::Correction) -> CorrectionOptions {
        let mut engine = EngineId::RigidBody;
        if let Some(name) = &written.engine {
            let usable = || EngineId::ALL.into_iter().filter(|id| !id.is_published()).map(EngineId::name);
            match EngineId::from_name(name.get_ref()).filter(|id| !id.is_published()) {
                Some(id) => engine = id,
                None => {
                    let names: Vec<&str> = usable().collect();
                    let mut diagnostic = Diagnostic::error(
                        VALUE,
                        both!(
                            "`{}` is no engine that corrects programs",
                            "`{}` — не метод, которым исправляют программы",
                            name.get_ref()
                        ),
                    );
                    diagnostic = diagnostic.help(match diagnostic::closest(name.get_ref(), usable()) {
                        Some(near) => both!(
                            "did you mean \"{near}\"? Engines: {}",
                            "имелось в виду \"{near}\"? Методы: {}",
                            names.join(", ")
                        ),
                        None => both!("engines: {}", "методы: {}", names.join(", ")),
                    });
                    self.refuse(name, diagnostic, both!("this engine", "этот метод"));
                }
            }
        }
        let mut positive = |value: &Option<Spanned<Finite>>, name: &str, default: f64, zero_too: bool| {
            let Some(value) = value else { return default };
            let Finite(number) = *value.get_ref();
            if number < 0.0 || (number == 0.0 && !zero_too) {
                let wanted = if zero_too {
                    both!("0 or more", "0 или больше")
                } else {
                    both!("a number above 0", "число больше 0")
                };
                self.refuse(
                    value,
                    Diagnostic::error(VALUE, both!("{name} is {number}", "{name} — {number}")),
                    both!("expected {wanted}", "ожидалось {wanted:#}"),
                );
            }
            number
        };
        CorrectionOptions {
            engine,
            tolerance_um: positive(&written.tolerance_um, "tolerance_um", 1.0, false),
            accept_um: written
                .accept_um
                .as_ref()
                .map(|_| positive(&written.accept_um, "accept_um", 0.0, true)),
            outside: match written.outside {
                OutsideName::Refuse => Outside::Refuse,
                OutsideName::Clamp => Outside::Clamp,
            },
            minimum_segment_mm: positive(&written.minimum_segment_mm, "minimum_segment_mm", 0.0, true),
            orientation_urad: positive(&written.orientation_urad, "orientation_urad", 50.0, false),
            directions: matches!(written.orientation, format::OrientationName::Full),
            singularity: {
                let usual = Singularity::default();
                Singularity {
                    least_sin: positive(&written.singular_sin, "singular_sin", usual.least_sin, false),
                    most_turn_rad: positive(
                        &written.singular_turn_deg,
                        "singular_turn_deg",
                        usual.most_turn_rad.to_degrees(),
                        false,
                    )
                    .to_radians(),
                    most_share: positive(&written.singular_share, "singular_share", usual.most_share, false),
                }
            },
        }
    }

    fn effects(
        &mut self,
        written: &[Spanned<std::collections::BTreeMap<String, Spanned<toml::Value>>>],
    ) -> Vec<EffectEntry> {
        let mut effects = Vec::new();
        for entry in written {
            let mut id = None;
            let mut parameters = Vec::new();
            for (name, value) in entry.get_ref() {
                let number = match value.get_ref() {
                    toml::Value::String(text) if name == "id" => {
                        id = Some((value, text.clone()));
                        continue;
                    }
                    toml::Value::Integer(number) => *number as f64,
                    toml::Value::Float(number) => *number,
                    _ => f64::NAN,
                };
                if number.is_finite() && name != "id" {
                    parameters.push((name.clone(), number));
                } else {
                    let what = if name == "id" {
                        both!("a text", "текст")
                    } else {
                        both!("a finite number", "конечное число")
                    };
                    self.refuse(
                        value,
                        Diagnostic::error(
                            EFFECT,
                            both!("`{name}` of an effect must be {what}", "`{name}` эффекта — это {what:#}"),
                        ),
                        both!("expected {what}", "ожидалось: {what:#}"),
                    );
                }
            }
            let Some((place, id)) = id else {
                let diagnostic =
                    Diagnostic::error(EFFECT, both!("an effect lacks its id", "у эффекта нет id")).help(
                        both!(
                            "add id = \"backlash.X\", or whichever it is",
                            "добавьте id = \"backlash.X\" или какой он есть"
                        ),
                    );
                self.refuse(entry, diagnostic, both!("this effect", "этот эффект"));
                continue;
            };
            if let Err(e) = EffectTerm::from_entry(&id, &parameters) {
                self.refuse(place, Diagnostic::error(EFFECT, e.text()), both!("this effect", "этот эффект"));
            }
            effects.push(EffectEntry { id, parameters });
        }
        effects
    }
}

/// `rotary axes A, C`, where the chain has some.
fn rotary_axes(chain: Option<&Chain>) -> Option<Text> {
    let letters: Vec<String> =
        chain?.axes().filter(|axis| !axis.is_linear()).map(|axis| axis.letter().to_string()).collect();
    let names = letters.join(", ");
    (!letters.is_empty()).then(|| both!("rotary axes, {names}", "поворотные оси, {names}"))
}

/// Year-month-day of the Gregorian calendar.
fn is_date(text: &str) -> bool {
    let parts: Vec<&str> = text.split('-').collect();
    let [year, month, day] = parts[..] else { return false };
    let digits = |part: &str, length: usize| {
        (part.len() == length && part.bytes().all(|b| b.is_ascii_digit()))
            .then(|| part.parse::<u32>().unwrap_or(0))
    };
    let (Some(year), Some(month), Some(day)) = (digits(year, 4), digits(month, 2), digits(day, 2)) else {
        return false;
    };
    let leap = year % 4 == 0 && (year % 100 != 0 || year % 400 == 0);
    let days = match month {
        4 | 6 | 9 | 11 => 30,
        2 => 28 + u32::from(leap),
        1..=12 => 31,
        _ => return false,
    };
    (1..=days).contains(&day)
}
