//! A reproduction as a user asks for it, taken to its files.

use std::collections::BTreeMap;
use std::error::Error;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use phihat_session::disk::{Lock, Whole};
use phihat_session::{Watch, files, threads};

use crate::choice::part;
use crate::figure::reproduction_figures;
use crate::page::reproduction_page;
use crate::record::Reproduction;
use crate::{Extent, ReproduceError, parts, reproduce_only, studies};

/// Options of a reproduction.
#[derive(Debug, Clone)]
pub struct ReproduceOptions {
    /// Coarser maps and sweeps.
    pub quick: bool,
    /// One part, by its name or by a section, statement or figure of it; `None`: all.
    pub only: Option<String>,
    /// Parts at a time; `None`: one per core.
    pub threads: Option<u16>,
    /// Folder for the results.
    pub out: PathBuf,
}

impl Default for ReproduceOptions {
    fn default() -> Self {
        let out = Path::new("out").join("reproduction");
        Self { quick: false, only: None, threads: None, out }
    }
}

/// Why a figure is not there as PNG, in one sentence: pictures are an addition, and a reproduction goes on without.
pub type PaintError = Box<dyn Error + Send + Sync>;

/// Makes a PNG of a figure's SVG.
pub type Paint<'a> = &'a dyn Fn(&str) -> Result<Vec<u8>, PaintError>;

/// A reproduction that was written.
#[derive(Debug)]
pub struct ReproduceAnswer {
    /// Every statement with its verdict.
    pub reproduction: Reproduction,
    /// The page.
    pub page: PathBuf,
    /// Why figures are not there as PNG although that was asked for.
    pub no_pictures: Option<String>,
}

impl ReproduceOptions {
    /// Reproduces the paper and writes data, page, figures and studies.
    ///
    /// # Errors
    ///
    /// [`ReproduceError`]: there is no such part, a part could not be done, or a result not be written.
    pub fn run(
        &self,
        paint: Option<Paint<'_>>,
        watch: &mut dyn Watch,
    ) -> Result<ReproduceAnswer, ReproduceError> {
        let only = self.only.as_deref().map(part).transpose()?;
        files::check_writable(&self.results())?;
        // In a new folder nothing is made before there is something to write.
        let used = Lock::take_if_used(&self.out)?;
        let reproduction = self.parts(only.as_deref(), watch)?;
        let _held = used.map_or_else(|| Lock::take(&self.out), Ok)?;
        let no_pictures = self.write(&reproduction, paint)?;
        Ok(ReproduceAnswer { reproduction, page: self.out.join("report.html"), no_pictures })
    }

    /// Files that are written in any case, and one figure for those whose names are not known before.
    fn results(&self) -> Vec<PathBuf> {
        let names = ["reproduction.json", "report.html", "figures/figure.svg"].into_iter();
        names
            .chain(studies().iter().map(|(path, _)| *path))
            .map(|name| self.out.join(name))
            .collect()
    }

    fn parts(
        &self,
        only: Option<&str>,
        watch: &mut dyn Watch,
    ) -> Result<Reproduction, ReproduceError> {
        let chosen = |name: &&str| only.is_none_or(|text| name.contains(text));
        let count = parts().filter(chosen).count().max(1);
        watch.begun(&[]);
        let shared = Mutex::new((BTreeMap::new(), &mut *watch));
        let progress = |name: &str, share: f64| {
            let (shares, watch) = &mut *shared.lock().unwrap_or_else(PoisonError::into_inner);
            shares.insert(name.to_owned(), share.clamp(0.0, 1.0));
            let done = shares.values().sum::<f64>() / count as f64;
            watch.step(name);
            // A share of a thousand.
            watch.progress(format!("{:.0}", 1000.0 * done).parse().unwrap_or(0), 1000);
        };
        let extent = Extent { quick: self.quick };
        let done = reproduce_only(only, extent, threads(self.threads), &progress);
        watch.ended();
        done
    }

    /// Writes everything, or nothing; says why there are no PNG files where there are none.
    fn write(
        &self,
        reproduction: &Reproduction,
        mut paint: Option<Paint<'_>>,
    ) -> Result<Option<String>, ReproduceError> {
        let at = |name: &str| self.out.join(name);
        let text = serde_json::to_string(reproduction).map_err(ReproduceError::Answer)? + "\n";
        let page = reproduction_page(reproduction);
        let mut all: Vec<(PathBuf, Vec<u8>)> = Vec::new();
        for (path, text) in studies() {
            all.push((at(path), text.as_bytes().to_vec()));
        }
        let mut no_pictures = None;
        for figure in reproduction_figures(reproduction) {
            let path = self.out.join("figures").join(&figure.name);
            match paint.map(|paint| paint(&figure.svg)) {
                Some(Ok(png)) => all.push((path.with_extension("png"), png)),
                Some(Err(why)) => {
                    (no_pictures, paint) = (Some(format!("{}: {why}", figure.name)), None);
                }
                None => {}
            }
            all.push((path.with_extension("svg"), figure.svg.into_bytes()));
        }
        all.push((at("reproduction.json"), text.into_bytes()));
        all.push((at("report.html"), page.into_bytes()));
        let mut whole = Whole::in_locked_folder();
        for (path, bytes) in &all {
            whole.add(path, bytes)?;
        }
        let new = |path: &PathBuf| all.iter().any(|(at, _)| at == path);
        self.older_figures()
            .into_iter()
            .filter(|path| !new(path))
            .for_each(|path| whole.remove(path));
        whole.commit()?;
        Ok(no_pictures)
    }

    /// The figures that an older reproduction names as its own. It is read before, and replaced after they are removed:
    /// what a killed process did not remove, the next one does.
    fn older_figures(&self) -> Vec<PathBuf> {
        let text = files::read(&self.out.join("reproduction.json")).unwrap_or_default();
        let older: serde_json::Value = serde_json::from_str(&text).unwrap_or_default();
        let sections = older["sections"].as_array().into_iter().flatten();
        let figures =
            sections.flat_map(|section| section["figures"].as_array().into_iter().flatten());
        let plain = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
        let names =
            figures.filter_map(|figure| figure["id"].as_str()).filter(|id| id.chars().all(plain));
        let at = |id: &str, ending: &str| self.out.join("figures").join(format!("{id}.{ending}"));
        names.flat_map(|id| [at(id, "svg"), at(id, "png")]).collect()
    }
}
