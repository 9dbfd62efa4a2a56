//! `phihat export` writes to the terminal or to a file, the same text, and says in it whether anything is certified.

use std::fs;

use crate::support::{folder, json, phihat, swing};

#[test]
fn terminal_file_and_json_hold_the_same_text() {
    let folder = folder("export");
    let pid = swing(1.5).replace("[design]\n", "[design]\norders = [1]\n");
    fs::write(folder.join("pid.toml"), pid).unwrap();
    assert_eq!(phihat(&folder, &["design", "pid.toml", "--out", "gains.json"]).code, 0);
    for format in ["ros", "c-header", "csv"] {
        let arguments = ["export", "gains.json", "--format", format];
        let shown = phihat(&folder, &arguments);
        assert_eq!(shown.code, 0, "{}", shown.err);
        let named = phihat(&folder, &[&arguments[..], &["--out", "file"]].concat());
        assert_eq!((named.code, named.out.as_str()), (0, "exported: file\n"));
        assert_eq!(fs::read_to_string(folder.join("file")).unwrap(), shown.out);
        let document = json(&folder, &[&arguments[..], &["--json"]].concat());
        assert_eq!(document["text"].as_str(), Some(shown.out.as_str()));
        assert_eq!(document["certified"].as_bool(), Some(true));
        assert!(shown.out.contains("joint1") && !shown.out.contains("UNCERTIFIED"));
        // What the target lacks is told in every one.
        assert!(
            shown.out.contains("Acceleration feed-forward") && shown.out.contains("modulus margin")
        );
    }
}
