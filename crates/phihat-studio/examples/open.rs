//! A studio of a study, from Rust: prints a document with the address to open, and serves until it is ended.
//!
//! `cargo run -p phihat-studio --example open -- STUDY [GAINS]`, in the folder that is to be worked in.
#![allow(clippy::print_stdout, reason = "an example speaks to a terminal")]

use std::path::PathBuf;

use phihat_studio::{StudioError, StudioOptions};

fn main() -> Result<(), StudioError> {
    let files = std::env::args().skip(1).filter(|word| word != "studio" && !word.starts_with("--"));
    let mut files = files.map(PathBuf::from);
    let study = files.next().unwrap_or_else(|| "studies/first.toml".into());
    let folder = PathBuf::from(".");
    let studio = StudioOptions {
        study: Some(study),
        gains: files.next(),
        folder,
        ..StudioOptions::default()
    }
    .open()?;
    println!("{{\"open\":{:?}}}", studio.link());
    studio.serve()
}
