//! Printed numbers beside ours: `docs/reproduction.md`.

mod calibration;
mod lathe;
mod rotary;
mod rotations;
mod solutions;
mod targets;

/// The page `docs/reproduction.md`.
pub(crate) fn page() -> String {
    let mut text = String::from(
        "# Reproduction\n\n\
         Every printed number that the project keeps (`samples/published`), recomputed from the measurements in \
         `machine-profiles/stan_s500`, and what is wrong in the publication. Source: Pimushkin 2023 (dissertation, STANKIN), chapters \
         2 to 4 and appendices A to D.\n\n\
         Made by `cargo run -p xtask -- reproduction > docs/reproduction.md`; `cargo test -p machine-model published` asserts \
         every number to its last printed digit, `cargo test -p xtask` compares this page. Single points are shown by the \
         command as well:\n\n\
         ```sh\n\
         vpost solve samples/points/tangential_targets.csv -m machine-profiles/stan_s500.toml --engine tangential-static-published\n\
         vpost solve samples/points/tangential_targets.csv -m machine-profiles/stan_s500.toml --engine tangential-interval-published\n\
         vpost solve samples/points/tangential_targets.csv -m machine-profiles/stan_s500.toml --engine tangential-quasi-differential-published\n\
         vpost solve samples/points/tangential_targets.csv -m machine-profiles/stan_s500.toml --engine tangential-quasi-differential\n\
         vpost solve samples/points/tangential_targets.csv -m machine-profiles/stan_s500.toml --engine kmtpp-published\n\
         vpost solve samples/points/tangential_targets.csv -m machine-profiles/stan_s500.toml --engine kmtpp-published --gain 1 --step 0.05\n\
         ```\n\n",
    );
    text += &solutions::tangential();
    text += &solutions::cosines();
    text += &solutions::kmtpp();
    text += &rotations::section();
    text += &targets::section();
    text += "\n";
    text += &calibration::section();
    text += &rotary::section();
    text += &lathe::section();
    crate::wrap::wrapped(&text)
}

#[cfg(test)]
mod tests {
    #[test]
    fn the_page_in_docs_is_the_one_that_is_made() {
        assert!(
            include_str!("../../docs/reproduction.md") == super::page(),
            "run `cargo run -p xtask -- reproduction > docs/reproduction.md`"
        );
    }
}
