//! Where the pages of messages are: above in a clone, inside the crate where it was published.

fn main() {
    for (variable, name) in
        [("DIAGNOSTICS_PAGE", "diagnostics.md"), ("DIAGNOSTICS_PAGE_RU", "diagnostics.ru.md")]
    {
        let crate_folder = env!("CARGO_MANIFEST_DIR");
        // Inside, a clone has a link for the packer's eyes; where links are not made it is a file with a name in it.
        let above = format!("{crate_folder}/../../docs/{name}");
        let inside = format!("{crate_folder}/{name}");
        let page = if std::path::Path::new(&above).is_file() { above } else { inside };
        println!("cargo::rustc-env={variable}={page}");
    }
    println!("cargo::rerun-if-changed=build.rs");
}
