//! `include/phihat.h` is what cbindgen makes of this crate; `PHIHAT_BLESS=1 cargo test -p phihat-c header` writes it.

use std::path::Path;

#[test]
fn the_header_is_current() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let config = cbindgen::Config::from_file(root.join("cbindgen.toml")).unwrap();
    let sources = ["types", "error", "controller", "guard", "supervisor", "gate"]
        .map(|name| root.join(format!("src/{name}.rs")));
    let mut builder = cbindgen::Builder::new().with_config(config);
    for source in sources {
        builder = builder.with_src(source);
    }
    let mut made = Vec::new();
    builder.generate().unwrap().write(&mut made);
    let made = String::from_utf8(made).unwrap();
    let path = root.join("include/phihat.h");
    if std::env::var_os("PHIHAT_BLESS").is_some() {
        std::fs::write(&path, &made).unwrap();
    }
    let kept = std::fs::read_to_string(&path).unwrap();
    assert_eq!(
        kept, made,
        "include/phihat.h is stale: PHIHAT_BLESS=1 cargo test -p phihat-c header"
    );
}
