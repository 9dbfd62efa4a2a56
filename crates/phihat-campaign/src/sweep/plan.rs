//! Plan of a sweep: a study, its gains, the numbers that vary and the number of runs; and each run as a study
//! of its own.

use std::ops::Range;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};

use phihat_design::{Gains, requested_gains};
use phihat_session::{Session, SessionError, set, short_hash};
use phihat_sim::{Batch, Measured, SimError, Simulation};
use phihat_study::Study;
use toml::{Table, Value};

use super::error::{RunError, SweepError};
use super::row::{SweepColumns, SweepEnd, SweepRow};
use super::vary::Vary;

/// Raised when the same run would come out otherwise: journals of before are then done again.
const EDITION: &str = "sweep 1";

/// Runs whose studies are in memory at a time: eight times as many as share lanes.
const TOGETHER: usize = 64;

/// A sweep, ready to run.
#[derive(Debug)]
pub struct SweepPlan {
    pub(crate) study: Box<Study>,
    path: PathBuf,
    table: Table,
    pub(crate) gains: Gains,
    /// True if each run's study states the gains that it runs with.
    pub(crate) own_gains: bool,
    pub(crate) vary: Vec<Vary>,
    pub(crate) seed: u64,
    pub(crate) runs: u64,
    /// Stands for all that decides a row but its place.
    pub(crate) id: String,
}

impl SweepPlan {
    /// Makes a plan: the study and its gains checked as `phihat run` checks them, every end of what varies tried.
    ///
    /// # Errors
    ///
    /// [`SweepError`]: the study cannot run as it stands, something cannot vary so, or a value makes a study
    /// that cannot run.
    pub fn new(
        (path, gains): (&Path, Option<(Gains, &Path)>),
        vary: &[String],
        (seed, runs): (u64, u64),
        uncertified: bool,
    ) -> Result<Self, SweepError> {
        let study = phihat_session::read(path)?;
        if vary.is_empty() {
            return Err(SweepError::Nothing);
        }
        let vary: Vec<Vary> =
            vary.iter().map(|text| Vary::read(&study, text)).collect::<Result<_, _>>()?;
        for (i, one) in vary.iter().enumerate() {
            if vary[..i].iter().any(|other| other.key().path() == one.key().path()) {
                return Err(SweepError::Twice(one.key().path().to_owned()));
            }
        }
        let mut table: Table = study.table().unwrap_or_default();
        let given = gains.is_some();
        let session = Session::new(study, path, gains, uncertified)?;
        let (study, gains) = session.into_parts();
        // What a certificate says of this study alone holds for all of its runs.
        set(&mut table, &["spec", "settle_s"], study.spec.settle.into());
        let own_gains = !given && table.contains_key("gains");
        if let Some(vary) = vary.iter().find(|vary| vary.key().section() == "gains" && !own_gains) {
            let why = if given {
                "the gains are those of --gains"
            } else {
                "the gains are designed, and the study states none"
            };
            return Err(SweepError::Vary { text: vary.text().to_owned(), why: why.to_owned() });
        }
        let texts: Vec<&str> = vary.iter().map(Vary::text).collect();
        let parts = [
            EDITION,
            env!("CARGO_PKG_VERSION"),
            &study.sha256,
            &gains.to_json().map_err(|why| SessionError::at(path, why))?,
            &texts.join("\n"),
            &format!("{seed}"),
        ];
        let id = short_hash(&parts);
        let path = path.to_owned();
        let plan = Self { study, path, table, gains, own_gains, vary, seed, runs, id };
        plan.ends_run()?;
        Ok(plan)
    }

    /// Every end of what varies, one at a time.
    fn ends_run(&self) -> Result<(), SweepError> {
        for vary in &self.vary {
            for value in vary.ends() {
                let mut table = self.table.clone();
                vary.put(&mut table, value);
                self.simulation(&mut table).map_err(|why| SweepError::Unfit {
                    text: vary.text().to_owned(),
                    value,
                    why: Box::new(why),
                })?;
            }
        }
        Ok(())
    }

    /// The columns of its rows.
    pub fn columns(&self) -> SweepColumns {
        let varied = self.vary.iter().map(Vary::name).collect();
        let joints = self.study.robot.joint_names();
        SweepColumns::new(varied, joints)
    }

    /// Seed of a run's study, and the values of the numbers that vary.
    pub fn drawn(&self, run: u64) -> (u64, Vec<f64>) {
        // 13 digits of 4 bits: a study takes seeds below 2^53.
        let digits = short_hash(&[&format!("{}/{run}", self.seed), "seed"]);
        let seed = u64::from_str_radix(digits.get(..13).unwrap_or(""), 16).unwrap_or(0);
        (seed, self.vary.iter().map(|vary| vary.draw(self.seed, run)).collect())
    }

    /// The table of the study that a run is.
    fn table(&self, run: u64) -> Table {
        let (seed, values) = self.drawn(run);
        let mut table = self.table.clone();
        set(&mut table, &["seed"], i64::try_from(seed).unwrap_or(i64::MAX).into());
        for (vary, value) in self.vary.iter().zip(values) {
            vary.put(&mut table, value);
        }
        table
    }

    /// Reads the study of a table as `phihat run` does, and builds its closed loop. If values make the world
    /// too stiff for the integration steps that the study states, the steps are made shorter, and the table
    /// states it.
    fn simulation(&self, table: &mut Table) -> Result<(Box<Study>, Simulation), RunError> {
        let mut study = self.read(table)?;
        match self.build(&mut study) {
            Err(RunError::Sim(SimError::TooStiff { needed, .. })) => {
                set(table, &["world", "substeps"], i64::from(needed).into());
                let mut study = self.read(table)?;
                let simulation = self.build(&mut study)?;
                Ok((study, simulation))
            }
            built => Ok((study, built?)),
        }
    }

    fn read(&self, table: &Table) -> Result<Box<Study>, RunError> {
        let origin = self.path.display().to_string();
        let folder = self.path.parent().unwrap_or(Path::new(""));
        let mut study = Box::new(Study::from_text(&table.to_string(), &origin, folder)?);
        phihat_sim::derive_substeps(&mut study);
        Ok(study)
    }

    fn build(&self, study: &mut Study) -> Result<Simulation, RunError> {
        let own = if self.own_gains { requested_gains(study) } else { None };
        let gains = own.as_ref().unwrap_or(&self.gains);
        gains.complete(study)?;
        let names = study.robot.joint_names();
        let law = gains.joint_gains(&names, study.control.period_ns, study.control.form)?;
        Ok(Simulation::new(study, &law)?)
    }

    /// One run: its figures alone are kept.
    ///
    /// # Errors
    ///
    /// [`RunError`]: its study cannot be run.
    pub fn run(&self, run: u64) -> Result<SweepRow, RunError> {
        let (study, simulation) = self.simulation(&mut self.table(run))?;
        let mut measured = Measured::new(&study);
        let Ok(ended) = simulation.record(&mut measured, |_| ());
        let (seed, values) = self.drawn(run);
        Ok(SweepRow::of((run, seed, values), &measured.metrics(), &ended))
    }

    /// Simulates some runs and returns their rows as bytes. The rows depend on the plan and the runs' numbers
    /// alone.
    pub fn chunk(&self, runs: Range<u64>) -> Vec<u8> {
        let mut bytes = Vec::new();
        let runs: Vec<u64> = runs.collect();
        for some in runs.chunks(TOGETHER) {
            // What a panicking run leaves half-done is its own and goes with it: each of them is done again by itself.
            let rows = catch_unwind(AssertUnwindSafe(|| self.together(some)));
            let rows =
                rows.unwrap_or_else(|_| some.iter().map(|run| self.by_itself(*run)).collect());
            for row in &rows {
                row.write(&mut bytes);
            }
        }
        bytes
    }

    /// Some runs, in lanes where their arms can share them: each has the row that [`run`](Self::run) gives.
    fn together(&self, runs: &[u64]) -> Vec<SweepRow> {
        let (mut studies, mut simulations) = (Vec::new(), Vec::new());
        let mut begin = |run: &u64| {
            let (study, simulation) = self.simulation(&mut self.table(*run)).ok()?;
            studies.push(study);
            simulations.push(simulation);
            Some(())
        };
        let begun: Vec<bool> = runs.iter().map(|run| begin(run).is_some()).collect();
        let studies: Vec<&Study> = studies.iter().map(Box::as_ref).collect();
        let mut measured = Batch::new(simulations).measure(&studies).into_iter();
        let mut row =
            |(run, begun): (&u64, bool)| match measured.by_ref().take(usize::from(begun)).next() {
                Some((metrics, ended)) => {
                    let (seed, values) = self.drawn(*run);
                    SweepRow::of((*run, seed, values), &metrics, &ended)
                }
                None => self.none(*run, SweepEnd::Refused),
            };
        runs.iter().zip(begun).map(&mut row).collect()
    }

    /// The row of a run that may panic.
    fn by_itself(&self, run: u64) -> SweepRow {
        match catch_unwind(AssertUnwindSafe(|| self.run(run))) {
            Ok(Ok(row)) => row,
            Ok(Err(_)) => self.none(run, SweepEnd::Refused),
            Err(_) => self.none(run, SweepEnd::Panicked),
        }
    }

    /// The row of a run that could not be.
    fn none(&self, run: u64, end: SweepEnd) -> SweepRow {
        let (seed, values) = self.drawn(run);
        SweepRow::none((run, seed, values), end, self.study.robot.joints.len())
    }

    /// Text of a study that repeats a run, with absolute file paths; and true if it runs only uncertified. It
    /// needs the gains of the sweep, unless it states its own.
    ///
    /// # Errors
    ///
    /// [`RunError`]: its study cannot be run.
    pub fn repeated(&self, run: u64) -> Result<(String, bool), RunError> {
        let mut table = self.table(run);
        self.simulation(&mut table)?;
        let study = self.read(&table)?;
        let given = (!self.own_gains).then(|| (self.gains.clone(), Path::new("gains.json")));
        let uncertified = Session::new(study, &self.path, given, false).is_err();
        let title = format!("run {run} of a sweep of {}", self.study.name);
        set(&mut table, &["title"], title.into());
        for (above, key) in [("robot", "file"), ("reference", "file")] {
            let value = table.get_mut(above).and_then(|above| above.get_mut(key));
            if let Some(Value::String(file)) = value {
                let folder = self.path.parent().unwrap_or(Path::new(""));
                if let Ok(whole) = std::path::absolute(folder.join(&*file)) {
                    *file = whole.display().to_string();
                }
            }
        }
        Ok((table.to_string(), uncertified))
    }
}
