//! A fault matrix as a user asks for it, taken to its answer.

use std::path::{Path, PathBuf};

use phihat_session::{Session, TraceKind, Watch, files, threads};

use super::case::FaultCase;
use super::matrix::{FaultMatrix, FaultsError, MatrixExtent};
use super::summary::Summary;
use crate::folder::{JOURNAL, results_of};
use crate::journal::Journal;
use crate::page::faults_page;
use crate::runner::run_all;

/// Runs whose traces are kept at most: some 3 MB each.
const TRACES_MAX: usize = 20;

/// Options of a fault matrix.
#[derive(Debug, Clone)]
pub struct FaultsOptions {
    /// The study files (TOML), one per arm; without faults of their own.
    pub studies: Vec<PathBuf>,
    /// Estimator orders, each with its own gains.
    pub orders: Vec<usize>,
    /// Seeds per fault and severity: onset, joint, sign and noise differ.
    pub seeds: u16,
    /// One order, one seed.
    pub quick: bool,
    /// Only runs whose name (`ARM/mORDER/FAULT/SEVERITY/SEED`) contains this.
    pub only: Option<String>,
    /// Keeps study, trace (as this kind of file) and report of every run; for 20 runs at most.
    pub trace: Option<TraceKind>,
    /// Does every run again, whatever the journal holds.
    pub fresh: bool,
    /// Runs at a time; `None`: one per core.
    pub threads: Option<u16>,
    /// Folder for the results; `None`: `out/STUDY/faults`, or `out/faults` for several studies.
    pub out: Option<PathBuf>,
}

impl Default for FaultsOptions {
    fn default() -> Self {
        Self {
            studies: Vec::new(),
            orders: vec![1, 2],
            seeds: 3,
            quick: false,
            only: None,
            trace: None,
            fresh: false,
            threads: None,
            out: None,
        }
    }
}

/// The answer of a matrix, and where it was written.
#[derive(Debug)]
pub struct FaultsAnswer {
    /// Result of every run.
    pub summary: Summary,
    /// The folder of the results.
    pub folder: PathBuf,
    /// The page.
    pub page: PathBuf,
}

impl FaultsOptions {
    /// Folder of the results.
    ///
    /// # Errors
    ///
    /// [`FaultsError`]: the one study, whose name they take, cannot be read.
    pub fn folder(&self) -> Result<PathBuf, FaultsError> {
        results_of(&self.studies, self.out.as_deref(), "faults").map_err(FaultsError::Session)
    }

    /// Makes the matrix, runs what its journal does not hold, and writes the answer.
    ///
    /// # Errors
    ///
    /// [`FaultsError`]: an option or a study cannot be used, or a result not be written.
    pub fn run(&self, watch: &mut dyn Watch) -> Result<FaultsAnswer, FaultsError> {
        if let Some(order) = self.orders.iter().find(|m| !(1..=phihat::ORDER_MAX).contains(*m)) {
            return Err(FaultsError::Order(*order));
        }
        let folder = self.folder()?;
        let cache = folder.join("gains");
        let matrix = FaultMatrix::new(&self.studies, &self.extent(), &cache, &|study, path| {
            let session = Session::new(Box::new(study.clone()), path, None, false)?;
            Ok(session.into_gains())
        })?;
        if self.trace.is_some() && matrix.cases.len() > TRACES_MAX {
            return Err(FaultsError::TooManyTraces(matrix.cases.len(), TRACES_MAX));
        }
        let [path, data, page] =
            [JOURNAL, "faults.json", "report.html"].map(|name| folder.join(name));
        files::check_writable([&path, &data, &page, &cache.join("gains.json")])?;
        let mut journal = Journal::in_folder(&path, self.fresh, watch)?;
        for (name, gains) in matrix.arms.iter().flat_map(super::FaultedArm::gains) {
            files::write_locked(&[(cache.join(name), gains.to_json()?.into_bytes())])?;
        }
        let summary = self.runs(&matrix, &mut journal, watch)?;
        let text = serde_json::to_string_pretty(&summary).map_err(FaultsError::Answer)?;
        let html = faults_page(&summary, &self.command());
        files::write_locked(&[
            (data, (text + "\n").into_bytes()),
            (page.clone(), html.into_bytes()),
        ])?;
        if let Some(kind) = self.trace {
            for case in &matrix.cases {
                keep(&matrix, case, &folder, kind)?;
            }
        }
        Ok(FaultsAnswer { summary, folder, page })
    }

    fn extent(&self) -> MatrixExtent {
        let mut extent = MatrixExtent {
            orders: self.orders.clone(),
            seeds: u64::from(self.seeds),
            only: self.only.clone(),
        };
        if self.quick {
            extent.orders.truncate(1);
            extent.seeds = 1;
        }
        extent
    }

    fn runs(
        &self,
        matrix: &FaultMatrix,
        journal: &mut Journal,
        watch: &mut dyn Watch,
    ) -> Result<Summary, FaultsError> {
        let ids: Vec<String> = matrix.cases.iter().map(|case| matrix.id(case)).collect();
        watch.begun(&[]);
        let ended = run_all(
            &ids,
            journal,
            threads(self.threads),
            &|at| matrix.run(&matrix.cases[at]),
            |p| {
                watch.progress(p.done as u64, p.all as u64);
                if p.done == p.resumed {
                    watch.resumed();
                }
            },
        );
        watch.ended();
        Ok(Summary::new(matrix, ended?))
    }

    /// The command that repeats one run of these studies, but for the run's name.
    fn command(&self) -> String {
        let studies: Vec<_> = self.studies.iter().map(|s| s.display().to_string()).collect();
        let mut command = format!("phihat faults {}", studies.join(" "));
        if let Some(folder) = &self.out {
            command = format!("{command} --out {}", folder.display());
        }
        command
    }
}

/// Repeats a run with everything it leaves: study, gains, trace, report.
fn keep(
    matrix: &FaultMatrix,
    case: &FaultCase,
    folder: &Path,
    kind: TraceKind,
) -> Result<(), FaultsError> {
    let folder = folder.join("runs").join(matrix.name(case).to_string());
    let study = matrix.study(case)?;
    let gains = folder.join("gains.json");
    let given = Some((matrix.gains(case).clone(), gains.as_path()));
    let session = Session::new(study, &folder.join("study.toml"), given, true)?;
    session.recorded_as(kind).simulate(&folder, Some(&folder.join("report.html")), &mut ())?;
    Ok(())
}
