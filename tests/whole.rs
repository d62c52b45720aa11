//! The command and its files, as a whole: all tests of the roof in one binary, linked once.
//!
//! `cargo test -p vpost --test whole closed_loop::` runs one file's.

mod common;
#[path = "../xtask/src/five_axis_samples.rs"]
mod five_axis_parts;
#[path = "common/folders.rs"]
mod folders;
#[path = "common/tip_program.rs"]
mod tip_program;
#[path = "../xtask/src/wrap.rs"]
mod wrap;
#[path = "../xtask/src/zhang.rs"]
mod zhang_table;

mod arcs;
mod batch;
mod batch_cluster;
mod batch_engines;
mod batch_kill;
mod batch_shop;
mod browser;
mod browser_alone;
mod browser_calibrate;
mod browser_lathe;
mod browser_pages;
mod browser_viewer;
mod budget;
mod calibrate;
mod calibrate_interferometer;
mod calibrate_machine;
mod calibrate_pages;
mod calibrate_rtest;
mod calibrate_turning;
mod cam;
mod closed_loop;
mod controls;
mod corpus;
mod curves;
mod datum;
mod devtools;
mod diagnose;
mod diagnose_plan;
mod dialects;
mod docs;
mod effects;
mod export;
mod field;
mod files;
mod five_axis;
mod five_axis_samples;
mod flow;
mod gap_smoke;
mod guard;
mod help;
mod holes;
mod identity;
mod large;
mod lsp;
mod map;
mod measured_designs;
mod ms300;
mod newcomer;
mod on_a_terminal;
mod one_block;
mod options;
mod orientation;
mod pairs;
mod path_control;
mod points;
mod profile_new;
mod real_machines;
mod refusals;
mod restart;
mod russian;
mod s_wall;
mod settings;
mod shop_floor;
mod spreadsheets;
mod swivel;
mod tool_lengths;
mod traps;
mod turning;
mod watch;
mod words;
mod zhang;
