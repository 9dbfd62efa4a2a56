//! Puts pages of an earlier version into the present style, in their place: `dress FILE KIND …`.

use std::error::Error;
use std::fs;

use phihat_report::kit::dressed::dressed;

fn main() -> Result<(), Box<dyn Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    for pair in words.chunks_exact(2) {
        let [file, kind] = pair else { continue };
        let page = dressed(&fs::read_to_string(file)?, kind);
        fs::write(file, page.ok_or_else(|| format!("{file}: no page of phihat"))?)?;
    }
    Ok(())
}
