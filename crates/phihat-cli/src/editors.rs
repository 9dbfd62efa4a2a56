//! `phihat schema`, `phihat completions`, `phihat man`: what editors and shells want to know of phihat.

use std::process::ExitCode;

use clap::{Args, Command};
use clap_complete::Shell;
use serde_json::json;

use crate::failure::Failure;

/// Print the JSON schema of a study: an editor that has it completes and checks keys.
///
/// A study whose first line is `#:schema PATH` has its own; most editors with TOML support read that line.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  phihat schema")]
pub(crate) struct Schema {
    /// Nothing changes: the schema is a JSON document.
    #[arg(long)]
    pub(crate) json: bool,
}

/// Print what completes phihat's words in a shell.
///
/// bash: `phihat completions bash > ~/.local/share/bash-completion/completions/phihat`
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  phihat completions bash")]
pub(crate) struct Completions {
    /// The shell.
    shell: Shell,
    /// Print one JSON document: the text.
    #[arg(long)]
    json: bool,
}

/// Print the manual page of phihat, or of a verb: `phihat man run | man -l -`.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  phihat man check")]
pub(crate) struct Man {
    /// The verb [default: phihat itself].
    verb: Option<String>,
    /// Print one JSON document: the text.
    #[arg(long)]
    json: bool,
}

/// The schema, which is JSON anyway.
pub(crate) fn schema() -> ExitCode {
    print!("{}", phihat_study::schema());
    ExitCode::SUCCESS
}

impl Completions {
    pub(crate) fn execute(&self, mut phihat: Command) -> Result<ExitCode, Failure> {
        let mut script = Vec::new();
        clap_complete::generate(self.shell, &mut phihat, "phihat", &mut script);
        tell(script, self.json)
    }
}

impl Man {
    pub(crate) fn execute(&self, mut phihat: Command) -> Result<ExitCode, Failure> {
        phihat.build();
        let shown = match &self.verb {
            None => phihat,
            Some(verb) => phihat.find_subcommand(verb).cloned().ok_or_else(|| {
                let verbs = phihat.get_subcommands().map(Command::get_name);
                let verbs: Vec<_> = verbs.filter(|verb| *verb != "help").collect();
                Failure::plain(format!("there is no verb `{verb}`; there are {}", verbs.join(", ")))
            })?,
        };
        let name = shown.get_display_name().unwrap_or_else(|| shown.get_name()).to_owned();
        let page = clap_mangen::Man::new(shown.disable_help_subcommand(true)).title(name);
        let mut text = Vec::new();
        page.render(&mut text).map_err(Failure::plain)?;
        tell(text, self.json)
    }
}

fn tell(text: Vec<u8>, as_json: bool) -> Result<ExitCode, Failure> {
    let text = String::from_utf8(text).map_err(Failure::plain)?;
    if as_json {
        println!("{:#}", json!({ "text": text }));
    } else {
        print!("{text}");
    }
    Ok(ExitCode::SUCCESS)
}
