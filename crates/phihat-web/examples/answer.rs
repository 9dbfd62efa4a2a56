//! Answers tasks of a page on this machine: `answer < task.json`, one task per line, one answer per line.

use std::io::{self, BufRead as _, Write as _};

fn main() -> io::Result<()> {
    for task in io::stdin().lock().lines() {
        writeln!(io::stdout(), "{}", phihat_web::answer(&task?, &|_| ()))?;
    }
    Ok(())
}
