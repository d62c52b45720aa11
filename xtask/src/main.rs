//! Long checks: benchmarks, corpora, tables for the docs.
fn main() {}
