//! The Python messages of the examples are those of the Rust types. `just layouts` writes them again.

use std::path::Path;

#[test]
fn the_python_messages_are_written_from_the_rust_types() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/python/messages.py");
    let written = common::layout::python();
    if std::env::var_os("WRITE_LAYOUTS").is_some() {
        std::fs::write(&file, &written).expect("writing the messages");
    }
    let present = std::fs::read_to_string(&file).unwrap_or_default();
    assert!(present == written, "{} is not that of the Rust types: run `just layouts`", file.display());
}
