//! Where the grammars are: above in a clone, inside the crate where it was published.

fn main() {
    let inside = concat!(env!("CARGO_MANIFEST_DIR"), "/grammars");
    // Inside, a clone has a link for the packer's eyes; where links are not made it is a file with a name in it.
    let above = concat!(env!("CARGO_MANIFEST_DIR"), "/../../grammars");
    let folder = if std::path::Path::new(above).is_dir() { above } else { inside };
    println!("cargo::rustc-env=GRAMMARS={folder}");
    println!("cargo::rerun-if-changed=build.rs");
}
