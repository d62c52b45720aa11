//! What a profile says of a lathe: spindle, headstock, tailstock, workpiece, noses.

use diagnostic::Diagnostic;
use machine_model::Vector;
use toml::Spanned;
use turning::{
    Bending, Clamping, ErrorMotion, Force, Harmonic, Spindle, Tailstock, Tip, Workpiece, WorkpieceError,
};
use units::{Angle, Length};

use crate::error::{CHAIN, CONFLICT, KEY, ProfileError, VALUE};
use crate::format::{self, ClampingName, Document, Finite, Nose as WrittenNose};
use crate::load::Loader;
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
            let diagnostic = Diagnostic::error(CHAIN, format!("{text} is no lathe of two axes")).help(
                "write the spindle S behind the workpiece, the bed b, and X and Z, like \"[w S b Z X t]\"",
            );
            self.refuse(&document.chain, diagnostic, "this chain");
        }
        if let Some(y) = &document.axis.Y {
            let diagnostic = Diagnostic::error(CONFLICT, "[axis.Y] on a lathe of two axes")
                .help("remove it: the axes are X and Z");
            self.refuse(y, diagnostic, "not in the chain");
        }
        if let Some(square) = &document.squareness.EC0Y_urad {
            let diagnostic =
                Diagnostic::error(CONFLICT, "EC0Y is the squareness of Y, which a lathe of two axes has not")
                    .help("EB0Z is that of Z to X, EA0Z tilts Z out of the plane");
            self.refuse(square, diagnostic, "no such axis");
        }
        if let Some(tracker) = &document.tracker {
            let diagnostic = Diagnostic::error(CONFLICT, "[tracker] on a lathe")
                .help("give the errors of X and Z as tables: [axis.X] and [axis.Z] with errors");
            self.refuse(&tracker.x, diagnostic, "a lathe has no three traverses");
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
        ];
        for (name, span) in spans.into_iter().filter_map(|(name, span)| Some((name, span?))) {
            let diagnostic = Diagnostic::error(
                CONFLICT,
                format!("{name} belongs to a lathe, and the chain has no spindle"),
            )
            .at(crate::error::span(&span), "of a lathe")
            .help("write the chain of a lathe, like \"[w S b Z X t]\", or remove this");
            self.errors.push(ProfileError::profile(diagnostic));
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
            let diagnostic =
                Diagnostic::error(VALUE, format!("the tailstock stands at {} mm", at.get_ref().0))
                    .help("at_mm counts from the chuck's face (face_mm of [spindle]) towards +Z");
            self.refuse(at, diagnostic, "expected above 0");
        }
        let (bending, bears) = self.workpiece(document, tailstock);
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
        LatheParts { chain: document.chain.get_ref().clone(), spindle, bending, tip, noses: Vec::new() }
    }

    /// How far the workpiece bends, and whether the tailstock bears it.
    fn workpiece(&mut self, document: &Document, tailstock: Option<Tailstock>) -> (Bending, bool) {
        let Some(spanned) = &document.workpiece else { return (Bending::default(), tailstock.is_some()) };
        let written = spanned.get_ref();
        let force = match (&written.radial_force_n, written.specific_force_n_mm2) {
            (Some(force), None) => Force::Radial { newton: force.get_ref().0 },
            (None, Some(Finite(specific_n_mm2))) => match (written.depth_mm, written.feed_mm) {
                (Some(Finite(depth_mm)), Some(Finite(feed_mm))) => {
                    Force::Cut { specific_n_mm2, depth_mm, feed_mm }
                }
                _ => {
                    let diagnostic =
                        Diagnostic::error(KEY, "specific_force_n_mm2 without depth_mm and feed_mm").help(
                            "add the depth of cut on the radius and the feed a turn, or give radial_force_n",
                        );
                    self.refuse(spanned, diagnostic, "of this workpiece");
                    NO_FORCE
                }
            },
            (None, None) => NO_FORCE,
            (Some(force), Some(_)) => {
                let diagnostic = Diagnostic::error(CONFLICT, "both radial_force_n and specific_force_n_mm2")
                    .help("give one of the two");
                self.refuse(force, diagnostic, "counted twice");
                NO_FORCE
            }
        };
        let tail = |this: &mut Self| match tailstock {
            Some(Tailstock { at_mm, .. }) => Some(at_mm),
            None => {
                let diagnostic = Diagnostic::error(KEY, "a clamping with a tailstock, and no [tailstock]")
                    .help("add [tailstock] with at_mm, its centre from the chuck's face");
                this.refuse(spanned, diagnostic, "of this workpiece");
                None
            }
        };
        let clamping = match written.clamping {
            Some(ClampingName::Chuck) => Some(Clamping::Chuck),
            Some(ClampingName::ChuckTailstock) => {
                tail(self).map(|at_mm| Clamping::ChuckAndTailstock { at_mm })
            }
            Some(ClampingName::Centres) => tail(self).map(|at_mm| Clamping::Centres { at_mm }),
            None if force.newton() == 0.0 => return (Bending::default(), tailstock.is_some()),
            None => {
                let diagnostic = Diagnostic::error(KEY, "a cutting force without clamping")
                    .help("add clamping = \"chuck\", \"chuck-tailstock\" or \"centres\" under [workpiece]");
                self.refuse(spanned, diagnostic, "how is it held?");
                None
            }
        };
        let Some(clamping) = clamping else { return (Bending::default(), false) };
        let bears = !matches!(clamping, Clamping::Chuck);
        let (Some(diameters), Some(modulus)) = (&written.diameters_mm, &written.e_gpa) else {
            if force.newton() != 0.0 {
                let diagnostic = Diagnostic::error(KEY, "a cutting force without diameters_mm and e_gpa")
                    .help("add diameters_mm = [[0, 40], [300, 40]] and e_gpa = 210.0 under [workpiece]");
                self.refuse(spanned, diagnostic, "how stiff is it?");
            }
            return (Bending::default(), bears);
        };
        let bar = Workpiece {
            diameters_mm: diameters.get_ref().iter().map(|row| row.map(|Finite(mm)| mm)).collect(),
            youngs_modulus_n_mm2: modulus.get_ref().0 * 1e3,
            clamping,
            steady_rests_mm: written.steady_mm.iter().map(|Finite(mm)| *mm).collect(),
        };
        match Bending::new(&bar, force) {
            Ok(bending) => (bending, bears),
            Err(error) => {
                let help = match error {
                    WorkpieceError::BeyondTheBar { .. } => {
                        "diameters_mm reach from the chuck's face to the bar's end; at_mm and steady_mm count from there too"
                    }
                    WorkpieceError::Modulus(_) => "steel has e_gpa = 210.0",
                    WorkpieceError::Twice { .. } => "leave one of them out",
                    _ => {
                        "write Z from the chuck's face and diameter, like diameters_mm = [[0, 40], [300, 40]]"
                    }
                };
                let diagnostic = Diagnostic::error(VALUE, error.to_string()).help(help);
                self.refuse(spanned, diagnostic, "this workpiece");
                (Bending::default(), bears)
            }
        }
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
                let diagnostic =
                    Diagnostic::error(KEY, format!("`{name}` under noses is no tool of lengths_mm"))
                        .help("write the same H number in both, like H1");
                self.refuse(nose, diagnostic, "of this entry");
                continue;
            };
            let WrittenNose { radius_mm: Finite(radius_mm), direction, height_um, minor_edge_deg } =
                *nose.get_ref();
            if radius_mm < 0.0 || direction.is_some_and(|direction| direction > 9) {
                let diagnostic =
                    Diagnostic::error(VALUE, "a nose's radius is 0 or more, its direction 0 to 9");
                self.refuse(nose, diagnostic, "this nose");
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
