//! Where the page of messages is: above in a clone, inside the crate where it was published.

fn main() {
    let inside = concat!(env!("CARGO_MANIFEST_DIR"), "/diagnostics.md");
    // Inside, a clone has a link for the packer's eyes; where links are not made it is a file with a name in it.
    let above = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/diagnostics.md");
    let page = if std::path::Path::new(above).is_file() { above } else { inside };
    println!("cargo::rustc-env=DIAGNOSTICS_PAGE={page}");
    println!("cargo::rerun-if-changed=build.rs");
}
