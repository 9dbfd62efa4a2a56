//! A run whose record is written as it comes. Wrong if its page or figures were not those of the run as a
//! whole, or if one that is stopped left anything behind.

use std::fs;
use std::path::Path;

use crate::support::{files_of, folder, interrupted, json as run, swing};
use phihat_session::Session;
use phihat_study::Study;
use serde_json::json;

#[test]
fn the_page_of_blocks_is_the_page_of_the_whole() {
    let folder = folder("blocks");
    // Longer than a block, and with a tube.
    let text = swing(6.0);
    fs::write(folder.join("swing.toml"), &text).unwrap();
    run(&folder, &["run", "swing.toml", "--out", "out", "--json"]);
    let study = Study::from_text(&text, "swing.toml", &folder).unwrap();
    let session = Session::new(Box::new(study), Path::new("swing.toml"), None, false).unwrap();
    let (done, trace) = session.run(|_| ());
    assert!(trace.len() > phihat_sim::BLOCK && done.tube.is_some());
    let figures = fs::read_to_string(folder.join("out/metrics.json")).unwrap();
    assert_eq!(format!("{:#}\n", json!(done.figures())), figures);
    let mut file = Vec::new();
    trace.write_parquet(&mut file).unwrap();
    assert!(fs::read(folder.join("out/trace.parquet")).unwrap() == file, "the traces differ");
    let page = fs::read_to_string(folder.join("out/report.html")).unwrap();
    let whole = phihat_report::page(&done.record());
    assert!(page == whole, "the pages differ: {} and {} bytes", page.len(), whole.len());
}

#[test]
fn a_run_that_is_stopped_leaves_what_was_there() {
    let folder = folder("blocks-stopped");
    let long = include_str!("../../../studies/first.toml");
    fs::write(folder.join("first.toml"), long).unwrap();
    run(&folder, &["run", "first.toml", "--out", "out", "--json"]);
    let before = files_of(&folder.join("out"));
    let line = long.lines().find(|line| line.starts_with("duration_s")).unwrap();
    fs::write(folder.join("first.toml"), long.replace(line, "duration_s = 3600.0")).unwrap();
    let stopped = interrupted(&folder, &["run", "first.toml", "--out", "out"], "out/trace.parquet");
    assert_eq!(stopped.code, 130, "{}", stopped.err);
    assert!(stopped.err.contains("nothing was written"), "{}", stopped.err);
    assert!(files_of(&folder.join("out")) == before, "{}", stopped.err);
}
