//! Shares of a manifest's programs.

use diagnostic::{Code, notice};

use super::arguments::EngineForm;
use crate::message::Failure;

/// A share that does not exist.
const SHARD: Code = Code(1009);

/// Environment variables that number a task, and the number of the first.
///
/// In this order: a HyperQueue worker may run inside a Slurm array's task or a Kubernetes job, and then the innermost
/// numbers the tasks.
const TASK_NUMBERS: [(&str, u32); 3] =
    [("HQ_TASK_ID", 1), ("SLURM_ARRAY_TASK_ID", 1), ("JOB_COMPLETION_INDEX", 0)];

/// The I-th of N shares: the programs I, I + N, I + 2 N … of the manifest.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Shard {
    /// From 1.
    pub number: u32,
    pub of: u32,
}

impl Shard {
    /// Reads `I/N` or `auto/N`; all programs where nothing is said.
    pub(crate) fn read(
        given: Option<&str>,
        variable: impl Fn(&str) -> Option<String>,
    ) -> Result<Self, Failure> {
        let Some(given) = given else { return Ok(Self { number: 1, of: 1 }) };
        let whole = |text: &str| text.trim().parse::<u32>().ok();
        let Some((number, of)) = given.split_once('/') else { return Err(unreadable(given)) };
        let of = whole(of).filter(|of| *of > 0).ok_or_else(|| unreadable(given))?;
        let (number, said) = if number == "auto" {
            let found = TASK_NUMBERS.iter().find_map(|(name, first)| Some((*name, *first, variable(name)?)));
            let Some((name, first, value)) = found else {
                let names = TASK_NUMBERS.map(|(name, _)| name).join(", ");
                return Err(Failure::usage(notice!(SHARD;
                    "`--shard {given}` takes its number from the environment, and none of {names} is set",
                    "`--shard {given}` берёт номер из окружения, а ни одна из переменных {names} не задана";
                    "outside of a task array say it yourself: `--shard 1/{of}`",
                    "вне массива заданий назовите его сами: `--shard 1/{of}`"
                )));
            };
            // Below the first number: shard 0, which is told below.
            let number = whole(&value).map(|value| value.saturating_add(1).saturating_sub(first));
            (number.ok_or_else(|| unreadable(&format!("{name}={value}")))?, format!("{name}={value}"))
        } else {
            (whole(number).ok_or_else(|| unreadable(given))?, format!("--shard {given}"))
        };
        if (1..=of).contains(&number) {
            Ok(Self { number, of })
        } else {
            Err(Failure::usage(notice!(SHARD;
                "`{said}`: there is no shard {number} of {of}", "`{said}`: части {number} из {of} нет";
                "shards are numbered from 1: submit the array as 1-{of}",
                "части нумеруются с 1: отправляйте массив как 1-{of}"
            )))
        }
    }

    /// True for the programs of this share; `index` counts from 0.
    pub(crate) fn has(self, index: usize) -> bool {
        Self::number_of(index, self.of) == self.number
    }

    /// The share that holds a program.
    pub(crate) fn number_of(index: usize, of: u32) -> u32 {
        u32::try_from(index % of as usize).expect("below a u32") + 1
    }
}

fn unreadable(given: &str) -> Failure {
    Failure::usage(notice!(SHARD;
        "`{given}` is no shard", "`{given}` — не часть";
        "write `--shard 3/10` or, in a task array, `--shard auto/10`",
        "напишите `--shard 3/10` или, в массиве заданий, `--shard auto/10`"
    ))
}

/// Numbers in the form an engine takes, in ascending order: `1,4-6` or one a line.
pub(crate) fn array(numbers: &[u32], form: EngineForm) -> String {
    if form == EngineForm::Parallel {
        return numbers.iter().map(|number| format!("{number}\n")).collect();
    }
    let mut ranges: Vec<(u32, u32)> = Vec::new();
    for number in numbers {
        match ranges.last_mut() {
            Some((_, last)) if *last + 1 == *number => *last = *number,
            _ => ranges.push((*number, *number)),
        }
    }
    let text = |(first, last): &(u32, u32)| {
        if first == last { first.to_string() } else { format!("{first}-{last}") }
    };
    ranges.iter().map(text).collect::<Vec<_>>().join(",")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(given: &str, variables: &[(&str, &str)]) -> Option<(u32, u32)> {
        let variable = |name: &str| {
            variables.iter().find(|(known, _)| *known == name).map(|(_, value)| (*value).to_owned())
        };
        Shard::read(Some(given), variable).ok().map(|shard| (shard.number, shard.of))
    }

    #[test]
    fn numbers_come_from_the_option_or_from_the_innermost_engine() {
        let slurm = ("SLURM_ARRAY_TASK_ID", "3");
        let hq = ("HQ_TASK_ID", "4");
        assert_eq!(read("2/10", &[slurm]), Some((2, 10)), "what is said goes first");
        assert_eq!(read("auto/10", &[slurm]), Some((3, 10)));
        assert_eq!(read("auto/10", &[slurm, hq]), Some((4, 10)), "HyperQueue inside Slurm");
        assert_eq!(
            read("auto/10", &[("JOB_COMPLETION_INDEX", "0")]),
            Some((1, 10)),
            "Kubernetes counts from 0"
        );
        assert_eq!(read("auto/10", &[("JOB_COMPLETION_INDEX", "9")]), Some((10, 10)));
    }

    #[test]
    fn what_is_no_shard_is_refused() {
        for given in ["0/4", "5/4", "1/0", "1", "a/4", "1/4/2", "-1/4", "auto/4", "auto", ""] {
            assert_eq!(read(given, &[]), None, "{given}");
        }
        // An array that starts from 0 would leave the last shard out.
        assert_eq!(read("auto/4", &[("SLURM_ARRAY_TASK_ID", "0")]), None);
        assert_eq!(read("auto/4", &[("JOB_COMPLETION_INDEX", "4")]), None);
        assert_eq!(read("auto/4", &[("HQ_TASK_ID", "x"), ("SLURM_ARRAY_TASK_ID", "1")]), None);
    }

    #[test]
    fn every_program_is_in_one_shard() {
        for of in [1, 3, 10, 50] {
            for index in 0..40 {
                let having = (1..=of).filter(|number| Shard { number: *number, of }.has(index));
                assert_eq!(having.collect::<Vec<_>>(), [Shard::number_of(index, of)]);
            }
        }
    }

    #[test]
    fn arrays_are_written_as_engines_take_them() {
        let numbers = [1, 4, 5, 6, 9, 10];
        assert_eq!(array(&numbers, EngineForm::Slurm), "1,4-6,9-10");
        assert_eq!(array(&numbers, EngineForm::Hq), "1,4-6,9-10");
        assert_eq!(array(&numbers, EngineForm::Parallel), "1\n4\n5\n6\n9\n10\n");
        assert_eq!(array(&[], EngineForm::Slurm), "");
    }
}
