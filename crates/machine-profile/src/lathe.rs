//! What a profile says of a lathe: spindle, headstock, tailstock, workpiece, noses.

use diagnostic::{Speaks, Text, both};
use machine_model::Vector;
use turning::{
    Bending, Clamping, ErrorMotion, Force, Harmonic, Spindle, Station, Tailstock, Tip, Workpiece,
    WorkpieceError,
};
use units::{Angle, Length};

use crate::error::{CHAIN, CONFLICT, KEY, VALUE};
use crate::format::{self, ClampingName, Document, Nose as WrittenNose};
use crate::loader::Loader;
use crate::number::{Finite, Spanned};
use crate::profile::{LatheParts, Nose};

const fn number(value: Option<Finite>) -> f64 {
    match value {
        Some(Finite(value)) => value,
        None => 0.0,
    }
}

fn um(value: Option<Finite>) -> f64 {
    Length::from_um(number(value)).mm()
}

fn urad(value: Option<Finite>) -> f64 {
    Angle::from_urad(number(value)).rad()
}

/// Two lengths of the profile, mm.
fn pair(values: Option<[Finite; 2]>) -> [f64; 2] {
    values.map_or([0.0; 2], |values| values.map(|Finite(um)| Length::from_um(um).mm()))
}

/// Cosines and sines of the harmonics from the first on: `c cos kφ + s sin kφ = a cos(kφ + p)`.
fn series(cosines: &[Finite], sines: &[Finite], scale: f64) -> Vec<Harmonic> {
    let at = |list: &[Finite], k: usize| scale * number(list.get(k).copied());
    (0..cosines.len().max(sines.len()))
        .map(|k| {
            let (c, s) = (at(cosines, k), at(sines, k));
            Harmonic {
                order: k as u32 + 1,
                amplitude: units::math::hypot(c, s),
                phase_rad: units::math::atan2(-s, c),
            }
        })
        .filter(|harmonic| harmonic.amplitude > 0.0)
        .collect()
}

/// Nothing presses.
const NO_FORCE: Force = Force::Radial { newton: 0.0 };

impl Loader<'_> {
    /// The chain of a lathe with S taken out and a Y that stands still put in; `None` for a mill.
    pub(crate) fn lathe_chain(&mut self, document: &Document) -> Option<String> {
        let text = document.chain.get_ref();
        let inner = text.trim().strip_prefix('[').and_then(|text| text.strip_suffix(']')).unwrap_or("");
        let mut links: Vec<&str> = inner.split_whitespace().collect();
        let Some(spindle) = links.iter().position(|link| *link == "S") else {
            self.no_lathe(document);
            return None;
        };
        links.remove(spindle);
        let others = links.iter().filter(|link| !["w", "b", "t", "X", "Z"].contains(link)).count();
        let sound = spindle == 1 && others == 0 && links.len() == 5 && links.last() == Some(&"t");
        if !sound {
            let message = both!("{text} is no lathe of two axes", "{text} — не двухосевой токарный станок");
            let help = both!(
                "write the spindle S behind the workpiece, the bed b, and X and Z, like \"[w S b Z X t]\"",
                "напишите после детали шпиндель S, станину b, X и Z, например \"[w S b Z X t]\""
            );
            self.refuse(&document.chain, CHAIN, message, both!("this chain", "эта цепь"), help);
        }
        if let Some(y) = &document.axis.Y {
            let message = both!("[axis.Y] on a lathe of two axes", "[axis.Y] на двухосевом токарном станке");
            let help = both!("remove it: the axes are X and Z", "уберите: оси — X и Z");
            self.refuse(y, CONFLICT, message, both!("not in the chain", "её нет в цепи"), help);
        }
        if let Some(square) = &document.squareness.EC0Y_urad {
            let message = both!(
                "EC0Y is the squareness of Y, which a lathe of two axes has not",
                "EC0Y — перпендикулярность Y, которой у двухосевого токарного станка нет"
            );
            let help = both!(
                "EB0Z is that of Z to X, EA0Z tilts Z out of the plane",
                "EB0Z — перпендикулярность Z к X, EA0Z наклоняет Z из плоскости"
            );
            self.refuse(square, CONFLICT, message, both!("no such axis", "такой оси нет"), help);
        }
        if let Some(tracker) = &document.tracker {
            let message = both!("[tracker] on a lathe", "[tracker] на токарном станке");
            let label = both!("a lathe has no three traverses", "трёх проходов у токарного станка нет");
            let help = both!(
                "give the errors of X and Z as tables: [axis.X] and [axis.Z] with errors",
                "задайте погрешности X и Z таблицами: [axis.X] и [axis.Z] с errors"
            );
            self.refuse(&tracker.x, CONFLICT, message, label, help);
        }
        links.insert(links.len().saturating_sub(1), "Y");
        Some(format!("[{}]", links.join(" ")))
    }

    /// What belongs to lathes, in the profile of a mill.
    fn no_lathe(&mut self, document: &Document) {
        let Document { spindle, headstock, tailstock, workpiece, .. } = document;
        let spans = [
            ("[spindle]", spindle.as_ref().map(Spanned::span)),
            ("[headstock]", headstock.as_ref().map(Spanned::span)),
            ("[tailstock]", tailstock.as_ref().map(Spanned::span)),
            ("[workpiece]", workpiece.as_ref().map(Spanned::span)),
            ("noses", document.tool.noses.values().next().map(Spanned::span)),
            ("turret_um", document.tool.turret_um.values().next().map(Spanned::span)),
        ];
        for (name, span) in spans.into_iter().filter_map(|(name, span)| Some((name, span?))) {
            let message = both!(
                "{name} belongs to a lathe, and the chain has no spindle",
                "{name} бывает у токарного станка, а в цепи нет шпинделя"
            );
            let help = both!(
                "write the chain of a lathe, like \"[w S b Z X t]\", or remove this",
                "напишите цепь токарного станка, например \"[w S b Z X t]\", или уберите это"
            );
            self.refuse_at(&span, CONFLICT, message, both!("of a lathe", "токарное"), help);
        }
    }

    /// Spindle, tailstock and workpiece; noses come later.
    pub(crate) fn lathe(&mut self, document: &Document) -> LatheParts {
        let nothing = format::Spindle::default();
        let written = document.spindle.as_ref().map_or(&nothing, Spanned::get_ref);
        let [x, y] = written.centre_mm.map_or([0.0; 2], |centre| centre.map(|Finite(mm)| mm));
        let growth =
            written.growth_um.map_or([0.0; 3], |growth| growth.map(|Finite(um)| Length::from_um(um).mm()));
        let (mm, rad) = (1e-3, 1e-6);
        let synchronous = ErrorMotion {
            x: series(&written.EXS_cos_um, &written.EXS_sin_um, mm),
            y: series(&written.EYS_cos_um, &written.EYS_sin_um, mm),
            z: series(&written.EZS_cos_um, &written.EZS_sin_um, mm),
            a: series(&written.EAS_cos_urad, &written.EAS_sin_urad, rad),
            b: series(&written.EBS_cos_urad, &written.EBS_sin_urad, rad),
        };
        let tailstock = document.tailstock.as_ref().map(|tailstock| {
            let tailstock = tailstock.get_ref();
            Tailstock { at_mm: tailstock.at_mm.get_ref().0, offset_mm: pair(tailstock.offset_um) }
        });
        if let Some(at) = document.tailstock.as_ref().map(|tailstock| &tailstock.get_ref().at_mm)
            && at.get_ref().0 <= 0.0
        {
            let message =
                both!("the tailstock stands at {} mm", "задняя бабка стоит в {} мм", at.get_ref().0);
            let help = both!(
                "at_mm counts from the chuck's face (face_mm of [spindle]) towards +Z",
                "at_mm отсчитывается от торца патрона (face_mm в [spindle]) в сторону +Z"
            );
            self.refuse(at, VALUE, message, both!("expected above 0", "ожидалось больше 0"), help);
        }
        let (bending, bears, bar) = self.workpiece(document, tailstock);
        let spindle = Spindle {
            centre_mm: Vector::new(x, y, number(written.face_mm)),
            shift_mm: Vector::new(
                um(written.EX0S_um) + growth[0],
                um(written.EY0S_um) + growth[1],
                growth[2],
            ),
            tilt_rad: [urad(written.EA0S_urad), urad(written.EB0S_urad)],
            headstock_mm: pair(document.headstock.as_ref().map(|head| head.get_ref().offset_um)),
            tailstock: tailstock.filter(|_| bears),
            synchronous,
            asynchronous_mm: um(written.asynchronous_um),
        };
        let tip = Tip {
            height_mm: 0.0,
            gamma_rad: urad(document.tool.gamma_urad),
            omega_rad: urad(document.tool.omega_urad),
        };
        LatheParts {
            chain: document.chain.get_ref().clone(),
            spindle,
            bending,
            bar,
            tip,
            stations: Vec::new(),
            noses: Vec::new(),
        }
    }

    /// The force on the tip along X.
    fn force(&mut self, spanned: &Spanned<format::Workpiece>) -> Force {
        let written = spanned.get_ref();
        match (&written.radial_force_n, written.specific_force_n_mm2) {
            (Some(force), None) => Force::Radial { newton: force.get_ref().0 },
            (None, Some(Finite(specific_n_mm2))) => match (written.depth_mm, written.feed_mm) {
                (Some(Finite(depth_mm)), Some(Finite(feed_mm))) => {
                    Force::Cut { specific_n_mm2, depth_mm, feed_mm }
                }
                _ => {
                    let message = both!(
                        "specific_force_n_mm2 without depth_mm and feed_mm",
                        "specific_force_n_mm2 без depth_mm и feed_mm"
                    );
                    let help = both!(
                        "add the depth of cut on the radius and the feed a turn, or give radial_force_n",
                        "добавьте глубину резания по радиусу и подачу на оборот или задайте radial_force_n"
                    );
                    self.refuse(spanned, KEY, message, both!("of this workpiece", "у этой детали"), help);
                    NO_FORCE
                }
            },
            (None, None) => NO_FORCE,
            (Some(force), Some(_)) => {
                let message = both!(
                    "both radial_force_n and specific_force_n_mm2",
                    "и radial_force_n, и specific_force_n_mm2"
                );
                let help = both!("give one of the two", "задайте одно из двух");
                self.refuse(force, CONFLICT, message, both!("counted twice", "учтено дважды"), help);
                NO_FORCE
            }
        }
    }

    /// How far the workpiece bends, whether the tailstock bears it, and the bar itself.
    fn workpiece(
        &mut self,
        document: &Document,
        tailstock: Option<Tailstock>,
    ) -> (Bending, bool, Option<Workpiece>) {
        let Some(spanned) = &document.workpiece else {
            return (Bending::default(), tailstock.is_some(), None);
        };
        let written = spanned.get_ref();
        let force = self.force(spanned);
        let tail = |this: &mut Self| match tailstock {
            Some(Tailstock { at_mm, .. }) => Some(at_mm),
            None => {
                let message = both!(
                    "a clamping with a tailstock, and no [tailstock]",
                    "закрепление с задней бабкой, а раздела [tailstock] нет"
                );
                let help = both!(
                    "add [tailstock] with at_mm, its centre from the chuck's face",
                    "добавьте [tailstock] с at_mm — местом центра от торца патрона"
                );
                this.refuse(spanned, KEY, message, both!("of this workpiece", "у этой детали"), help);
                None
            }
        };
        let clamping = match written.clamping {
            Some(ClampingName::Chuck) => Some(Clamping::Chuck),
            Some(ClampingName::ChuckTailstock) => {
                tail(self).map(|at_mm| Clamping::ChuckAndTailstock { at_mm })
            }
            Some(ClampingName::Centres) => tail(self).map(|at_mm| Clamping::Centres { at_mm }),
            None if force.newton() == 0.0 => return (Bending::default(), tailstock.is_some(), None),
            None => {
                let message = both!("a cutting force without clamping", "сила резания без закрепления");
                let help = both!(
                    "add clamping = \"chuck\", \"chuck-tailstock\" or \"centres\" under [workpiece]",
                    "добавьте clamping = \"chuck\", \"chuck-tailstock\" или \"centres\" в раздел [workpiece]"
                );
                self.refuse(spanned, KEY, message, both!("how is it held?", "как она закреплена?"), help);
                None
            }
        };
        let Some(clamping) = clamping else { return (Bending::default(), false, None) };
        let bears = !matches!(clamping, Clamping::Chuck);
        let (Some(diameters), Some(modulus)) = (&written.diameters_mm, &written.e_gpa) else {
            if force.newton() != 0.0 {
                let message = both!(
                    "a cutting force without diameters_mm and e_gpa",
                    "сила резания без diameters_mm и e_gpa"
                );
                let help = both!(
                    "add diameters_mm = [[0, 40], [300, 40]] and e_gpa = 210.0 under [workpiece]",
                    "добавьте diameters_mm = [[0, 40], [300, 40]] и e_gpa = 210.0 в раздел [workpiece]"
                );
                self.refuse(spanned, KEY, message, both!("how stiff is it?", "какова её жёсткость?"), help);
            }
            return (Bending::default(), bears, None);
        };
        let bar = Workpiece {
            diameters_mm: diameters.get_ref().iter().map(|row| row.map(|Finite(mm)| mm)).collect(),
            youngs_modulus_n_mm2: modulus.get_ref().0 * 1e3,
            clamping,
            steady_rests_mm: written.steady_mm.iter().map(|Finite(mm)| *mm).collect(),
        };
        match Bending::new(&bar, force) {
            Ok(bending) => (bending, bears, Some(bar)),
            Err(error) => {
                let help = match error {
                    WorkpieceError::BeyondTheBar { .. } => {
                        both!(
                            "diameters_mm reach from the chuck's face to the bar's end; at_mm and steady_mm count from there too",
                            "diameters_mm идут от торца патрона до конца прутка; at_mm и steady_mm отсчитываются оттуда же"
                        )
                    }
                    WorkpieceError::Modulus(_) => both!("steel has e_gpa = 210.0", "у стали e_gpa = 210.0"),
                    WorkpieceError::Twice { .. } => both!("leave one of them out", "уберите одну из них"),
                    _ => {
                        both!(
                            "write Z from the chuck's face and diameter, like diameters_mm = [[0, 40], [300, 40]]",
                            "напишите Z от торца патрона и диаметр, например diameters_mm = [[0, 40], [300, 40]]"
                        )
                    }
                };
                self.refuse(spanned, VALUE, error.text(), both!("this workpiece", "эта деталь"), help);
                (Bending::default(), bears, None)
            }
        }
    }

    /// Stations of the turret that err; `tools` with the heights of their noses.
    ///
    /// A station is known by the vector of its tool: two of one vector that err otherwise cannot be told apart.
    pub(crate) fn stations(&mut self, written: &format::Tool, tools: &[(u32, [f64; 3])]) -> Vec<Station> {
        let vector = |length: &[f64; 3]| -Vector::from(*length);
        let mut stations: Vec<Station> = Vec::new();
        for (name, shift) in &written.turret_um {
            let number = name.strip_prefix('H').and_then(|digits| digits.parse::<u32>().ok());
            let Some((own, length)) = tools.iter().find(|(known, _)| Some(*known) == number) else {
                let message = both!(
                    "`{name}` under turret_um is no tool of lengths_mm",
                    "`{name}` в turret_um — не инструмент из lengths_mm"
                );
                let help = both!(
                    "write the same H number in both, like H1",
                    "напишите в обоих один номер H, например H1"
                );
                self.refuse(shift, KEY, message, both!("of this entry", "в этой записи"), help);
                continue;
            };
            let station = Station { tool_mm: vector(length), shift_mm: pair(Some(*shift.get_ref())) };
            let told_apart = |(other, other_length): &&(u32, [f64; 3])| {
                let other_shift =
                    written.turret_um.get(&format!("H{other}")).map(|shift| pair(Some(*shift.get_ref())));
                other != own
                    && vector(other_length) == station.tool_mm
                    && other_shift != Some(station.shift_mm)
            };
            let default = written.default_mm.map_or([0.0; 3], |default| default.map(|Finite(mm)| mm));
            let twin = tools.iter().find(told_apart).map(|(other, _)| format!("H{other}"));
            let twin = twin.or((Vector::from(default) == station.tool_mm).then(|| "default_mm".to_owned()));
            if let Some(twin) = twin {
                let message = both!(
                    "{name} under turret_um has the length of {twin}, whose station errs otherwise",
                    "у {name} в turret_um та же длина, что у {twin}, а погрешность позиции другая"
                );
                let label = both!("which of the two is it?", "какая из двух?");
                let help = both!(
                    "a station is known by its tool: write the lengths that the tools have",
                    "позиция узнаётся по инструменту: впишите настоящие вылеты инструментов"
                );
                self.refuse(shift, CONFLICT, message, label, help);
            }
            stations.push(station);
        }
        stations
    }

    /// Noses by number; a tip's height becomes the Y of its tool's vector.
    pub(crate) fn noses(
        &mut self,
        written: &format::Tool,
        tools: &mut [(u32, [f64; 3])],
    ) -> Vec<(u32, Nose)> {
        let mut noses = Vec::new();
        for (name, nose) in &written.noses {
            let number = name.strip_prefix('H').and_then(|digits| digits.parse::<u32>().ok());
            let tool = tools.iter_mut().find(|(known, _)| Some(*known) == number);
            let (Some(number), Some((_, length))) = (number, tool) else {
                let message = both!(
                    "`{name}` under noses is no tool of lengths_mm",
                    "`{name}` в noses — не инструмент из lengths_mm"
                );
                let help = both!(
                    "write the same H number in both, like H1",
                    "напишите в обоих один номер H, например H1"
                );
                self.refuse(nose, KEY, message, both!("of this entry", "в этой записи"), help);
                continue;
            };
            let WrittenNose { radius_mm: Finite(radius_mm), direction, height_um, minor_edge_deg } =
                *nose.get_ref();
            if radius_mm < 0.0 || direction.is_some_and(|direction| direction > 9) {
                let message = both!(
                    "a nose's radius is 0 or more, its direction 0 to 9",
                    "радиус при вершине — 0 или больше, направление — от 0 до 9"
                );
                self.refuse(nose, VALUE, message, both!("this nose", "эта вершина"), Text::EMPTY);
            }
            // The tool vector is minus the length.
            length[1] -= um(height_um);
            let minor_edge_rad = minor_edge_deg.map(|Finite(deg)| Angle::from_deg(deg).rad());
            noses.push((number, Nose { radius_mm, direction, minor_edge_rad }));
        }
        noses.sort_by_key(|(number, _)| *number);
        noses
    }
}
