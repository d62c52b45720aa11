//! What the diagnosis must not believe: measurements whose noise, set-up or truth is not what a search takes for granted.

use super::*;

/// Sum of twelve uniform numbers, normal enough up to three sigma.
fn normal(random: &mut ChaCha8Rng) -> f64 {
    (0..12).map(|_| random.random_range(-0.5..0.5)).sum::<f64>()
}

/// The readings of some rows changed, component by component.
pub(super) fn changed(mut data: Measurements, mut change: impl FnMut(&Row) -> Vector) -> Measurements {
    for row in &mut data.rows {
        let more = change(row);
        if let Reading::Displacement(components) = &mut row.reading {
            components.iter_mut().zip(more.iter()).for_each(|(c, m)| *c = c.map(|c| c + m));
        }
    }
    data
}

/// A plan without noise, for tests that make their own.
const SILENT: Plan = Plan { sigma_um: 0.0, run_sigma_um: 0.0, ..GOOD };

fn alarms(draws: std::ops::Range<u64>, file: impl Fn(u64) -> Measurements) -> Vec<String> {
    let say = |seed: u64| {
        let answer = diagnose(&file(seed), None, &Options::default());
        (!answer.causes.is_empty()).then(|| format!("{seed}: {} {:?}", answer.verdict.name(), names(&answer)))
    };
    draws.filter_map(say).collect()
}

/// Ten places 5 mm apart with a kink between two of them, five times: what is written moves no place between them by
/// more than twice the largest reading.
#[test]
fn between_the_places_a_cause_does_no_harm() {
    for seed in 0..6 {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let base = measured(SILENT, nothing);
        let mut data = Measurements { runs: Vec::new(), rows: Vec::new(), ..base.clone() };
        let kink: Vec<f64> =
            (0..10).map(|k| if k < 6 { 4.0 * f64::from(k) } else { 41.0 - 3.0 * f64::from(k) }).collect();
        let rough: Vec<f64> = kink.iter().map(|v| v + 9.0 * normal(&mut random)).collect();
        for cycle in 0..5_usize {
            data.runs.push(format!("cycle {cycle}"));
            for (k, value) in rough.iter().enumerate() {
                let mut row = base.rows[0];
                row.run = cycle;
                row.command.linear_mm = Vector::new(40.0 + 5.0 * k as f64, 40.0, 40.0);
                row.conditions = Conditions::default();
                row.reading = Reading::Displacement([Some(value + 0.8 * normal(&mut random)), None, None]);
                data.rows.push(row);
            }
        }
        let largest = rough.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        let answer = diagnose(&data, None, &Options::default());
        let at = |x_mm: f64| -> f64 {
            let mut row = data.rows[0];
            row.command.linear_mm.x = x_mm;
            let moved = |c: &crate::Cause| {
                c.term.as_ref().unwrap().displacement_mm(&row.command, &row.conditions).unwrap().x
            };
            1e3 * answer.causes.iter().map(moved).sum::<f64>()
        };
        let fine: Vec<f64> = (0..=450).map(|k| at(40.0 + 0.1 * f64::from(k))).collect();
        let mean = fine.iter().sum::<f64>() / fine.len() as f64;
        let most = fine.iter().fold(0.0_f64, |m, v| m.max((v - mean).abs()));
        assert!(most <= 2.0 * largest, "{seed}: {most} of {largest} {:?}", names(&answer));
        for cause in &answer.causes {
            let coefficients = cause.term.as_ref().unwrap().coefficients().count();
            assert!(coefficients <= 5, "{}: {coefficients} coefficients on 10 places", cause.effect);
        }
    }
}

/// Three blunders of 80 µm in a machine without faults, one of them the last row of its run: a step at a moment and damage at a
/// place would explain them. They are left out instead, by their lines, and nothing is named.
#[test]
fn blunders_get_no_cause() {
    let clean = measured(Plan { sigma_um: 0.8, ..GOOD }, nothing);
    let last = clean.rows.iter().rposition(|row| row.run == 2).unwrap();
    let spoilt = [30, 95, last];
    let mut row = 0;
    let data = changed(clean, |_| {
        row += 1;
        if spoilt.contains(&(row - 1)) { Vector::new(80.0, -75.0, 70.0) } else { Vector::zeros() }
    });
    let answer = diagnose(&data, None, &Options::default());
    assert!(answer.causes.is_empty(), "{:?}", names(&answer));
    let expected: Vec<u64> = spoilt.iter().map(|row| data.rows[*row].line).collect();
    assert!(expected.iter().all(|line| answer.outlier_lines.contains(line)), "{:?}", answer.outlier_lines);
}

/// 45 mm of Z, 250 mm and more from machine zero, are 800 µm/m too short: physics carries a scale over the whole axis as far as
/// its number is known.
#[test]
fn a_scale_is_carried_as_far_as_it_is_known() {
    let volume = |high: f64| {
        let range = |high| machine_model::Range { low: 0.0, high };
        Some(machine_model::Volume([range(400.0), range(400.0), range(high)]))
    };
    let answer = |high: f64| {
        let mut data = measured(SILENT, nothing);
        let mut random = ChaCha8Rng::seed_from_u64(5);
        for row in &mut data.rows {
            row.command.linear_mm.z = 250.0 + 0.1 * row.command.linear_mm.z;
            let dz = -0.8 * row.command.linear_mm.z;
            let noisy = [0.0, 0.0, dz].map(|v| Some(v + 0.5 * normal(&mut random)));
            row.reading = Reading::Displacement(noisy);
        }
        diagnose(&data, None, &Options { volume: volume(high), ..Options::default() })
    };
    let known = answer(400.0);
    assert_eq!(names(&known), ["scale.Z"]);
    assert!(known.corrects() && known.within.is_none(), "{:?} {:?}", known.withheld, known.within);
}

/// What depends on place and direction at once is left beside the play, and has no name: the play is written, since runs that
/// were kept back confirm it.
#[test]
fn a_part_is_written_where_unseen_runs_confirm_it() {
    let rest = |row: &Row| {
        let [place, other] = [0, 1].map(|a| row.command.linear_mm[a] / 40.0);
        Vector::new(0.0, 0.0, 6.0 * units::math::sin(place * other) * f64::from(row.command.direction[0]))
    };
    let whole = diagnose(&measured(GOOD, backlash_um), None, &Options::default());
    let part = diagnose(&measured(GOOD, |row| backlash_um(row) + rest(row)), None, &Options::default());
    assert_eq!((whole.verdict, part.verdict), (Verdict::Named, Verdict::Partial), "{}", part.sentence);
    assert_eq!((names(&whole), names(&part)), (vec!["backlash.X"], vec!["backlash.X"]));
    assert!(whole.corrects() && part.corrects(), "{:?}", part.withheld);
}

/// Of 40 draws at a level of 3 % more than four are an alarm once in forty times.
#[test]
fn components_that_scatter_unequally_raise_no_alarm() {
    let file = |seed: u64| {
        let mut random = ChaCha8Rng::seed_from_u64(1000 + seed);
        let mut draw = || normal(&mut random);
        changed(measured(SILENT, nothing), |_| Vector::new(0.6 * draw(), 1.2 * draw(), 1.8 * draw()))
    };
    let found = alarms(0..40, file);
    assert!(found.len() <= 4, "{found:#?}");
}

/// The same with readings of which each keeps 0.8 of the one before.
#[test]
fn readings_that_hang_together_raise_no_alarm() {
    let file = |seed: u64| {
        let mut random = ChaCha8Rng::seed_from_u64(2000 + seed);
        let mut state = Vector::zeros();
        changed(measured(SILENT, nothing), move |_| {
            let fresh = Vector::new(normal(&mut random), normal(&mut random), normal(&mut random));
            state = 0.8 * state + 0.6 * fresh;
            state
        })
    };
    let found = alarms(0..40, file);
    assert!(found.len() <= 4, "{found:#?}");
}

/// White noise on a walk of 0.25 µm a reading that begins anew in every run: from one reading to the next hardly anything
/// hangs together, and over a run it is as smooth as an effect.
#[test]
fn a_walk_below_the_noise_raises_no_alarm() {
    let file = |seed: u64| {
        let mut random = ChaCha8Rng::seed_from_u64(3000 + seed);
        let (mut run, mut walk) = (usize::MAX, Vector::zeros());
        changed(measured(SILENT, nothing), move |row| {
            let [step, fresh] = [0; 2].map(|_| Vector::from([0; 3].map(|_| normal(&mut random))));
            walk = if row.run == run { walk + 0.25 * step } else { Vector::zeros() };
            run = row.run;
            walk + fresh
        })
    };
    let found = alarms(0..60, file);
    assert!(found.len() <= 2, "{found:#?}");
}

/// A display with steps of four standard deviations, in a measuring frame that is turned a little: most readings agree with
/// the model to the digit, one in twenty is a whole step off.
#[test]
fn a_coarse_display_raises_no_alarm() {
    const STEP_UM: f64 = 4.0;
    let file = |seed: u64| {
        let mut random = ChaCha8Rng::seed_from_u64(4000 + seed);
        changed(measured(SILENT, nothing), move |row| {
            let shown = [0; 3].map(|_| STEP_UM * (normal(&mut random) / STEP_UM).round());
            Vector::from(shown) + Vector::new(0.0, 0.0, 0.05).cross(&row.command.linear_mm)
        })
    };
    let found = alarms(0..60, file);
    assert!(found.len() <= 2, "{found:#?}");
}

/// Runs shifted by 8 µm each, a noise of 0.4 µm, loads and temperatures that do nothing: twenty times the noise, the shifts must
/// not make what differs from run to run look certain.
#[test]
fn shifts_of_runs_do_not_pass_for_their_conditions() {
    let file = |seed: u64| {
        let mut random = ChaCha8Rng::seed_from_u64(5000 + seed);
        let plan = Plan { sigma_um: 0.4, run_sigma_um: 8.0, seed: 5000 + seed, ..GOOD };
        let mut data = measured(plan, nothing);
        let conditions: Vec<(f64, f64)> = data
            .runs
            .iter()
            .map(|_| (100.0 * normal(&mut random).abs(), 20.0 + normal(&mut random)))
            .collect();
        for row in &mut data.rows {
            let (load_kg, temp_c) = conditions[row.run];
            row.conditions.load_kg = Some(load_kg);
            row.conditions.temp_c = [Some(temp_c); 3];
        }
        data
    };
    let found = alarms(0..40, file);
    assert!(found.len() <= 2, "{found:#?}");
}

/// Six plates of 6 × 6 holes, each clamped anew: turned by up to 400 µrad against each other.
fn plates(field_um: impl Fn(&Row) -> Vector) -> Measurements {
    let mut random = ChaCha8Rng::seed_from_u64(77);
    let base = measured(SILENT, nothing);
    let mut data = Measurements { runs: Vec::new(), rows: Vec::new(), ..base.clone() };
    for plate in 0..6_usize {
        data.runs.push(format!("plate {plate}"));
        let turn = 1e-3 * 400.0 * [1.0, -0.7, 0.4, -0.2, 0.9, -1.0][plate];
        for hole in 0..36 {
            let mut row = base.rows[0];
            row.run = plate;
            row.command.linear_mm =
                Vector::new(40.0 + 60.0 * f64::from(hole % 6), 40.0 + 60.0 * f64::from(hole / 6), 40.0);
            row.command.direction = [0; 3];
            row.conditions = Conditions::default();
            let tip = row.command.linear_mm - Vector::new(190.0, 190.0, 0.0);
            let clamped =
                Vector::new(0.0, 0.0, turn).cross(&tip) + Vector::new(9.0, -7.0, 0.0) * plate as f64;
            let noise = Vector::new(normal(&mut random), normal(&mut random), 0.0);
            let gap = field_um(&row) + clamped + noise;
            row.reading = Reading::Displacement([Some(gap.x), Some(gap.y), None]);
            data.rows.push(row);
        }
    }
    data
}

#[test]
fn plates_turned_against_each_other_are_set_up_and_no_gap() {
    let answer = diagnose(&plates(nothing), None, &Options::default());
    assert_eq!(answer.verdict, Verdict::NoGap, "{} {:?}", answer.sentence, names(&answer));
    // Two components of 1 µm.
    assert!(answer.gap.rms_um < 1.6, "{:?}", answer.gap);
    let turns = &answer.setup.as_ref().unwrap().run_rotations_urad;
    let apart = turns[0].1[2] - turns[5].1[2];
    assert!((apart - 800.0).abs() < 20.0, "{turns:?}");
    // What they have in common is the frame's, whatever the fit made of it; about X and Y nothing was read.
    let common: f64 = turns.iter().map(|(_, turn)| turn[2]).sum();
    assert!(common.abs() < 1e-6, "{turns:?}");
    let said = answer.notes.iter().map(|n| n.english()).find(|n| n.contains("turned against each other"));
    let said: f64 = said.unwrap().split_whitespace().find_map(|word| word.parse().ok()).unwrap();
    assert!((said - apart).abs() < 1.0, "{said} {turns:?}");
    // A scale is no turn: it is found beside them.
    let stretched = |row: &Row| Vector::new(0.05 * row.command.linear_mm.x, 0.0, 0.0);
    let answer = diagnose(&plates(stretched), None, &Options::default());
    assert!(names(&answer).contains(&"scale.X"), "{} {:?}", answer.sentence, names(&answer));
}

#[test]
fn two_instruments_that_disagree_are_said_to() {
    let mut data = measured(GOOD, nothing);
    data.instruments = vec!["tracker".to_owned(), "probe".to_owned()];
    data.rows.iter_mut().enumerate().for_each(|(k, row)| row.instrument = Some(usize::from(k % 3 == 0)));
    let data = changed(data, |row| Vector::new(0.0, if row.instrument == Some(1) { 40.0 } else { 0.0 }, 0.0));
    let answer = diagnose(&data, None, &Options::default());
    assert!(answer.causes.is_empty(), "{:?}", names(&answer));
    let said = answer.notes.iter().any(|n| n.english().contains("tracker and probe disagree by 40"));
    assert!(said, "{:?}", answer.notes);
}

/// The hold-out knows nothing of the play: a name that unseen rows contradict does not stay.
#[test]
fn unseen_rows_that_refute_a_name_change_the_headline() {
    let data = measured(GOOD, backlash_um);
    let other = |row: &Row| Vector::new(3.0 * f64::from(row.command.direction[0]), 0.0, 0.0);
    let holdout = measured(Plan { seed: 2, ..GOOD }, other);
    let answer = diagnose(&data, Some(&holdout), &Options::default());
    assert_eq!(answer.verdict, Verdict::Unknown, "{}", answer.sentence);
    assert!(answer.sentence.english().contains("refute"), "{}", answer.sentence);
    assert!(answer.causes.iter().all(|c| c.remedy.english().starts_with("Do not act on this")));
    // And a gap that only unseen rows show is one.
    let answer = diagnose(
        &measured(GOOD, nothing),
        Some(&measured(Plan { seed: 2, ..GOOD }, |row| 5.0 * backlash_um(row))),
        &Options::default(),
    );
    assert_eq!(answer.verdict, Verdict::Unknown, "{}", answer.sentence);
}

/// A gap that adds a tenth to the RMS of unseen rows is in their pattern; rows with nothing but noise stay an all-clear.
#[test]
fn a_gap_of_unseen_rows_that_their_size_hides_is_found_in_their_pattern() {
    let verdict = |seed: u64, share: f64| {
        let held = measured(Plan { seed, ..GOOD }, |row| share * backlash_um(row));
        diagnose(&measured(GOOD, nothing), Some(&held), &Options::default())
    };
    let answer = verdict(2, 0.5);
    assert_eq!(answer.verdict, Verdict::Unknown, "{}", answer.sentence);
    assert!(answer.sentence.english().contains("searched alone"), "{}", answer.sentence);
    for seed in 2..8 {
        let answer = verdict(seed, 0.0);
        assert_eq!(answer.verdict, Verdict::NoGap, "{seed}: {}", answer.sentence);
    }
}

/// Of the lines along X one has no play any more: what the others gain does not make up for it.
#[test]
fn a_run_that_gets_worse_is_told_by_name() {
    let data = measured(GOOD, backlash_um);
    let held = |seed: u64, mended: Option<usize>| {
        let play = move |row: &Row| if Some(row.run) == mended { Vector::zeros() } else { backlash_um(row) };
        diagnose(&data, Some(&measured(Plan { seed, ..GOOD }, play)), &Options::default())
    };
    let answer = held(2, Some(3));
    let worse = answer.holdout.as_ref().and_then(|h| h.worse).unwrap();
    assert!(worse.run == 3 && worse.after_um > 1.5 * worse.before_um, "{worse:?}");
    assert!(!matches!(answer.verdict, Verdict::Named | Verdict::Ambiguous), "{}", answer.sentence);
    for seed in 2..8 {
        let answer = held(seed, None);
        assert_eq!(answer.holdout.unwrap().worse, None, "{seed}");
        assert_eq!(answer.verdict, Verdict::Named, "{seed}: {}", answer.sentence);
    }
}

/// A reversal that loses 6 µm at one end of the axis and gains as much at the other is no play, and no value in the control
/// mends it. One that falls from 6 µm to 1 µm is.
#[test]
fn play_does_not_change_its_sign() {
    let answer = |near_um: f64, far_um: f64| {
        let reversal = move |row: &Row| {
            let lost_um = near_um + (far_um - near_um) * row.command.linear_mm.x / 410.0;
            Vector::new(-0.5 * lost_um * f64::from(row.command.direction[0]), 0.0, 0.0)
        };
        diagnose(&measured(Plan { sigma_um: 0.5, ..GOOD }, reversal), None, &Options::default())
    };
    let both_ways = answer(6.0, -6.0);
    assert!(!names(&both_ways).contains(&"backlash.X"), "{}", both_ways.sentence);
    assert!(!matches!(both_ways.verdict, Verdict::Named | Verdict::NoGap), "{}", both_ways.sentence);
    let falls = answer(6.0, 1.0);
    assert_eq!(names(&falls), ["backlash.X"], "{}", falls.sentence);
}

/// Cycles over five places of Z, there and back, as ISO 230-2 has them; each is a run, and no time is written. What is read, µm,
/// of cycle, place, way and row.
fn cycles(count: usize, mut read: impl FnMut(usize, usize, i8, usize) -> f64) -> Measurements {
    let base = measured(SILENT, nothing);
    let mut data = Measurements { runs: Vec::new(), rows: Vec::new(), ..base.clone() };
    for cycle in 0..count {
        data.runs.push(format!("cycle {cycle}"));
        for nth in 0..10_usize {
            let (k, way) = if nth < 5 { (nth, 1) } else { (9 - nth, -1) };
            let mut row = base.rows[0];
            row.run = cycle;
            row.line = data.rows.len() as u64 + 2;
            row.command.linear_mm = Vector::new(40.0, 40.0, 40.0 + 2.0 * k as f64);
            row.command.direction = [0, 0, way];
            row.conditions = Conditions::default();
            row.reading = Reading::Displacement([None, None, Some(read(cycle, k, way, data.rows.len()))]);
            data.rows.push(row);
        }
    }
    data
}

/// A saw-tooth, and another one in the reversal.
fn saw_um(k: usize, way: i8) -> f64 {
    [0.0, 14.0, -9.0, 16.0, 3.0][k] + f64::from(way) * [8.0, -10.0, -9.0, 8.0, 15.0][k]
}

/// Neighbouring places differ by 10 µm and more, every command reads the same each time. That is no noise of 10 µm.
#[test]
fn what_comes_back_in_three_runs_is_no_noise() {
    let mut random = ChaCha8Rng::seed_from_u64(11);
    let data = cycles(3, |_, k, way, _| saw_um(k, way) + 0.3 * normal(&mut random));
    let answer = diagnose(&data, None, &Options::default());
    assert!(answer.gap.noise_um < 2.0, "{:?}", answer.gap);
    assert_eq!(answer.verdict, Verdict::Unknown, "{}", answer.sentence);
}

/// Most readings come back to the very same step of the display, of which few are seen twice: the noise is that step and not
/// nothing, of which any gap is a million times.
#[test]
fn what_comes_back_to_the_step_of_the_display_has_the_noise_of_that_step() {
    let mut random = ChaCha8Rng::seed_from_u64(3);
    let step_um = 0.41;
    let mut shown = |um: f64| ((um + 0.1 * normal(&mut random)) / step_um).round() * step_um;
    let answer = diagnose(&cycles(3, |_, k, way, _| shown(saw_um(k, way))), None, &Options::default());
    assert!((0.02..1.0).contains(&answer.gap.noise_um), "{:?}", answer.gap);
    assert_eq!(answer.verdict, Verdict::Unknown, "{}", answer.sentence);
}

/// A gap below the step of the control is none, whatever unseen rows make of it.
#[test]
fn what_no_control_can_correct_is_not_told_as_a_gap_of_unseen_rows() {
    let data = measured(GOOD, nothing);
    let held = measured(Plan { seed: 2, ..GOOD }, |row| 3.0 * backlash_um(row));
    let options = Options { resolution_um: 100.0, ..Options::default() };
    let answer = diagnose(&data, Some(&held), &options);
    assert_eq!(answer.verdict, Verdict::NoGap);
    assert!(!answer.sentence.english().contains("not fitted"), "{}", answer.sentence);
}

/// A load that is one number per run: the forecast for other runs is what they show.
#[test]
fn a_load_that_is_constant_within_a_run_is_seen_between_the_runs() {
    let loaded = |seed: u64| {
        let loads = [0.0, 120.0, 40.0, 200.0, 80.0, 160.0, 20.0, 180.0, 60.0, 140.0, 100.0, 10.0];
        let mut data = measured(Plan { seed, run_sigma_um: 0.3, ..GOOD }, nothing);
        data.rows
            .iter_mut()
            .for_each(|r| r.conditions.load_kg = Some(loads[(r.run * 5 + seed as usize) % 12]));
        changed(data, |row| Vector::new(0.0, 0.0, -0.09 * row.conditions.load_kg.unwrap()))
    };
    let answer = diagnose(&loaded(1), Some(&loaded(4)), &Options::default());
    assert_eq!(names(&answer), ["load.Z"], "{}", answer.sentence);
    let (promised, kept) = (answer.causes[0].shrink_predicted.unwrap().mid, answer.holdout.unwrap().shrink);
    assert!(kept > 0.5 && (promised - kept).abs() < 0.05, "{promised} {kept}");
}

#[test]
fn play_of_the_wrong_sign_is_said_to_be_none() {
    let over = |row: &Row| -backlash_um(row);
    let answer = diagnose(&measured(GOOD, over), None, &Options::default());
    assert_eq!(names(&answer), ["backlash.X"]);
    let cause = &answer.causes[0];
    assert!(
        cause.words.english().contains("over-compensated")
            && cause.remedy.english().starts_with("This is no play"),
        "{cause:?}"
    );
}

/// Parts of other runs, artefacts and temperatures are no repeats; what is read twice in one run is.
#[test]
fn another_part_is_no_repeat() {
    let mut data = measured(Plan { feeds: &[1000.0], ..GOOD }, nothing);
    let noise = |data: &Measurements| {
        let scalars = data.scalars(None);
        let values: Vec<f64> = scalars.iter().map(|s| s.gap_um).collect();
        estimate(&data.rows, &scalars, &values, Serial::default()).unwrap()
    };
    assert_eq!(noise(&data).source, NoiseSource::Repeats);
    data.rows
        .iter_mut()
        .for_each(|row| row.artefact = Some(usize::from(row.conditions.time_s > Some(2000.0))));
    let mut parts = data.clone();
    parts.rows.iter_mut().enumerate().for_each(|(k, row)| row.artefact = Some(k / 34 % 2));
    assert_eq!(noise(&parts).source, NoiseSource::Neighbours);
    let mut warm = data.clone();
    warm.rows
        .iter_mut()
        .enumerate()
        .for_each(|(k, row)| row.conditions.temp_c = [Some(20.0 + 3.0 * (k / 34 % 2) as f64); 3]);
    assert_eq!(noise(&warm).source, NoiseSource::Neighbours);
}

/// Two blunders of 100 µm among repeats of a micrometre do not make the noise 10 µm.
#[test]
fn blunders_do_not_hide_in_the_noise_they_make() {
    let mut data = measured(Plan { feeds: &[1000.0], ..GOOD }, nothing);
    // Every pass twice: four repeats of a command.
    for k in 0..data.rows.len() {
        data.rows[k].command.direction = [1, 0, 0];
        data.rows[k].command.linear_mm.x = (data.rows[k].command.linear_mm.x / 25.0).round() * 25.0;
    }
    let mut nth = 0;
    let data = changed(data, |_| {
        nth += 1;
        Vector::new(if nth % 200 == 7 { 100.0 } else { 0.0 }, 0.0, 0.0)
    });
    let scalars = data.scalars(None);
    let values: Vec<f64> = scalars.iter().map(|s| s.gap_um).collect();
    let noise = estimate(&data.rows, &scalars, &values, Serial::default()).unwrap();
    assert!(noise.variance.sqrt() < 1.5, "{noise:?}");
}

/// Readings in whole micrometres of a scatter of a tenth: the display's step is the noise.
#[test]
fn a_coarse_display_is_noise() {
    let data = measured(Plan { sigma_um: 0.1, run_sigma_um: 0.0, ..GOOD }, nothing);
    let rounded = changed(data, |row| match row.reading {
        Reading::Displacement([Some(x), Some(y), Some(z)]) => {
            Vector::new(x.round() - x, y.round() - y, z.round() - z)
        }
        _ => Vector::zeros(),
    });
    let rounded = changed(rounded, |row| Vector::repeat(f64::from(u8::from(row.run % 2 == 0))));
    let scalars = rounded.scalars(None);
    assert!((crate::equations::noise::quantum_um(&scalars) - 1.0).abs() < 1e-9);
    let answer = diagnose(&rounded, None, &Options::default());
    assert!(answer.causes.is_empty(), "{:?}", names(&answer));
}

/// What creeps alike everywhere is the machine's or the instrument's; nothing is written for it.
#[test]
fn a_warm_up_may_be_the_instruments() {
    let creep = |row: &Row| {
        Vector::new(14.0 * (1.0 - units::math::exp(-row.conditions.time_s.unwrap() / 500.0)), 0.0, 0.0)
    };
    let answer = diagnose(&measured(GOOD, creep), None, &Options::default());
    let cause = answer.causes.iter().find(|c| c.effect == "warmup.X").expect("found");
    assert!(
        cause.cannot_be_told_from.iter().any(|rival| rival == "instrument-drift"),
        "{:?}",
        names(&answer)
    );
    assert_eq!(answer.verdict, Verdict::Ambiguous);
    assert!(!answer.corrects());
    // Who knows that the instrument stands still says so.
    let stable = Options { without: vec![EffectKind::InstrumentDrift], ..Options::default() };
    let answer = diagnose(&measured(GOOD, creep), None, &stable);
    assert_eq!((answer.verdict, names(&answer)), (Verdict::Named, vec!["warmup.X"]));
}

/// Rails that meet with a step over 12 mm, where the model's step is narrower: one cause, no damage beside it.
#[test]
fn the_flank_of_a_joint_is_no_damage() {
    let step = |row: &Row| {
        let along = (row.command.linear_mm.z - 200.0) / 12.0;
        Vector::new(5.0 * along.clamp(-1.0, 1.0), 0.0, 0.0)
    };
    let answer = diagnose(&measured(GOOD, step), None, &Options::default());
    assert!(names(&answer).iter().all(|name| !name.starts_with("local.")), "{:?}", names(&answer));
}

/// A product of two places: curves and lines of hundreds of micrometres that cancel explain it, and are no name.
#[test]
fn causes_that_cancel_are_no_name() {
    let sides = |row: &Row| {
        let at = row.command.linear_mm;
        let half = (at.y - 200.0) / 200.0;
        Vector::new(0.0, 0.0, if at.x > 190.0 { 22.0 * half } else { -14.0 * half })
    };
    let answer = diagnose(&measured(GOOD, sides), None, &Options::default());
    assert_ne!(answer.verdict, Verdict::Named, "{:?}", names(&answer));
    assert!(!answer.corrects() || answer.verdict == Verdict::Ambiguous, "{:?}", names(&answer));
}

/// Full circles of a bar in XY, both ways and at two feeds, a reading every degree.
fn circles(field_um: impl Fn(&Row) -> Vector) -> Measurements {
    const RADIUS_MM: f64 = 150.0;
    const NOISE_UM: f64 = 0.25;
    let mut random = ChaCha8Rng::seed_from_u64(7);
    let base = measured(SILENT, nothing);
    let mut data = Measurements { runs: Vec::new(), rows: Vec::new(), ..base.clone() };
    let tool_mm = Vector::new(0.0, 0.0, -120.0);
    let centre = Vector::new(220.0, 190.0, 250.0);
    for run in 0..8 {
        let (feed, sense) = (if run < 4 { 600.0 } else { 3000.0 }, if run % 2 == 0 { 1.0 } else { -1.0 });
        data.runs.push(format!("circle {run}"));
        for degree in 0..360 {
            let angle = sense * f64::from(degree).to_radians() + 0.007;
            let mut row = base.rows[0];
            row.run = run;
            row.command.linear_mm =
                centre + RADIUS_MM * Vector::new(units::math::cos(angle), units::math::sin(angle), 0.0);
            row.command.tool_mm = tool_mm;
            let signs = [-units::math::sin(angle), units::math::cos(angle)]
                .map(|v| if sense * v > 0.0 { 1 } else { -1 });
            row.command.direction = [signs[0], signs[1], 0];
            row.conditions = Conditions { feed_mm_min: Some(feed), ..Conditions::default() };
            row.reading = Reading::Length { length_mm: 0.0, ball_mm: centre + tool_mm };
            data.rows.push(row);
        }
    }
    data.follow();
    for row in &mut data.rows {
        let bar = row.command.linear_mm - centre + 1e-3 * field_um(row);
        let length_mm = bar.norm() + 1e-3 * NOISE_UM * normal(&mut random);
        row.reading = Reading::Length { length_mm, ball_mm: centre + tool_mm };
    }
    data
}

/// The marks at the quadrants are read where they stand: a share of the whole circle they hardly have.
#[test]
fn a_mark_at_a_quadrant_is_told_beside_larger_faults() {
    let field = |row: &Row| {
        let spike = 9.0 * units::math::exp(-row.conditions.since_turn_mm[0].unwrap() / 3.0);
        let direction = row.command.direction.map(f64::from);
        Vector::new(-(6.0 + spike) * direction[0], -5.0 * direction[1] + 0.07 * row.command.linear_mm.x, 0.0)
    };
    let answer = diagnose(&circles(field), None, &Options::default());
    let mut found = names(&answer);
    found.sort_unstable();
    assert_eq!(found, ["backlash.X", "backlash.Y", "spike.X", "squareness.XY"], "{:?}", answer.verdict);
}

/// A scale, a squareness, a bow and a lost motion: curves that mend each other come first, and give way.
#[test]
fn straight_faults_are_not_taken_for_curves_that_mend_each_other() {
    for sign in [1.0, -1.0] {
        let field = |row: &Row| {
            let at = row.command.linear_mm - Vector::new(220.0, 190.0, 250.0);
            let bow = sign * 10.0 * units::math::cos(at.y / 37.5 + 0.6);
            let lost = 6.4 * f64::from(row.command.direction[0]);
            Vector::new(-0.062 * at.y + bow, -0.073 * at.y + lost, 0.0)
        };
        let answer = diagnose(&circles(field), None, &Options::default());
        let mut found = names(&answer);
        found.sort_unstable();
        let true_ones = ["lost-motion.EYX", "scale.Y", "squareness.XY", "straightness.EXY"];
        assert_eq!(found, true_ones, "{:?}", answer.verdict);
    }
}
