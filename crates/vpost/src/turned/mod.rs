//! Forward for a lathe: what a program leaves of the workpiece.

mod page;
mod wear;

use diagnostic::{Code, both, notice};
use jobs::turned::read;
use jobs::turned::surface::{Asked, HIGHEST_WAVE, Surface, Turned};
use machine_profile::Profile;
use rewrite::Manner;
use turning::Lathe;

use crate::arguments::{Predict, Shared};
use crate::conditions::{conditions, failure};
use crate::figures::fixed;
use crate::file;
use crate::message::{Failure, Messages, OPTION};
use crate::roles::Roles;
use crate::settings::Settings;

use page::{Correction, Facts};

/// Nothing is turned, or too much is asked.
const NOTHING_TURNED: Code = Code(908);

/// `vpost predict --lathe PROGRAM -m PROFILE`
pub(crate) fn run(arguments: &Predict, shared: &Shared, messages: &Messages) -> Result<(), Failure> {
    let settings = crate::settings::load(shared, messages)?;
    Roles::default()
        .reads(both!("the program", "программа"), &arguments.points)
        .reads_all(&both!("read by the profile", "файл, который читает профиль"), &settings.files)
        .writes("--html", arguments.html.as_deref())
        .are_apart()?;
    let lathe = settings.profile.lathe(&conditions(&shared.job)?).map_err(|error| failure(&error))?;
    let lathe = lathe.ok_or_else(|| no_lathe(&settings.profile_name, &settings.profile))?;
    if !(arguments.step > 0.0 && arguments.step.is_finite()) {
        return Err(Failure::usage(notice!(OPTION;
            "`--step {}` is no distance", "`--step {}` — не расстояние", arguments.step;
            "write millimetres, like `--step 0.5`", "напишите миллиметры, например `--step 0.5`"
        )));
    }
    let name = file::name(&arguments.points);
    let text = file::read_program(&arguments.points)?;
    let cuts = read(&text, &name, &settings)?;
    let asked = Asked { step_mm: arguments.step, bore: arguments.bore };
    let mut surface = Surface::over(&cuts, &lathe, &asked).ok_or_else(|| {
        let diagnostic = notice!(NOTHING_TURNED;
            "the program turns nothing that could be predicted",
            "программа ничего не точит, предсказывать нечего";
            "feeds (G1, G2, G3) that move along Z are needed; with `--step` there may be up to 200000 places",
            "нужны рабочие ходы (G1, G2, G3) вдоль Z; мест с шагом `--step` может быть до 200000"
        );
        Failure::refused(&name, &text, vec![diagnostic])
    })?;
    cuts.iter().for_each(|cut| surface.cut(cut, &lathe));
    let turned = surface.turned(&lathe, &settings, &cuts);
    if let Some(path) = &arguments.html {
        let correction = correction((&name, &text), (&surface, &lathe), &settings)?;
        let facts = Facts { name: &name, text: &text, settings: &settings, at_mm: &arguments.section };
        let html = page::html(&facts, (&surface, &turned), &correction, &lathe, messages.language())?;
        file::write(path, html.as_bytes())?;
    }
    let out = match (arguments.wear, arguments.json) {
        (true, _) => wear::list(&surface, &turned, &settings).into_bytes(),
        (false, true) => jobs::summary::json(&turned),
        (false, false) => csv(&turned).into_bytes(),
    };
    file::print(&out)
}

fn no_lathe(name: &str, profile: &Profile) -> Failure {
    Failure::usage(notice!(OPTION;
        "{name} is no lathe: its chain is {}", "{name} — не токарный станок: его цепь — {}", profile.chain();
        "leave `--lathe` out, or give the profile of a lathe",
        "уберите `--lathe` или дайте профиль токарного станка"
    ))
}

/// What the main job makes of the program, and what the lathe turns by that. A refusal is an answer.
fn correction(
    (name, text): (&str, &[u8]),
    (surface, lathe): (&Surface, &Lathe),
    settings: &Settings,
) -> Result<Correction, Failure> {
    let manner = Manner { force: false, threads: 1, hashes: false };
    match jobs::correct::text(text, name, settings, manner, |_| Ok(())) {
        Ok((_, program)) if !program.changed => Ok(Correction::Unchanged),
        Ok((corrected, _)) => {
            let cuts = read(&corrected, name, settings)?;
            Ok(Correction::Turned(surface.corrected(&cuts, lathe).turned(lathe, settings, &cuts)))
        }
        Err(failure @ Failure::Refused(_)) => Ok(Correction::Refused(failure)),
        Err(failure) => Err(failure),
    }
}

fn csv(turned: &Turned) -> String {
    let mut out = String::from(
        "z_mm,radius_mm,diameter_mm,nominal_radius_mm,radius_error_um,roundness_um,roundness_zone_um,roughness_um,roughness_usual_um",
    );
    for order in 2..=HIGHEST_WAVE {
        out.push_str(&format!(",wave_{order}_um"));
    }
    out.push('\n');
    for p in &turned.places {
        let radii = [p.radius_mm, p.diameter_mm, p.nominal_radius_mm].map(|mm| fixed(mm, 9));
        let um = |um: f64| fixed(um, 6);
        let or_nothing = |value: Option<f64>| value.map_or_else(String::new, um);
        let mut cells = vec![um(p.z_mm)];
        cells.extend(radii);
        cells.extend([p.radius_error_um, p.roundness_um, p.roundness_zone_um].map(um));
        cells.extend([p.roughness_um, p.roughness_usual_um].map(or_nothing));
        cells.extend(p.waves_um.iter().copied().map(um));
        out.push_str(&(cells.join(",") + "\n"));
    }
    out
}
