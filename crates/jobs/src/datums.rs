//! How a job's zeros came to be: what profile and command line say together.

use diagnostic::{Text, both, notice};
use machine_model::{Engine, FromDatum, PathModel, Placement, Vector, Way};
use machine_profile::{Found, Profile, TouchPlace, TouchedBy};
use nc_program::{Setup, ToolLength};
use rewrite::{Datum, Datums, Touch, TouchTool, Touches, Zero};

use crate::map::study::WorkOffset;
use crate::message::{Failure, OPTION};
use crate::options::{self, JobOptions};
use crate::setup;
use crate::stored::Stored;

/// What is known of the zeros.
///
/// # Errors
/// A tool that touched and has no length, a place of touching outside the calibrated volume.
pub(crate) fn of(
    options: &JobOptions,
    profile: &Profile,
    setup: &Setup,
    engine: &dyn Engine,
) -> Result<Datums, Failure> {
    if profile.lathe.is_some() {
        // Lathes touch with each tool, on a diameter that they have measured.
        return Ok(Datums::default());
    }
    let plain = match options.zero {
        Some(options::Zero::True) => Found::True,
        Some(options::Zero::Touched) => Found::Touched,
        None => profile.program.zero,
    };
    let tool = TouchTool { vector_mm: setup.default_tool_mm, ..TouchTool::default() };
    let zero = |found: Found, touches: Touches| match found {
        Found::True => Zero::True,
        Found::Touched => Zero::Touched(Box::new(touches)),
    };
    let mut named = Vec::new();
    for (name, said) in &profile.zeros {
        // A flag that gives the offset anew says nothing of where another was touched.
        let is_other = options.work_offset.iter().any(|given| given.name == *name);
        let axes = match said.touched_at.as_ref().filter(|_| !is_other) {
            None => Default::default(),
            Some(places) => touches(name, places, setup, engine)?,
        };
        let aligned = said.aligned.filter(|_| !is_other);
        aligned.map_or(Ok(()), |way| inside(name, &way, engine))?;
        let touches = Touches { axes, aligned };
        named.push((name.clone(), zero(said.found.unwrap_or(plain), touches)));
    }
    for given in &options.touched_at {
        let place = TouchPlace { at_mm: vec![given.zero_mm], ..TouchPlace::default() };
        let axes = touches(&given.name, &[0, 1, 2].map(|_| place.clone()), setup, engine)?;
        let aligned = named.iter().find_map(|(name, zero)| match zero {
            Zero::Touched(touches) if *name == given.name => touches.aligned,
            _ => None,
        });
        let touches = Touches { axes, aligned };
        named.retain(|(name, _)| *name != given.name);
        named.push((given.name.clone(), Zero::Touched(Box::new(touches))));
    }
    let lengths_at_mm = profile.lengths_touched_at_mm;
    Ok(Datums { named, others: zero(plain, Default::default()), tool, lengths_at_mm })
}

/// From where errors count that count from a zero of a profile, where one is named.
pub struct FromZero(Option<(Datums, String, [f64; 3])>);

impl FromZero {
    /// * `name` – of its work offset; `None`: errors count from the measuring frame
    ///
    /// # Errors
    /// The profile has no such zero; a tool that touched and has no length, a place outside the calibrated volume.
    pub fn of(
        options: &JobOptions,
        profile: &Profile,
        engine: &dyn Engine,
        name: Option<&str>,
    ) -> Result<Self, Failure> {
        let Some(name) = name else { return Ok(Self(None)) };
        let setup = setup::setup(options, profile, &Stored::default())?;
        let Some((_, zero_mm)) = setup.work_offsets.iter().find(|(known, _)| known == name) else {
            return Err(Failure::usage(notice!(OPTION;
                "the profile has no {name}", "в профиле нет {name}";
                "`--datum` names one of [work_offsets_mm]: add `{name} = [x, y, z]` there, how it was touched beside it",
                "`--datum` — одно из [work_offsets_mm]: добавьте туда `{name} = [x, y, z]` и как его нашли"
            )));
        };
        Ok(Self(Some((of(options, profile, &setup, engine)?, name.to_owned(), *zero_mm))))
    }

    fn datum(&self, model: &dyn PathModel) -> Option<Datum> {
        let (datums, name, zero_mm) = self.0.as_ref()?;
        datums.of_zero(model, name.clone(), *zero_mm, &datums.tool)
    }

    /// [`machine_model::Command::datum`] on a machine, as it would have been touched on it.
    #[must_use]
    pub fn placement(&self, model: &dyn PathModel) -> Placement {
        self.datum(model).map_or_else(Placement::default, |datum| datum.placement)
    }

    /// What is said of it on a machine.
    #[must_use]
    pub fn said(&self, model: &dyn PathModel) -> Vec<Text> {
        said(self.datum(model).as_slice())
    }
}

/// How far the zeros of a profile lie from where it says, mm: what is in those that were touched of the machine's error; `None`
/// for true ones.
///
/// # Errors
/// A tool that touched and has no length, a place of touching outside the calibrated volume.
pub fn of_offsets(
    options: &JobOptions,
    profile: &Profile,
    engine: &dyn Engine,
) -> Result<Vec<WorkOffset>, Failure> {
    let setup = setup::setup(options, profile, &Stored::default())?;
    let datums = of(options, profile, &setup, engine)?;
    let offsets = setup.work_offsets.iter().map(|(name, zero_mm)| {
        let datum =
            engine.path_model().and_then(|of| datums.of_zero(of, name.clone(), *zero_mm, &datums.tool));
        let touched_mm = datum.map(|datum| datum.error_mm.into());
        WorkOffset { name: name.clone(), zero_mm: Vector::from(*zero_mm), touched_mm }
    });
    Ok(offsets.collect())
}

/// The engine whose errors count from a datum, where zeros were touched.
pub(crate) fn counted_from(datums: &Datums, engine: Box<dyn Engine>) -> Box<dyn Engine> {
    if datums.are_true() {
        return engine;
    }
    match FromDatum::new(engine) {
        Ok(engine) => Box::new(engine),
        Err(engine) => engine,
    }
}

fn touch_tool(setup: &Setup, length_mm: [f64; 3]) -> TouchTool {
    TouchTool { vector_mm: setup.tool_vector(&ToolLength::Written { applied_mm: length_mm }), length_mm }
}

/// Refuses a way of which the machine is not known.
fn inside(name: &str, way: &Way, engine: &dyn Engine) -> Result<(), Failure> {
    let volume = engine.volume().0;
    let outside = way.ends_mm.iter().flat_map(|end| end.iter().zip(&volume));
    if let Some((place, range)) = outside
        .filter_map(|(place, range)| Some(((*place)?, range)))
        .find(|(place, range)| !range.contains(*place))
    {
        return Err(Failure::usage(notice!(OPTION;
            "{name} was aligned to the way at {place} mm, outside the calibrated {} to {} mm",
            "{name} выверен по ходу у {place} мм, вне калиброванных {}–{} мм", range.low, range.high;
            "`aligned` takes axis commands (machine coordinates); calibrate a volume that holds them",
            "`aligned` — команды осей (координаты станка); калибруйте объём, в котором они лежат"
        )));
    }
    Ok(())
}

fn touches(
    name: &str,
    places: &[TouchPlace; 3],
    setup: &Setup,
    engine: &dyn Engine,
) -> Result<[Touch; 3], Failure> {
    let mut touches: [Touch; 3] = Default::default();
    for (axis, TouchPlace { at_mm, tool, rotary_deg, direction }) in places.iter().enumerate() {
        let volume = engine.volume();
        if let Some(place) = at_mm.iter().find(|place| !volume.contains(&Vector::from(**place))) {
            let [x, y, z] = place;
            return Err(Failure::usage(notice!(OPTION;
                "{} of {name} was touched at X{x} Y{y} Z{z}, outside the calibrated volume",
                "{} нуля {name} касались в X{x} Y{y} Z{z}, вне калиброванного объёма", ["X", "Y", "Z"][axis];
                "`touched_at` takes axis commands (machine coordinates, the tool's length added); calibrate a volume that holds the place, or write zero = \"true\" where the offset was found another way",
                "`touched_at` — команды осей (координаты станка с прибавленной длиной инструмента); калибруйте объём, в котором лежит это место, или напишите zero = \"true\", если нуль найден иначе"
            )));
        }
        let tool = match tool {
            None => None,
            Some(TouchedBy::Vector(vector_mm)) => {
                let length_mm = vector_mm.map(|v| 0.0 - v);
                Some(TouchTool { vector_mm: *vector_mm, length_mm })
            }
            Some(TouchedBy::Length(number)) => match setup.tools.iter().find(|(own, _)| own == number) {
                Some((_, length_mm)) => Some(touch_tool(setup, *length_mm)),
                None => {
                    return Err(Failure::usage(notice!(OPTION;
                        "{name} was touched with H{number}, whose length is not given",
                        "{name} касались инструментом H{number}, длина которого не задана";
                        "add H{number} to `lengths_mm` under `[tool]`, or give the probe's length in mm: tool = 80.0",
                        "добавьте H{number} в `lengths_mm` раздела `[tool]` или задайте длину щупа в мм: tool = 80.0"
                    )));
                }
            },
        };
        touches[axis] = Touch { at_mm: at_mm.clone(), tool, rotary_deg: *rotary_deg, direction: *direction };
    }
    Ok(touches)
}

/// From where errors count, a sentence or two for each zero; none where it was touched at a place without error.
#[must_use]
pub fn said(datums: &[Datum]) -> Vec<Text> {
    let touched = datums.iter().filter(|datum| datum.placement != Placement::default());
    let sentences = |Datum { name, error_mm, placement, .. }: &Datum| {
        let [x, y, z] = error_mm.map(|mm| mm * 1e3);
        let off_um = (x * x + y * y + z * z).sqrt();
        let [a, b, c] = <[f64; 3]>::from(placement.turn_rad()).map(|rad| rad * 1e6);
        let shifted = both!(
            "counted from {name} as it was touched; in the measuring frame the part lies {off_um:.1} um off (X {x:.1}, Y {y:.1}, Z {z:.1})",
            "отсчёт от {name}, найденного касанием; в системе измерений деталь смещена на {off_um:.1} мкм (X {x:.1}, Y {y:.1}, Z {z:.1})"
        );
        let turned = both!(
            "and as it was dialled: in the measuring frame the part lies turned by {a:.1} urad about X, {b:.1} about Y, {c:.1} about Z",
            "и так, как выверена: в системе измерений деталь повёрнута на {a:.1} мкрад вокруг X, {b:.1} вокруг Y, {c:.1} вокруг Z"
        );
        [Some(shifted), placement.is_turned().then_some(turned)]
    };
    touched.flat_map(sentences).flatten().collect()
}
