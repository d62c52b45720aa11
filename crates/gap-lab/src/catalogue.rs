//! The list of cases of a benchmark.

use crate::alias::Alias;
use crate::case::{CaseSpec, Kind, aliased_spec};
use crate::design::Plan;
use crate::dice::Dice;
use crate::effect::Effect;
use crate::files::Observation;
use crate::noise::NoiseKind;
use crate::outside::Outside;

/// Cases of each kind among 1200.
const MIX: [(Kind, usize); 9] = [
    (Kind::Single, 488),
    (Kind::Multiple, 120),
    (Kind::Null, 168),
    (Kind::Outside, 100),
    (Kind::Aliased, 96),
    (Kind::Removed, 122),
    (Kind::BallBar, 56),
    (Kind::Magnitude, 30),
    (Kind::Rotary, 20),
];

/// Signal-to-noise ratios of the single cases.
const LADDER: [f64; 4] = [0.3, 1.0, 3.0, 10.0];

/// Noise under which a real effect is looked for.
const USUAL: [NoiseKind; 5] = [
    NoiseKind::RunOffsets,
    NoiseKind::RunOffsets,
    NoiseKind::Plain,
    NoiseKind::HeavyTails,
    NoiseKind::Outliers,
];

/// Purpose of the dice that draw up the catalogue.
const DRAWING: u64 = u64::MAX;

/// `cases` specifications in the fixed mixture of kinds; a function of the two numbers only.
#[must_use]
pub fn catalogue(cases: usize, seed: u64) -> Vec<CaseSpec> {
    let total: usize = MIX.iter().map(|(_, count)| count).sum();
    let mut specs = Vec::new();
    let mut upto = 0;
    for (kind, weight) in MIX {
        upto += weight;
        let first = specs.len();
        let last = (cases * upto + total / 2) / total;
        for turn in 0..last.saturating_sub(first) {
            specs.push(spec(kind, turn, specs.len() as u64, seed));
        }
    }
    specs
}

fn spec(kind: Kind, turn: usize, index: u64, seed: u64) -> CaseSpec {
    let mut dice = Dice::new(seed, index, DRAWING);
    let all = Effect::linear();
    let mut spec = CaseSpec {
        index,
        seed,
        kind,
        plans: vec![Plan::Good],
        effects: vec![all[turn % all.len()]],
        snr: vec![dice.pick(&[3.0, 10.0])],
        noise: dice.pick(&USUAL),
        observation: Observation::Displacement,
        outside: None,
        perfect: false,
    };
    match kind {
        Kind::Single => {
            // Every effect meets every rung of the ladder on good and on poor plans, and a shorter
            // catalogue still holds all of them.
            let combination = (turn % all.len() + turn / all.len()) % 8;
            spec.snr = vec![LADDER[combination % 4]];
            if combination >= 4 {
                spec.plans = Plan::POOR.into();
                dice.shuffle(&mut spec.plans);
                // Each poor plan is tried with three machines before the good one is taken.
                spec.plans = spec.plans.repeat(3);
            }
        }
        Kind::Multiple => {
            let count = [2, 2, 3, 3, 4][turn % 5];
            let mut pool = all;
            dice.shuffle(&mut pool);
            // Droop is never identifiable beside straightness, so it cannot be asked for here.
            pool.retain(|e| !matches!(e, Effect::Sag(_)));
            spec.effects = pool.into_iter().take(count).collect();
            spec.snr = (0..count).map(|_| dice.scale(2.0, 10.0)).collect();
        }
        Kind::Null => {
            spec.noise = NoiseKind::ALL[turn % NoiseKind::ALL.len()];
            let plans = [
                Plan::Good,
                Plan::Sparse,
                Plan::FewLines,
                Plan::Good,
                Plan::Points,
                Plan::OneWay,
                Plan::Plane,
            ];
            spec.plans = vec![plans[turn / NoiseKind::ALL.len() % plans.len()]];
            if turn % 10 == 9 {
                spec.observation = Observation::Position;
            }
            (spec.effects, spec.snr) = (Vec::new(), Vec::new());
        }
        Kind::Outside => {
            spec.outside = Some(Outside::ALL[turn % Outside::ALL.len()]);
            spec.effects = Vec::new();
        }
        Kind::Aliased => {
            let (plan, effect) = aliased_spec(Alias::ALL[turn % 6], turn / 6);
            (spec.plans, spec.effects) = (vec![plan], vec![effect]);
        }
        Kind::Removed => {}
        Kind::BallBar => {
            spec.plans = vec![Plan::BallBar];
            spec.effects = vec![on_a_circle(turn)];
            spec.snr = vec![LADDER[1 + turn % 3]];
        }
        Kind::Magnitude => {
            spec.effects = vec![by_its_size(turn)];
            spec.observation = Observation::Magnitude;
            spec.noise = NoiseKind::Plain;
        }
        Kind::Rotary => {
            spec.plans = vec![Plan::Turntable];
            spec.effects = vec![Effect::rotary()[turn % 3]];
        }
    }
    spec
}

/// An effect that a ball bar sees, in turn.
fn on_a_circle(turn: usize) -> Effect {
    let axis = turn % 3;
    let (a, b) = [(0, 1), (0, 2), (1, 2)][axis];
    let family = [
        Effect::Squareness(a, b),
        Effect::Backlash(axis),
        Effect::Scale(axis),
        Effect::ServoLag(axis),
        Effect::LostMotion((axis + 1) % 3, axis),
        Effect::ServoMismatch(a, b),
    ];
    family[turn / 3 % family.len()]
}

/// An effect that the size of the displacement shows, in turn.
fn by_its_size(turn: usize) -> Effect {
    let axis = turn % 3;
    let family = [
        Effect::Scale(axis),
        Effect::Squareness([0, 0, 1][axis], [1, 2, 2][axis]),
        Effect::Straightness((axis + 1) % 3, axis),
        Effect::Backlash(axis),
        Effect::Load(axis),
    ];
    family[turn / 3 % family.len()]
}

/// Cases whose noise is not what a fit takes for granted: in turn nulls and single effects, every kind of
/// [`NoiseKind::DOUBTFUL`], every plan for nulls. Their numbers begin behind those of [`catalogue`].
#[must_use]
pub fn doubtful(cases: usize, seed: u64) -> Vec<CaseSpec> {
    const FIRST: u64 = 100_000;
    let kinds = NoiseKind::DOUBTFUL.len();
    (0..cases)
        .map(|turn| {
            let kind = if turn % 2 == 0 { Kind::Null } else { Kind::Single };
            let mut spec = spec(kind, turn / 2 * 7 / kinds, FIRST + turn as u64, seed);
            spec.noise = NoiseKind::DOUBTFUL[turn / 2 % kinds];
            spec.observation = Observation::Displacement;
            if kind == Kind::Single {
                (spec.plans, spec.snr) = (vec![Plan::Good], vec![[1.0, 3.0, 10.0][turn / 2 % 3]]);
            }
            spec
        })
        .collect()
}

/// Small cases for documents and tests: their file name, and how they are made.
#[must_use]
pub fn sample_cases() -> Vec<(&'static str, CaseSpec)> {
    let base = |index: u64, effects: Vec<Effect>, snr: Vec<f64>, plan: Plan| CaseSpec {
        index,
        seed: 2026,
        kind: Kind::Single,
        plans: vec![plan; 40],
        effects,
        snr,
        noise: NoiseKind::RunOffsets,
        observation: Observation::Displacement,
        outside: None,
        perfect: true,
    };
    let blind = Plan::Aliased(Alias::LagOrBacklash, 1);
    let two = CaseSpec {
        kind: Kind::Multiple,
        ..base(900_002, vec![Effect::Squareness(0, 1), Effect::Scale(1)], vec![10.0, 6.0], Plan::Sparse)
    };
    vec![
        ("backlash", base(900_001, vec![Effect::Backlash(0)], vec![6.0], Plan::Sparse)),
        ("squareness_and_scale", two),
        ("nothing", CaseSpec { kind: Kind::Null, ..base(900_003, vec![], vec![], Plan::Sparse) }),
        (
            "one_feed",
            CaseSpec { kind: Kind::Aliased, ..base(900_004, vec![Effect::Backlash(0)], vec![6.0], blind) },
        ),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mixture_holds_at_any_size() {
        for cases in [0, 1, 60, 300, 1200, 2400] {
            let list = catalogue(cases, 1);
            assert_eq!(list.len(), cases);
            assert!(list.iter().enumerate().all(|(k, spec)| spec.index == k as u64));
        }
        let list = catalogue(1200, 1);
        assert_eq!(list.iter().filter(|s| s.kind == Kind::Null).count(), 168);
        for effect in Effect::linear() {
            for snr in LADDER {
                let both = list.iter().filter(|s| {
                    s.kind == Kind::Single && s.effects == [effect] && (s.snr[0] - snr).abs() < 1e-9
                });
                let good = both.clone().filter(|s| s.plans == [Plan::Good]).count();
                assert_eq!((good, both.count()), (1, 2), "{} at {snr}", effect.id());
            }
        }
    }

    #[test]
    fn doubtful_cases_hold_every_noise_with_and_without_an_effect() {
        let list = doubtful(80, 3);
        for noise in NoiseKind::DOUBTFUL {
            for kind in [Kind::Null, Kind::Single] {
                assert_eq!(list.iter().filter(|s| s.noise == noise && s.kind == kind).count(), 10);
            }
        }
        assert!(list[0].build().truth.effects.is_empty() && !list[1].build().truth.effects.is_empty());
    }

    fn read(text: &str) -> (Vec<String>, Vec<Vec<String>>) {
        let split = |line: &str| line.split(',').map(str::to_owned).collect::<Vec<_>>();
        let mut lines = text.lines().map(split);
        (lines.next().unwrap(), lines.collect())
    }

    /// A knock between two runs hides behind their offsets: what it would need to show beside them is no knock.
    #[test]
    fn knocks_are_no_crashes() {
        let list = catalogue(1200, 7);
        let knock = |s: &&CaseSpec| matches!(s.effects[..], [Effect::Step(_)]) && s.snr[0] > 2.0;
        let poor = list.iter().filter(knock).filter(|s| s.kind == Kind::Single && s.plans != [Plan::Good]);
        let mut seen = 0;
        for spec in poor {
            let case = spec.build();
            let (header, rows) = read(&case.files[1].1);
            for column in (0..header.len()).filter(|c| matches!(&header[*c][..], "dx_um" | "dy_um" | "dz_um"))
            {
                for value in rows.iter().filter_map(|row| row[column].parse::<f64>().ok()) {
                    // 1 mm, and what the profile knows.
                    assert!(value.abs() < 1300.0, "{}: {value}", case.id);
                    seen += 1;
                }
            }
        }
        assert!(seen > 1000, "{seen}");
    }

    #[test]
    fn the_same_seed_gives_the_same_bytes_and_another_seed_does_not() {
        let make = |seed| catalogue(12, seed).iter().map(|s| s.build().files).collect::<Vec<_>>();
        let once = make(5);
        assert_eq!(once, make(5));
        assert_ne!(once[0], catalogue(12, 6)[0].build().files);
    }

    #[test]
    fn every_kind_builds_and_its_files_are_those_of_the_contract() {
        let known = "run x_mm y_mm z_mm c_deg dx_um dy_um dz_um xm_mm ym_mm zm_mm d_um length_mm bx_mm by_mm bz_mm \
                     dir_x dir_y dir_z feed_mm_min tool_x_mm tool_y_mm tool_z_mm load_kg time_s temp_c repeat u_um";
        let known: Vec<&str> = known.split_whitespace().collect();
        for spec in catalogue(36, 11) {
            let case = spec.build();
            assert_eq!(case.without.is_some(), case.kind == Kind::Removed);
            for name in ["measurement.csv", "holdout.csv"] {
                let text = &case.files.iter().find(|(n, _)| n == name).unwrap().1;
                let (header, rows) = read(text);
                assert!(header.iter().all(|h| known.contains(&h.as_str())), "{}: {header:?}", case.id);
                assert!(rows.len() >= 30, "{}: {} rows", case.id, rows.len());
                assert!(rows.iter().all(|r| r.len() == header.len()));
                assert!(rows.iter().flatten().all(|c| !c.contains("NaN") && !c.contains("inf")));
            }
            assert_eq!(case.truth.effects.is_empty(), case.kind == Kind::Null, "{}", case.id);
        }
    }

    /// The signal-to-noise ratio that was asked for is in the file: a quiet copy of the case, read back
    /// and centred per run, has the asked size.
    #[test]
    fn the_signal_to_noise_ratio_is_what_was_asked_for() {
        let list = catalogue(488, 3);
        let spec =
            list.iter().find(|s| s.kind == Kind::Single && s.snr[0] > 5.0 && s.plans.len() == 1).unwrap();
        let case = spec.build();
        let rows = read(&case.files[1].1).1.len() as f64;
        let wanted = spec.snr[0] * rows.sqrt();
        assert!((case.truth.expected_sigma / wanted - 1.0).abs() < 1e-6, "{}", case.truth.expected_sigma);
    }

    #[test]
    fn aliased_cases_have_a_rival_and_multiple_cases_have_none() {
        for spec in catalogue(200, 4) {
            match spec.kind {
                Kind::Aliased => assert!(!spec.build().truth.identifiable, "{}", spec.index),
                Kind::Multiple => assert!(spec.build().truth.identifiable, "{}", spec.index),
                _ => {}
            }
        }
    }
}
