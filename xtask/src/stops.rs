//! Stops by the thousand: `cargo xtask stops [N]`.

use std::path::Path;
use std::process::Command;

use crate::shell;

/// The campaigns: package, test.
const CAMPAIGNS: [(&str, &str); 3] =
    [("phihat", "f31_"), ("phihat", "f36_"), ("phihat-sim", "f32_a_stop")];

/// N stops of coupled arms of the tests' own, N pushes that their drives cannot hold, and N stops of the arms of the
/// repository.
pub(crate) fn run(root: &Path, arguments: &[String]) -> Result<(), String> {
    let number = arguments.first().map_or("10000", String::as_str);
    for (package, name) in CAMPAIGNS {
        let test = ["test", "--quiet", "-p", package, "--test", "tests", name, "--", "--nocapture"];
        shell::run(Command::new("cargo").args(test).env("PHIHAT_STOPS", number).current_dir(root))?;
    }
    Ok(())
}
