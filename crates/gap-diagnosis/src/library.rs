//! The candidates: every effect the data could show, in its textbook form and bent ones.

use machine_model::effects::{EffectKind, Shape};

use crate::noise::median;
use crate::observation::{Measurements, Reading, Row};
use crate::term::Term;

/// One form of an effect: columns of the design.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Variant {
    /// Positions in [`Library::terms`].
    pub columns: Vec<usize>,
    /// True for forms that only bend the textbook form.
    pub enriched: bool,
    /// True for forms that these rows sample too coarsely to be named: a wave seen at less than two places per
    /// period can be any curve. They stay rivals.
    pub only_rival: bool,
}

/// One effect with all its forms.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Candidate {
    /// Which.
    pub kind: EffectKind,
    /// Its forms.
    pub variants: Vec<Variant>,
    /// Forms that were looked at and not kept, so that looking has its price.
    pub rejected: usize,
}

impl Candidate {
    /// Number of forms the data were asked about.
    #[must_use]
    pub(crate) fn asked(&self) -> usize {
        self.variants.len() + self.rejected
    }
}

/// All columns and all candidates.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Library {
    /// Set-up columns first, then those of the effects.
    pub terms: Vec<Term>,
    /// How many of the columns are the measuring frame's and the runs' angles.
    pub framing: usize,
    /// How many of the columns are set-up: these, and what the instruments add.
    pub nuisances: usize,
    /// The effects.
    pub candidates: Vec<Candidate>,
}

/// Places along an axis where damage is looked for; finer ones are proposed by the search.
const LOCAL_PLACES: usize = 14;
/// Times at which a knock is looked for; finer ones are proposed by the search.
const STEP_TIMES: usize = 24;
/// A joint is proposed by the search where an axis has so many places: with fewer it is any curve.
pub(crate) const JOINT_PLACES: f64 = 8.0;
/// Ways over which a spike at a turning point fades, mm.
const SPIKES_MM: [f64; 5] = [0.75, 1.5, 3.0, 6.0, 12.0];
/// Time constants as shares of the time the measurement took.
const TAU_SHARES: [f64; 6] = [0.03, 0.08, 0.2, 0.5, 1.2, 3.0];

/// What the rows vary in.
struct Seen {
    /// Number of different places per axis.
    places: [usize; 3],
    /// Of these, as many as a curve can tell apart.
    effective: [f64; 3],
    /// Narrowest damage that these places could show.
    narrowest_mm: [f64; 3],
    range: [(f64, f64); 3],
    direction: [bool; 3],
    unknown_direction: [bool; 3],
    temperature: [bool; 3],
    time: Option<(f64, f64)>,
    load: bool,
    feed: bool,
    /// Different loads.
    loads: usize,
    rotary: [bool; 3],
    /// Readings are lengths of a bar.
    lengths: bool,
    /// Tools of different lengths.
    tools: bool,
    /// Every row has its station's place.
    station: bool,
    /// Typical step between rows that are read while an axis moves on after it turned, mm; infinite where none is.
    turns_mm: [f64; 3],
    /// Levers, by the axis that carries and the direction turned about, that are one number all over a file of lengths: on
    /// such a circle an angle is a straightness, a squareness or a scale, as ISO 230-4 has it.
    one_lever: [[bool; 3]; 3],
}

impl Seen {
    /// True where an effect of this kind may have so many coefficients: a curve along an axis at most half of the places
    /// measured there, shift and slope (which are the set-up's) left over for two more.
    fn carry(&self, kind: EffectKind, coefficients: usize) -> bool {
        curve_axis(kind).is_none_or(|axis| {
            let places = self.effective[axis];
            2.0 * coefficients as f64 <= places && coefficients as f64 + 2.0 <= places
        })
    }

    fn new(data: &Measurements) -> Self {
        let rows = &data.rows;
        let varies = |value: &dyn Fn(&Row) -> Option<f64>| range(rows, value).is_some_and(|(a, b)| b > a);
        let places = [0, 1, 2].map(|a| data.places_mm(a).len());
        Self {
            places,
            // Half a place is rounding.
            effective: [0, 1, 2].map(|a| data.effective_places(a) + 0.5),
            narrowest_mm: [0, 1, 2].map(|a| narrowest_mm(data, a)),
            range: [0, 1, 2].map(|a| data.range_mm(a)),
            direction: [0, 1, 2].map(|a| {
                let has = |d: i8| rows.iter().any(|r| r.command.direction[a] == d);
                has(1) && has(-1)
            }),
            unknown_direction: [0, 1, 2].map(|a| rows.iter().any(|r| r.command.direction[a] == 0)),
            temperature: [0, 1, 2].map(|a| {
                range(rows, &|r| r.conditions.temp_c[a])
                    .is_some_and(|(low, high)| high > low || high != data.geometry.reference_temp_c)
            }),
            time: range(rows, &|r| r.conditions.time_s).filter(|(a, b)| b > a),
            load: varies(&|r| r.conditions.load_kg),
            feed: rows.iter().any(|r| r.conditions.feed_mm_min.is_some_and(|f| f > 0.0)),
            loads: distinct(rows, &|r| r.conditions.load_kg),
            rotary: [0, 1, 2]
                .map(|a| data.geometry.has_rotary(a) && varies(&|r| Some(r.command.rotary_rad[a]))),
            lengths: data.has_lengths(),
            tools: varies(&|r| Some(r.command.tool_mm.z)),
            station: rows.iter().all(|r| r.conditions.station_mm.is_some()),
            turns_mm: [0, 1, 2].map(|a| step_after_turning(rows, a)),
            one_lever: [0, 1, 2].map(|axis| [0, 1, 2].map(|about| one_lever(data, about, axis))),
        }
    }
}

/// Median difference of the ways since an axis turned, of rows in a row that are nearer to the turn than thirty steps.
fn step_after_turning(rows: &[Row], axis: usize) -> f64 {
    let pairs = rows.windows(2).filter(|w| w[0].run == w[1].run);
    let ways = pairs
        .filter_map(|w| Some((w[0].conditions.since_turn_mm[axis]?, w[1].conditions.since_turn_mm[axis]?)));
    let mut steps: Vec<f64> =
        ways.filter(|(a, b)| b > a && *a < 30.0 * (b - a)).map(|(a, b)| b - a).collect();
    if steps.len() < 12 { f64::INFINITY } else { median(&mut steps).unwrap_or(f64::INFINITY) }
}

/// True where a rotation about a direction along an axis acts, in what the rows see, through levers that never change.
fn one_lever(data: &Measurements, about: usize, axis: usize) -> bool {
    /// Share of the lever that it may change by, and a change that is none, mm.
    const SAME: f64 = 0.01;
    let mut range = [(f64::INFINITY, f64::NEG_INFINITY); 3];
    for row in &data.rows {
        let lever = data.geometry.lever_mm(axis, &row.command);
        let moved = crate::term::unit(about).cross(&lever);
        let seen = match row.reading {
            Reading::Displacement(components) => components.map(|c| c.is_some()),
            Reading::Magnitude(_) => [true; 3],
            Reading::Length { ball_mm, .. } => {
                let bar = data.geometry.nominal_tip_mm(&row.command) - ball_mm;
                [0, 1, 2].map(|c| bar[c].abs() > SAME * bar.norm())
            }
        };
        for c in (0..3).filter(|c| seen[*c]) {
            range[c] = (range[c].0.min(moved[c]), range[c].1.max(moved[c]));
        }
    }
    // Vectors show what a length in one plane never does.
    data.has_lengths()
        && range
            .iter()
            .all(|(low, high)| high - low <= SAME * low.abs().max(high.abs()).max(1.0) || high < low)
}

/// The axis along which an effect is a curve.
#[must_use]
pub(crate) const fn curve_axis(kind: EffectKind) -> Option<usize> {
    match kind {
        EffectKind::Positioning(axis)
        | EffectKind::Straightness { axis, .. }
        | EffectKind::Angular { axis, .. }
        | EffectKind::Pitch(axis)
        | EffectKind::Sag(axis) => Some(axis),
        _ => None,
    }
}

/// A bump narrower than this falls between the places measured: two and a half steps between them.
#[must_use]
pub(crate) fn narrowest_mm(data: &Measurements, axis: usize) -> f64 {
    let places = data.places_mm(axis);
    let mut steps: Vec<f64> = places.windows(2).map(|w| w[1] - w[0]).collect();
    2.5 * median(&mut steps).unwrap_or(0.0)
}

fn distinct(rows: &[Row], value: &dyn Fn(&Row) -> Option<f64>) -> usize {
    let mut values: Vec<f64> = rows.iter().filter_map(value).collect();
    values.sort_by(f64::total_cmp);
    values.dedup();
    values.len()
}

fn range(rows: &[Row], value: &dyn Fn(&Row) -> Option<f64>) -> Option<(f64, f64)> {
    let mut known = rows.iter().filter_map(value);
    let first = known.next()?;
    Some(known.fold((first, first), |(low, high), v| (low.min(v), high.max(v))))
}

/// Columns of the measuring frame: shift and rotation, and where runs are turned against each other, those of every run
/// about its middle.
#[must_use]
pub(crate) fn frame(data: &Measurements, turned: bool) -> Vec<Term> {
    let mut terms: Vec<Term> = (0..3).map(Term::SetupShift).chain((0..3).map(Term::SetupRotation)).collect();
    for run in 0..if turned { data.runs.len() } else { 0 } {
        let tips =
            || data.rows.iter().filter(|r| r.run == run).map(|r| r.command.linear_mm + r.command.tool_mm);
        let count = tips().count().max(1) as f64;
        let centre_mm: [f64; 3] = (tips().sum::<machine_model::Vector>() / count).into();
        terms.extend((0..3).map(|about| Term::RunRotation { run, about, centre_mm }));
    }
    terms
}

/// Columns of the zero of every instrument, and of the frame of every station, but the first.
fn instruments(data: &Measurements) -> Vec<Term> {
    let count = data.rows.iter().filter_map(|r| r.instrument).max().map_or(0, |m| m + 1);
    let zeros =
        (1..count).flat_map(|instrument| (0..3).map(move |axis| Term::InstrumentShift { instrument, axis }));
    let stations = data.rows.iter().filter_map(|r| r.station).max().map_or(0, |m| m + 1);
    let frames = (1..stations)
        .flat_map(|station| (0..6).map(move |component| Term::StationFrame { station, component }));
    zeros.chain(frames).collect()
}

impl Library {
    /// Every effect whose columns the rows hold, except those in `without`; `turned`: every run has angles of its own.
    #[must_use]
    pub(crate) fn new(data: &Measurements, without: &[EffectKind], turned: bool) -> Self {
        let seen = Seen::new(data);
        let mut terms = frame(data, turned);
        let framing = terms.len();
        terms.extend(instruments(data));
        if data.has_lengths() {
            terms.push(Term::BarLength);
        }
        for axis in 0..3 {
            if seen.direction[axis] && seen.unknown_direction[axis] {
                terms.push(Term::UnknownApproach(axis));
            }
        }
        let nuisances = terms.len();
        let mut library = Self { terms, framing, nuisances, candidates: Vec::new() };
        for kind in EffectKind::all().into_iter().filter(|k| !without.contains(k)) {
            let mut variants = library.forms(kind, &seen);
            variants.retain(|form| seen.carry(kind, form.columns.len()));
            if !variants.is_empty() {
                library.candidates.push(Candidate { kind, variants, rejected: 0 });
            }
        }
        library
    }

    /// Adds columns of an effect, unless they are there, and returns their positions.
    pub(crate) fn add_columns(&mut self, kind: EffectKind, shape: Shape, indices: &[usize]) -> Vec<usize> {
        let place = |term: Term, terms: &mut Vec<Term>| {
            terms.iter().position(|t| *t == term).unwrap_or_else(|| {
                terms.push(term);
                terms.len() - 1
            })
        };
        indices.iter().map(|i| place(Term::Effect { kind, index: *i, shape }, &mut self.terms)).collect()
    }

    /// Adds forms to an effect, as the search proposes them; `asked`: how many were looked at to find them.
    pub(crate) fn add_variants(&mut self, kind: EffectKind, variants: Vec<Variant>, asked: usize) {
        if let Some(candidate) = self.candidates.iter_mut().find(|c| c.kind == kind) {
            for variant in variants {
                if candidate.variants.iter().all(|v| v.columns != variant.columns) {
                    candidate.variants.push(variant);
                }
            }
            candidate.rejected = candidate.rejected.max(asked);
        } else {
            self.candidates.push(Candidate { kind, variants, rejected: asked });
        }
    }

    /// Forms made of a list of coefficient indices each; the first list is the textbook form.
    pub(crate) fn selections(&mut self, kind: EffectKind, shape: Shape, lists: &[&[usize]]) -> Vec<Variant> {
        let mut indices: Vec<usize> = lists.iter().flat_map(|l| l.iter().copied()).collect();
        indices.sort_unstable();
        indices.dedup();
        let columns = self.add_columns(kind, shape, &indices);
        let at = |index: &usize| indices.iter().position(|i| i == index).map_or(0, |p| columns[p]);
        let pick = |(place, list): (usize, &&[usize])| Variant {
            columns: list.iter().map(at).collect(),
            enriched: place > 0,
            only_rival: false,
        };
        lists.iter().enumerate().map(pick).collect()
    }

    fn forms(&mut self, kind: EffectKind, seen: &Seen) -> Vec<Variant> {
        let travels = |a: usize| seen.range[a].1 - seen.range[a].0 > 1e-6;
        let interval =
            |a: usize| Shape { from_mm: seen.range[a].0, to_mm: seen.range[a].1, ..Shape::default() };
        let none = Shape::default();
        match kind {
            EffectKind::Scale(a) if travels(a) => self.selections(kind, none, &[&[0]]),
            EffectKind::Squareness(a, b) if travels(a) && travels(b) => self.selections(kind, none, &[&[0]]),
            EffectKind::Backlash(a) | EffectKind::LostMotion { axis: a, .. } if seen.direction[a] => {
                self.selections(kind, interval(a), &[&[0], &[0, 1], &[0, 1, 2, 3]])
            }
            EffectKind::Thermal(a) if seen.temperature[a] && travels(a) => {
                self.selections(kind, none, &[&[0, 1], &[0], &[0, 1, 2]])
            }
            EffectKind::Warmup(_) => self.warmup(kind, seen),
            EffectKind::Positioning(a) | EffectKind::Straightness { axis: a, .. } if travels(a) => {
                let lists: [&[usize]; 5] = [&[0, 1], &[0], &[1], &[0, 1, 2, 3], &[0, 1, 2, 3, 4, 5]];
                // A polynomial with nearly as many terms as places is a guess between them.
                let lists: Vec<&[usize]> = lists
                    .into_iter()
                    .filter(|l| l.len() <= 2 || 10 * (l.len() + 2) <= 7 * seen.places[a])
                    .collect();
                let mut forms = self.selections(kind, interval(a), &lists);
                // Any curve is one; only beyond the fifth order is it bent so that it could be anything.
                forms.iter_mut().for_each(|f| f.enriched = f.columns.len() > 4);
                forms
            }
            EffectKind::Angular { axis: a, about } if travels(a) => {
                let lists: [&[usize]; 6] = [&[0, 1], &[0], &[1], &[0, 1, 2], &[0, 1, 2, 3, 4], &[1, 2]];
                let lists: Vec<&[usize]> = lists
                    .into_iter()
                    .filter(|l| l.len() <= 2 || 10 * (l.len() + 1) <= 7 * seen.places[a])
                    .collect();
                let mut forms = self.selections(kind, interval(a), &lists);
                forms.iter_mut().for_each(|form| form.only_rival = seen.one_lever[a][about]);
                forms
            }
            EffectKind::Sag(a) if travels(a) => {
                // The overhang begins where the ram leaves its support: at the end of travel, before or behind.
                let (low, high) = seen.range[a];
                [0.0, -1.0, -0.4, 0.2, 0.4, 0.6]
                    .into_iter()
                    .flat_map(|share| {
                        let from_mm = low + share * (high - low);
                        let shape = Shape { from_mm, to_mm: high, ..Shape::default() };
                        let lists: &[&[usize]] =
                            if share == 0.0 { &[&[0], &[1], &[2]] } else { &[&[0], &[1]] };
                        let mut forms = self.selections(kind, shape, lists);
                        forms.iter_mut().for_each(|f| {
                            f.enriched = share != 0.0;
                            // On a circle a droop is a straightness.
                            f.only_rival = seen.lengths;
                        });
                        forms
                    })
                    .collect()
            }
            // With two loads a line and a parabola can be any two values: a bend needs three. A lag bent over
            // the feed could be a backlash, so lags stay straight.
            EffectKind::Load(_) if seen.load => {
                self.selections(kind, none, if seen.loads > 2 { &[&[0], &[0, 1]] } else { &[&[0]] })
            }
            EffectKind::ServoLag(a) if seen.feed && seen.direction[a] => {
                self.selections(kind, none, &[&[0], &[1]])
            }
            EffectKind::ServoMismatch(a, b) if seen.feed && seen.direction[a] && seen.direction[b] => {
                self.selections(kind, none, &[&[0]])
            }
            EffectKind::Rotary { axis, .. } if seen.rotary[axis] => self.selections(kind, none, &[&[0]]),
            EffectKind::Eccentricity(axis) if seen.rotary[axis] => {
                self.selections(kind, none, &[&[0, 1], &[0, 1, 2, 3, 4, 5]])
            }
            EffectKind::ProbeLobing if seen.direction[0] && seen.direction[1] => {
                self.selections(kind, none, &[&[0, 1], &[0, 1, 4], &[0, 1, 2, 3, 4]])
            }
            EffectKind::InstrumentDrift if seen.time.is_some() => {
                let lists: [&[usize]; 8] =
                    [&[0, 1, 2], &[0], &[1], &[2], &[0, 3], &[1, 4], &[2, 5], &[0, 1, 2, 3, 4, 5]];
                self.selections(kind, none, &lists)
            }
            EffectKind::Step(_) => self.steps(kind, seen),
            EffectKind::Local(a) if travels(a) => self.places(kind, seen.range[a], seen.narrowest_mm[a]),
            EffectKind::Spike(a) => SPIKES_MM
                .into_iter()
                .filter(|width| seen.direction[a] && *width >= seen.turns_mm[a])
                .flat_map(|width_mm| self.selections(kind, Shape { width_mm, ..Shape::default() }, &[&[0]]))
                .collect(),
            EffectKind::SpindleTilt(_) if seen.tools => self.selections(kind, none, &[&[0]]),
            EffectKind::Tracker(2 | 3) if seen.station => self.selections(kind, none, &[&[0, 1]]),
            EffectKind::Tracker(_) if seen.station => self.selections(kind, none, &[&[0]]),
            _ => Vec::new(),
        }
    }

    fn warmup(&mut self, kind: EffectKind, seen: &Seen) -> Vec<Variant> {
        let Some((start, end)) = seen.time else { return Vec::new() };
        let taus = TAU_SHARES.map(|share| share * (end - start));
        let columns: Vec<usize> = taus
            .iter()
            .flat_map(|tau| {
                self.add_columns(kind, Shape { tau_s: *tau, tau2_s: *tau, ..Shape::default() }, &[0])
            })
            .collect();
        let single =
            columns.iter().map(|c| Variant { columns: vec![*c], enriched: false, only_rival: false });
        let double = columns.iter().zip(columns.iter().skip(2));
        let double =
            double.map(|(a, b)| Variant { columns: vec![*a, *b], enriched: true, only_rival: false });
        single.chain(double).collect()
    }

    fn steps(&mut self, kind: EffectKind, seen: &Seen) -> Vec<Variant> {
        let Some((start, end)) = seen.time else { return Vec::new() };
        (1..=STEP_TIMES)
            .map(|k| {
                let time_s = start + (end - start) * k as f64 / (STEP_TIMES + 1) as f64;
                let columns = self.add_columns(kind, Shape { time_s, ..Shape::default() }, &[0]);
                Variant { columns, enriched: false, only_rival: false }
            })
            .collect()
    }

    fn places(&mut self, kind: EffectKind, (low, high): (f64, f64), narrowest_mm: f64) -> Vec<Variant> {
        let width_mm = (2.0 * (high - low) / LOCAL_PLACES as f64).max(narrowest_mm);
        if width_mm > crate::propose::LOCAL_WIDEST * (high - low) {
            return Vec::new();
        }
        (0..=LOCAL_PLACES)
            .flat_map(|k| {
                let centre_mm = low + (high - low) * k as f64 / LOCAL_PLACES as f64;
                self.place(kind, centre_mm, width_mm)
            })
            .collect()
    }

    /// Rails that do not meet at a place: sideways in one direction or both.
    pub(crate) fn join(&mut self, kind: EffectKind, centre_mm: f64, width_mm: f64) -> Vec<Variant> {
        let EffectKind::Joint(axis) = kind else { return Vec::new() };
        let sideways: Vec<usize> = (0..3).filter(|d| *d != axis).collect();
        let shape = Shape { centre_mm, width_mm, ..Shape::default() };
        let columns = self.add_columns(kind, shape, &sideways);
        let one = |c: &usize| Variant { columns: vec![*c], enriched: false, only_rival: false };
        let mut variants: Vec<Variant> = columns.iter().map(one).collect();
        variants.push(Variant { columns, enriched: true, only_rival: false });
        variants
    }

    /// Damage at one place: along one direction or all three.
    pub(crate) fn place(&mut self, kind: EffectKind, centre_mm: f64, width_mm: f64) -> Vec<Variant> {
        let columns = self.add_columns(kind, Shape { centre_mm, width_mm, ..Shape::default() }, &[0, 1, 2]);
        let mut variants: Vec<Variant> = columns
            .iter()
            .map(|c| Variant { columns: vec![*c], enriched: false, only_rival: false })
            .collect();
        variants.push(Variant { columns, enriched: true, only_rival: false });
        variants
    }

    /// By how much the p value of one form of a candidate must be multiplied (weighted Bonferroni): every
    /// effect has the same share of the level, and its forms divide it.
    #[must_use]
    pub(crate) fn questions(&self, candidate: usize) -> f64 {
        (self.candidates.len() * self.candidates[candidate].asked()) as f64
    }
}
