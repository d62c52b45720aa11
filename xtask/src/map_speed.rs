//! How fast maps and zero-point searches are, against all pairs in the same run.

use std::hint::black_box;
use std::time::{Duration, Instant};

use error_map::zero_point::{best_node, best_share, geometric_median, smallest_ball};
use error_map::{Grid, Nodes};
use machine_model::{Command, PathModel, Range, Vector};
use rayon::prelude::*;

use crate::stan_s500::{rigid_body, squareness, tables, traverses};

/// Shortest of some runs: what the machine can do when nobody else uses it.
fn shortest<T>(runs: u32, mut work: impl FnMut() -> T) -> Duration {
    let time = |work: &mut dyn FnMut() -> T| {
        let from = Instant::now();
        black_box(work());
        from.elapsed()
    };
    (0..runs).map(|_| time(&mut work)).min().unwrap_or_default()
}

/// The figures as text.
pub(crate) fn page() -> String {
    let machine = rigid_body(&tables(), squareness(&tables(), &traverses(315)));
    let map = |counts: [u64; 3], threads: usize| {
        let lengths = [400.0, 280.0, 200.0];
        let axis = |i: usize| Nodes::over(Range { low: 0.0, high: lengths[i] }, counts[i]).expect("nodes");
        let grid = Grid::new([axis(0), axis(1), axis(2)]).expect("a grid");
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        let error =
            |i: usize| machine.error_mm(&Command { linear_mm: grid.place_mm(i), ..Default::default() });
        pool.install(|| (0..grid.len()).into_par_iter().with_min_len(256).map(error).collect::<Vec<Vector>>())
    };
    let published = map([22, 22, 21], 1);
    let million = map([100, 100, 100], 2);
    let all_pairs = || {
        let sum = |k: &Vector| published.iter().map(|d| (d - k).norm()).sum::<f64>();
        published.iter().map(sum).enumerate().min_by(|a, b| a.1.total_cmp(&b.1))
    };
    let ms = |d: Duration| d.as_secs_f64() * 1e3;
    let pairs = ms(shortest(1, all_pairs));
    let node = ms(shortest(5, || best_node(&published)));
    let [one, two] = [1, 2].map(|threads| ms(shortest(3, || map([100, 100, 100], threads))));
    let mut out = format!(
        "map of 1,000,000 nodes              1 thread {one:.0} ms, 2 threads {two:.0} ms, ratio {:.2}\n\
         best node of 10,164                 {node:.2} ms on one core; all pairs {pairs:.0} ms, ratio {:.0}\n",
        one / two,
        pairs / node
    );
    for (count, errors) in [(10_164, &published), (1_000_000, &million)] {
        out += &format!(
            "geometric median of {count:<15} {:.2} ms\nsmallest ball of {count:<18} {:.2} ms\nbest share of {count:<21} {:.0} ms\n",
            ms(shortest(3, || geometric_median(errors))),
            ms(shortest(3, || smallest_ball(errors))),
            ms(shortest(1, || best_share(errors, 0.020))),
        );
    }
    out + &format!("best node of 1000000                {:.0} ms\n", ms(shortest(1, || best_node(&million))))
}
