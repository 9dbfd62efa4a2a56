//! Output on a terminal. Wrong if a table is wider than the terminal, if a figure is broken or lost where
//! there is less room, if colours come where nobody asked for them, or if a quiet command says more than what
//! is wrong.

use std::collections::BTreeSet;
use std::path::Path;
use std::process::Command;

use crate::support::{Answer, answer, folder, wait_for};

fn with(folder: &Path, arguments: &[&str], environment: &[(&str, &str)]) -> Answer {
    let mut command = Command::new(env!("CARGO_BIN_EXE_phihat"));
    let command = command.args(arguments).current_dir(folder);
    answer(command.env_remove("NO_COLOR").envs(environment.iter().copied()))
}

/// Lines of tables.
fn rows(text: &str) -> impl Iterator<Item = &str> {
    text.lines().filter(|line| line.starts_with(['│', '┌', '└', '╞']))
}

/// Words of tables that are figures.
fn figures(text: &str) -> BTreeSet<String> {
    let inside = rows(text).flat_map(|row| row.split(['│', ' ']));
    let figure = |word: &&str| word.len() > 3 && word.parse::<f64>().is_ok();
    inside.filter(figure).map(str::to_owned).collect()
}

#[test]
fn tables_fit_the_terminal_and_lose_nothing() {
    let folder = folder("widths");
    let verbs: [&[&str]; 6] = [
        &["run", "studies/first.toml"],
        &["robots"],
        &["robots", "panda"],
        &["compare", "--list"],
        &["compare", "--rival", "computed-torque"],
        &["design", "studies/table1.toml", "--limit"],
    ];
    for arguments in verbs {
        let whole = with(&folder, arguments, &[]);
        assert_eq!(whole.code, 0, "{arguments:?}: {}", whole.err);
        assert!(rows(&whole.out).count() > 3, "{arguments:?} has no table: {}", whole.out);
        for columns in [60, 80, 200] {
            let shown = with(&folder, arguments, &[("COLUMNS", &columns.to_string())]);
            for row in rows(&shown.out) {
                // A dot above stands on the letter before it.
                let wide = row.chars().filter(|c| *c != '\u{307}').count();
                assert!(wide <= columns, "{arguments:?}: {wide} of {columns} columns:\n{row}");
            }
            let (all, here) = (figures(&whole.out), figures(&shown.out));
            assert!(all.is_subset(&here), "{arguments:?} at {columns}: {:?}", &all - &here);
        }
    }
}

#[test]
fn colours_are_there_where_they_are_asked_for() {
    let folder = folder("colours");
    let good = ["check", "studies/first.toml"];
    let bad = ["check", "nowhere.toml"];
    let usage = ["walk"];
    let coloured = |arguments: &[&str], extra: &[&str], environment: &[(&str, &str)]| {
        let answer = with(&folder, &[arguments, extra].concat(), environment);
        format!("{}{}", answer.out, answer.err).contains('\u{1b}')
    };
    for arguments in [&good[..], &bad, &usage] {
        assert!(!coloured(arguments, &[], &[]), "{arguments:?}: there is no terminal");
        assert!(coloured(arguments, &["--color", "always"], &[]), "{arguments:?}");
        assert!(coloured(arguments, &["--color=always"], &[]), "{arguments:?}");
        assert!(!coloured(arguments, &["--color", "never"], &[("CLICOLOR_FORCE", "1")]));
        assert!(coloured(arguments, &[], &[("CLICOLOR_FORCE", "1")]), "{arguments:?}");
        let both = [("NO_COLOR", "1"), ("CLICOLOR_FORCE", "1")];
        assert!(!coloured(arguments, &[], &both), "{arguments:?}");
    }
    // Nothing but colours differs.
    let plain = with(&folder, &good, &[]).out;
    let painted = with(&folder, &["--color", "always", good[0], good[1]], &[]).out;
    let stripped =
        painted.replace("\u{1b}[1m", "").replace("\u{1b}[32m", "").replace("\u{1b}[0m", "");
    assert_eq!(plain, stripped);
    // A document has none.
    let document = with(&folder, &["check", "nowhere.toml", "--json", "--color", "always"], &[]);
    assert!(!document.out.contains('\u{1b}') && document.out.starts_with('{'), "{}", document.out);
}

#[test]
fn quiet_is_quiet_but_for_what_is_wrong_and_what_was_asked_for() {
    let folder = folder("quiet");
    for arguments in [
        &["run", "studies/first.toml", "-q"][..],
        &["--quiet", "verify", "--run", "out/first"],
        &["robots", "-q"],
        &["check", "studies/first.toml", "-q"],
        &["report", "out/first/trace.parquet", "-q"],
    ] {
        let answer = with(&folder, arguments, &[]);
        assert_eq!(
            (answer.code, answer.out.as_str(), answer.err.as_str()),
            (0, "", ""),
            "{arguments:?}"
        );
    }
    assert!(folder.join("out/first/report.html").exists());
    let wrong = with(&folder, &["run", "nowhere.toml", "-q"], &[]);
    assert!(wrong.code == 2 && wrong.err.contains("nowhere.toml"), "{}", wrong.err);
    let document = with(&folder, &["robots", "-q", "--json"], &[]);
    assert!(document.out.starts_with('['), "{}", document.out);
}

#[cfg(target_os = "linux")]
#[test]
fn a_page_is_opened_where_that_is_asked_for() {
    use std::os::unix::fs::PermissionsExt as _;
    let folder = folder("open");
    let (browser, seen) = (folder.join("bin/xdg-open"), folder.join("seen"));
    std::fs::create_dir_all(folder.join("bin")).unwrap();
    let script =
        format!("#!/bin/sh\nprintf %s \"$1\" > {0}.part\nmv {0}.part {0}\n", seen.display());
    std::fs::write(&browser, script).unwrap();
    std::fs::set_permissions(&browser, std::fs::Permissions::from_mode(0o755)).unwrap();
    let path = format!("{}:/usr/bin:/bin", folder.join("bin").display());
    let run = |arguments: &[&str], path: &str| with(&folder, arguments, &[("PATH", path)]);
    assert_eq!(run(&["run", "studies/first.toml"], &path).code, 0);
    assert!(!seen.exists(), "nobody asked");
    let page = "out/first/report.html";
    for arguments in [
        &["report", "out/first/trace.parquet", "--open"][..],
        &["run", "studies/first.toml", "--open"],
    ] {
        let opened = run(arguments, &path);
        assert_eq!((opened.code, opened.err.as_str()), (0, ""));
        // The browser is not waited for.
        wait_for("the browser is started", || seen.exists());
        assert_eq!(std::fs::read_to_string(&seen).unwrap(), page, "{arguments:?}");
        std::fs::remove_file(&seen).unwrap();
    }
    let nowhere = folder.join("studies").display().to_string();
    let told = run(&["report", "out/first/trace.parquet", "--open"], &nowhere);
    assert!(
        told.code == 0 && told.err.starts_with("warning: out/first/report.html"),
        "{}",
        told.err
    );
    // Verbs without a page have nothing to open.
    assert_eq!(run(&["design", "studies/first.toml", "--open"], &path).code, 2);
}

#[test]
fn editors_and_shells_are_told_what_there_is() {
    let folder = folder("editors");
    let schema = with(&folder, &["schema"], &[]);
    let kept = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/study.schema.json");
    assert_eq!(schema.out, std::fs::read_to_string(kept).unwrap());
    let help = with(&folder, &["--help"], &[]).out;
    let verbs = help.lines().skip_while(|line| *line != "Commands:").skip(1);
    let verbs = verbs.take_while(|line| !line.is_empty());
    let verbs: Vec<&str> =
        verbs.filter_map(|line| line.strip_prefix("  ")?.split(' ').next()).collect();
    let verbs: Vec<&str> =
        verbs.into_iter().filter(|verb| !verb.is_empty() && *verb != "help").collect();
    assert!(verbs.len() >= 14, "{verbs:?}");
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let script = with(&folder, &["completions", shell], &[]);
        assert_eq!(script.code, 0, "{}", script.err);
        for verb in &verbs {
            assert!(script.out.contains(verb), "{shell}: {verb}");
        }
    }
    // A shell takes it, and completes the verb.
    let ask = "eval \"$(\"$1\" completions bash)\"; COMP_WORDS=(phihat simu); COMP_CWORD=1; \
               _phihat phihat simu phihat; echo \"${COMPREPLY[@]}\"";
    let binary = env!("CARGO_BIN_EXE_phihat");
    let completed = answer(Command::new("bash").args(["-c", ask, "bash", binary]));
    assert_eq!(completed.out.trim(), "simulate", "{}", completed.err);
    for verb in &verbs {
        let page = with(&folder, &["man", verb], &[]).out;
        assert!(page.contains(".SH NAME") && page.contains(&format!("phihat\\-{verb}")), "{page}");
    }
    assert!(with(&folder, &["man"], &[]).out.contains(".TH phihat 1"));
    let wrong = with(&folder, &["man", "walk"], &[]);
    assert!(wrong.code == 2 && wrong.err.contains("simulate"), "{}", wrong.err);
}
