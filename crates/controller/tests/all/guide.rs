//! The guide for authors shows code that is compiled and run.

const GUIDE: &str = include_str!("../../../../docs/plugins.md");
const EXAMPLE: &str = include_str!("../../examples/low_pass.rs");

#[test]
fn the_plugin_in_the_guide_is_the_example_of_this_crate() {
    let start = EXAMPLE.find("use blocksim_controller").unwrap();
    let end = EXAMPLE.find("// For this example only").unwrap();
    let plugin = EXAMPLE[start..end].trim_end();
    assert!(GUIDE.contains(&format!("```rust\n{plugin}\n```")), "copy the example into the guide");
}

#[test]
fn files_that_the_guide_names_exist() {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let named = GUIDE.split('`').filter(|word| {
        (word.starts_with("crates/") || word.starts_with("plugins/")) && !word.contains("low_pass")
    });
    let mut count = 0;
    for path in named.filter(|path| !path.contains(char::is_whitespace)) {
        assert!(root.join(path).exists(), "{path}");
        count += 1;
    }
    assert!(count >= 5, "{count} paths");
}
