//! Forward for a lathe: what a program leaves of the workpiece.

use std::fmt::Write;

use correction::Curve;
use diagnostic::{Code, Diagnostic, both};
use machine_model::{Command, Vector};
use machine_profile::Nose;
use nc_program::modal::FeedMode;
use nc_program::{Context, Interpreter};
use nc_syntax::{Block, Reader};
use serde::Serialize;
use toolpath::{Feed, Motion};
use turning::{Cylinder, Lathe, Section, Wave, roughness};

use crate::arguments::{Predict, Shared};
use crate::conditions::{conditions, failure};
use crate::figures::{fixed, round};
use crate::message::{Failure, Messages};
use crate::settings::Settings;
use crate::{expand, file};

/// Nothing is turned, or too much is asked.
const NOTHING_TURNED: Code = Code(908);

/// Spindle angles of a section.
const ANGLES: usize = 360;
/// Waves a turn that are told apart.
const HIGHEST_WAVE: u32 = 8;
/// Places of a path are so far apart at most, as a share of the step along Z.
const SHARE_OF_STEP: f64 = 0.2;
/// Most places along Z.
const MOST_PLACES: usize = 200_000;
/// Programmed radii of one cylinder differ by less, mm: more than a correction, less than a taper that is meant.
const SAME_RADIUS_MM: f64 = 0.02;
/// A cylinder is judged by so many sections at most, evenly chosen.
const MOST_SECTIONS: usize = 20;

/// A place of the finished surface.
#[derive(Serialize)]
struct Place {
    /// From the chuck, mm.
    z_mm: f64,
    radius_mm: f64,
    diameter_mm: f64,
    nominal_radius_mm: f64,
    radius_error_um: f64,
    /// By the least-squares circle.
    roundness_um: f64,
    /// By the minimum zone.
    roundness_zone_um: f64,
    /// Theoretical, exact; nothing where the tool's nose is not known or does not meet its own cut.
    roughness_um: Option<f64>,
    /// f²/8r.
    roughness_usual_um: Option<f64>,
    /// Waves a turn, from 2 on: amplitudes.
    waves_um: Vec<f64>,
}

/// A stretch of one programmed radius.
#[derive(Serialize)]
struct Stretch {
    from_z_mm: f64,
    to_z_mm: f64,
    nominal_radius_mm: f64,
    cylindricity_um: f64,
    cylindricity_zone_um: f64,
}

#[derive(Serialize)]
struct Turned {
    schema: &'static str,
    angles: usize,
    asynchronous_um: f64,
    cylinders: Vec<Stretch>,
    places: Vec<Place>,
}

/// `vpost predict --lathe PROGRAM -m PROFILE`
pub(crate) fn run(arguments: &Predict, shared: &Shared, messages: &Messages) -> Result<(), Failure> {
    let settings = crate::settings::load(shared, messages)?;
    let lathe = settings.profile.lathe(&conditions(&shared.job)?).map_err(|error| failure(&error))?;
    let Some(lathe) = lathe else {
        return Err(Failure::option(
            both!(
                "{} is no lathe: its chain is {}",
                "{} — не токарный станок: его цепь — {}",
                settings.profile_name,
                settings.profile.chain()
            ),
            both!(
                "leave `--lathe` out, or give the profile of a lathe",
                "уберите `--lathe` или дайте профиль токарного станка"
            ),
        ));
    };
    if !(arguments.step > 0.0 && arguments.step.is_finite()) {
        return Err(Failure::option(
            both!("`--step {}` is no distance", "`--step {}` — не расстояние", arguments.step),
            both!("write millimetres, like `--step 0.5`", "напишите миллиметры, например `--step 0.5`"),
        ));
    }
    let name = file::name(&arguments.points);
    let text = file::read_program(&arguments.points)?;
    let refused = |diagnostics: Vec<Diagnostic>| Failure::refused(&name, &text, diagnostics);
    let expanded = expand::expanded(&text, &name, &settings)?;
    let cuts = cuts(expanded.text(), &settings)
        .map_err(|diagnostics| Failure::Refused(expand::reports(&expanded, &name, &text, diagnostics)))?;
    let mut surface = Surface::over(&cuts, &lathe, arguments).ok_or_else(|| {
        let diagnostic = Diagnostic::error(
            NOTHING_TURNED,
            both!(
                "the program turns nothing that could be predicted",
                "программа ничего не точит, предсказывать нечего"
            ),
        )
        .help(both!(
            "feeds (G1, G2, G3) that move along Z are needed; with `--step` there may be up to 200000 places",
            "нужны рабочие ходы (G1, G2, G3) вдоль Z; мест с шагом `--step` может быть до 200000"
        ));
        refused(vec![diagnostic])
    })?;
    for cut in &cuts {
        surface.cut(cut, &lathe, arguments);
    }
    let turned = surface.turned(&lathe, &settings, &cuts);
    let out = if arguments.json { json(&turned) } else { csv(&turned) };
    file::print(out.as_bytes())
}

fn json(turned: &Turned) -> String {
    let mut text = serde_json::to_string_pretty(turned).expect("plain values always serialise");
    text.push('\n');
    text
}

fn csv(turned: &Turned) -> String {
    let mut out = String::from(
        "z_mm,radius_mm,diameter_mm,nominal_radius_mm,radius_error_um,roundness_um,roundness_zone_um,roughness_um,roughness_usual_um",
    );
    let mut line = |text: std::fmt::Arguments<'_>| out.write_fmt(text).expect("a string takes all");
    for order in 2..=HIGHEST_WAVE {
        line(format_args!(",wave_{order}_um"));
    }
    line(format_args!("\n"));
    let or_nothing = |value: Option<f64>| value.map_or_else(String::new, |value| fixed(value, 6));
    for place in &turned.places {
        line(format_args!(
            "{},{},{},{},{},{},{},{},{}",
            fixed(place.z_mm, 6),
            fixed(place.radius_mm, 9),
            fixed(place.diameter_mm, 9),
            fixed(place.nominal_radius_mm, 9),
            fixed(place.radius_error_um, 6),
            fixed(place.roundness_um, 6),
            fixed(place.roundness_zone_um, 6),
            or_nothing(place.roughness_um),
            or_nothing(place.roughness_usual_um),
        ));
        for wave in &place.waves_um {
            line(format_args!(",{}", fixed(*wave, 6)));
        }
        line(format_args!("\n"));
    }
    out
}

/// A feed of the program.
struct Cut {
    curve: Curve,
    tool_mm: Vector,
    /// mm a turn, where the program says it so.
    feed_mm: Option<f64>,
}

impl Cut {
    fn at(&self, s: f64) -> Command {
        Command {
            linear_mm: self.curve.at(s),
            rotary_rad: Vector::zeros(),
            tool_mm: self.tool_mm,
            direction: self
                .curve
                .tangent(s)
                .map(|way| if way == 0.0 { 0 } else { way.signum() as i8 })
                .into(),
            rotary_play: Default::default(),
        }
    }
}

/// The feeds of a program, as they are commanded.
fn cuts(text: &[u8], settings: &Settings) -> Result<Vec<Cut>, Vec<Diagnostic>> {
    let (dialect, setup) = (&settings.dialect, &settings.setup);
    let mut interpreter = Interpreter::new(dialect, setup);
    let (mut reader, mut block) = (Reader::new(text, dialect), Block::default());
    let (mut cuts, mut feed) = (Vec::new(), None);
    while reader.next(&mut block) {
        let step = interpreter.step(&block)?;
        if let Some(number) = block.word(b'F').and_then(|word| word.number()) {
            feed = Some(number.decimal.to_f64());
        }
        for motion in &step.motions {
            // The flanks of a thread are no surface whose radius is looked at.
            if let Motion::Feed(Feed { start, end, shape, .. }) = motion
                && !step.context.thread
            {
                let curve = Curve::new(start.linear_mm.into(), end.linear_mm.into(), shape);
                let feed_mm = feed.and_then(|feed| a_turn(feed, &step.context));
                cuts.push(Cut { curve, tool_mm: step.context.tool_mm.into(), feed_mm });
            }
        }
    }
    Ok(cuts)
}

/// F as mm a turn.
fn a_turn(feed: f64, context: &Context) -> Option<f64> {
    (context.feed_mode == FeedMode::PerRevolution).then_some(feed * context.unit_mm)
}

/// What cut a place last: radius, command, and the number of the cut.
type Reached = Option<(f64, Command, usize)>;

/// The finished surface at places along Z.
struct Surface {
    step_mm: f64,
    first_mm: f64,
    bore: bool,
    done: usize,
    real: Vec<Reached>,
    nominal: Vec<Option<f64>>,
}

impl Surface {
    /// Over all that the cuts reach; `None` where they reach nothing, or too much.
    fn over(cuts: &[Cut], lathe: &Lathe, arguments: &Predict) -> Option<Self> {
        let places = cuts.iter().flat_map(|cut| [0.0, 0.5, 1.0].map(|s| lathe.nominal_mm(&cut.at(s))[1]));
        let (low, high) =
            places.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), z| (low.min(z), high.max(z)));
        let step_mm = arguments.step;
        let first_mm = (low / step_mm).ceil() * step_mm;
        let count = ((high - first_mm) / step_mm).floor() + 1.0;
        (count >= 1.0 && count <= MOST_PLACES as f64).then(|| Self {
            step_mm,
            first_mm,
            bore: arguments.bore,
            done: 0,
            real: vec![None; count as usize],
            nominal: vec![None; count as usize],
        })
    }

    /// Takes away what a cut reaches; the tip counts as a point.
    fn cut(&mut self, cut: &Cut, lathe: &Lathe, arguments: &Predict) {
        let pieces =
            (cut.curve.length_mm() / (SHARE_OF_STEP * arguments.step).min(1.0)).ceil().max(1.0) as usize;
        let number = self.done;
        self.done += 1;
        let places = |k: usize| {
            let command = cut.at(k as f64 / pieces as f64);
            (command, lathe.turned_mm(&command), lathe.nominal_mm(&command))
        };
        let mut before = places(0);
        for k in 1..=pieces {
            let after = places(k);
            let bore = self.bore;
            let better = |new: f64, old: f64| if bore { new > old } else { new < old };
            for (place, share) in self.between(before.1[1], after.1[1]) {
                let radius = before.1[0] + share * (after.1[0] - before.1[0]);
                let linear_mm = before.0.linear_mm + (after.0.linear_mm - before.0.linear_mm) * share;
                if self.real[place].is_none_or(|(old, ..)| better(radius, old)) {
                    self.real[place] = Some((radius, Command { linear_mm, ..after.0 }, number));
                }
            }
            for (place, share) in self.between(before.2[1], after.2[1]) {
                let radius = before.2[0] + share * (after.2[0] - before.2[0]);
                if self.nominal[place].is_none_or(|old| better(radius, old)) {
                    self.nominal[place] = Some(radius);
                }
            }
            before = after;
        }
    }

    /// Places from one Z to another, each with its share of the way.
    fn between(&self, from: f64, to: f64) -> Vec<(usize, f64)> {
        let (low, high) = (from.min(to), from.max(to));
        let first = ((low - self.first_mm) / self.step_mm).ceil().max(0.0) as usize;
        let places = (first..self.real.len()).map(|place| (place, self.z_mm(place)));
        let inside = places.take_while(|(_, z)| *z <= high);
        inside.map(|(place, z)| (place, if to == from { 1.0 } else { (z - from) / (to - from) })).collect()
    }

    fn z_mm(&self, place: usize) -> f64 {
        self.first_mm + place as f64 * self.step_mm
    }

    fn turned(&self, lathe: &Lathe, settings: &Settings, cuts: &[Cut]) -> Turned {
        let mut places = Vec::new();
        let mut cylinders = Vec::new();
        let mut run: Vec<(f64, f64, Section)> = Vec::new();
        for place in 0..self.real.len() {
            let known = self.real[place].zip(self.nominal[place]);
            let Some(((radius_mm, command, number), nominal_radius_mm)) =
                known.filter(|((radius, ..), _)| *radius > lathe.near_axis_mm())
            else {
                cylinders.extend(stretch(&std::mem::take(&mut run)));
                continue;
            };
            let section = lathe.section(&command, ANGLES);
            let (circle, zone) = (section.least_squares(), section.minimum_zone());
            let ridge = cuts[number]
                .feed_mm
                .zip(nose(settings, &command))
                .map(|(feed_mm, nose)| roughness(feed_mm, nose.radius_mm, nose.minor_edge_rad));
            let um = |mm: f64| round(mm * 1e3, 6);
            places.push(Place {
                z_mm: round(self.z_mm(place), 6),
                radius_mm: round(radius_mm, 9),
                diameter_mm: round(2.0 * radius_mm, 9),
                nominal_radius_mm: round(nominal_radius_mm, 9),
                radius_error_um: um(radius_mm - nominal_radius_mm),
                roundness_um: um(circle.roundness_mm),
                roundness_zone_um: um(zone.roundness_mm),
                roughness_um: ridge.and_then(|ridge| ridge.exact_mm).map(um),
                roughness_usual_um: ridge.map(|ridge| um(ridge.usual_mm)),
                waves_um: section
                    .waves(HIGHEST_WAVE)
                    .iter()
                    .map(|wave: &Wave| um(wave.amplitude_mm))
                    .collect(),
            });
            if run.first().is_some_and(|(_, radius, _)| (radius - nominal_radius_mm).abs() > SAME_RADIUS_MM) {
                cylinders.extend(stretch(&std::mem::take(&mut run)));
            }
            run.push((self.z_mm(place), nominal_radius_mm, section));
        }
        cylinders.extend(stretch(&run));
        Turned {
            schema: "vpost.turned/1",
            angles: ANGLES,
            asynchronous_um: round(lathe.spindle().asynchronous_mm * 1e3, 6),
            cylinders,
            places,
        }
    }
}

/// The nose of the tool whose vector is in force.
fn nose(settings: &Settings, command: &Command) -> Option<Nose> {
    let lathe = settings.profile.lathe.as_ref()?;
    let tool = settings.setup.tools.iter().find(|(_, length)| -Vector::from(*length) == command.tool_mm)?.0;
    lathe.noses.iter().find(|(number, nose)| *number == tool && nose.radius_mm > 0.0).map(|(_, nose)| *nose)
}

/// Sections of one radius, three or more, as a cylinder.
fn stretch(run: &[(f64, f64, Section)]) -> Option<Stretch> {
    let (first, last) = (run.first()?, run.last()?);
    if run.len() < 3 {
        return None;
    }
    let chosen = run.len().min(MOST_SECTIONS);
    let sections: Vec<Section> =
        (0..chosen).map(|k| run[k * (run.len() - 1) / (chosen - 1)].2.clone()).collect();
    let um = |mm: f64| round(mm * 1e3, 6);
    Some(Stretch {
        from_z_mm: round(first.0, 6),
        to_z_mm: round(last.0, 6),
        nominal_radius_mm: round(first.1, 9),
        cylindricity_um: um(Cylinder::least_squares(&sections).cylindricity_mm),
        cylindricity_zone_um: um(Cylinder::minimum_zone(&sections).cylindricity_mm),
    })
}
