//! A reproduction on an own arm as a user asks for it, taken to its files.

use std::cell::RefCell;
use std::path::{Path, PathBuf};

use phihat_session::disk::{Lock, Whole};
use phihat_session::{Watch, files};

use super::error::OwnError;
use super::make::own;
use super::page::own_page;
use super::record::OwnReproduction;
use phihat_report::kit::draw::{FigureSize, draw};

/// Options of a reproduction on an own arm.
#[derive(Debug, Clone, Default)]
pub struct OwnOptions {
    /// The study.
    pub study: PathBuf,
    /// A file with an own φ, `t_s,phi_nm`; `None`: that of the study's run.
    pub phi: Option<PathBuf>,
    /// The joint whose φ that is, or that is shown; `None`: the one whose φ moves most, of a file the first.
    pub joint: Option<String>,
    /// Folder for the results; `None`: `out/STUDY/reproduction`.
    pub out: Option<PathBuf>,
}

/// Written results.
#[derive(Debug)]
pub struct OwnAnswer {
    /// Tables and figures.
    pub reproduction: OwnReproduction,
    /// The folder.
    pub folder: PathBuf,
}

impl OwnOptions {
    /// Does it, and writes own.json, report.html, the figures and the study.
    ///
    /// # Errors
    ///
    /// [`OwnError`]: the study has no law of the paper, there is no φ, or a result cannot be written.
    pub fn run(&self, watch: &mut dyn Watch) -> Result<OwnAnswer, OwnError> {
        let study = *phihat_session::read(&self.study)?;
        let default = || Path::new("out").join(&study.name).join("reproduction");
        let folder = self.out.clone().unwrap_or_else(default);
        let results = ["own.json", "report.html", "study.toml", "figures/own-fig-12.svg"];
        files::check_writable(&results.map(|name| folder.join(name)))?;
        let used = Lock::take_if_used(&folder)?;
        watch.begun(&[]);
        watch.step("runs");
        let text = study.text.clone();
        let shared = RefCell::new(&mut *watch);
        let progress = |share: f64| {
            let done = format!("{:.0}", 1000.0 * share).parse().unwrap_or(0);
            shared.borrow_mut().progress(done, 1000);
        };
        let of = (self.phi.as_deref(), self.joint.as_deref());
        let done = own(study, &self.study, of, &progress);
        watch.ended();
        let reproduction = done?;
        let _held = used.map_or_else(|| Lock::take(&folder), Ok)?;
        write(&folder, &reproduction, &text)?;
        Ok(OwnAnswer { reproduction, folder })
    }
}

/// Writes everything, or nothing.
fn write(folder: &Path, reproduction: &OwnReproduction, study: &str) -> Result<(), OwnError> {
    let text = serde_json::to_string(reproduction).map_err(OwnError::Answer)? + "\n";
    let mut all = vec![(folder.join("study.toml"), study.as_bytes().to_vec())];
    for figure in reproduction.sections.iter().flat_map(|section| &section.figures) {
        let path = folder.join("figures").join(format!("{}.svg", figure.id));
        all.push((path, draw(figure, &FigureSize::PAPER).svg.into_bytes()));
    }
    all.push((folder.join("own.json"), text.into_bytes()));
    all.push((folder.join("report.html"), own_page(reproduction).into_bytes()));
    let mut whole = Whole::in_locked_folder();
    for (path, bytes) in &all {
        whole.add(path, bytes)?;
    }
    Ok(whole.commit()?)
}
