//! Input of rollouts: a study, with numbers and seeds for each run; and each of its runs as a study of its
//! own.

use std::path::{Path, PathBuf};

use phihat_design::{Gains, requested_gains};
use phihat_session::{Session, set};
use phihat_sim::{Simulation, samples};
use phihat_study::{NumericKey, Study};
use toml::{Table, Value};

use crate::sweep::RunError;

use super::error::{RolloutsError, in_words};

/// Origin of a key in messages.
const ORIGIN: &str = "rollouts";
/// A study takes seeds below this.
const SEEDS: u64 = 1 << 53;

/// Numbers of a study, given for each run.
#[derive(Debug, Clone, PartialEq)]
pub struct RunNumbers {
    /// Name of the numbers in messages.
    pub name: String,
    /// The keys that they go to, by their paths: one for all, or one for each joint.
    pub paths: Vec<String>,
    /// One value per run and path, run by run.
    pub values: Vec<f64>,
}

/// Numbers with the keys that they set.
#[derive(Debug)]
struct NumbersOfKeys {
    numbers: RunNumbers,
    keys: Vec<NumericKey>,
}

/// Many runs of a study, ready to go.
#[derive(Debug)]
pub struct Rollouts {
    pub(super) study: Box<Study>,
    path: PathBuf,
    table: Table,
    gains: Gains,
    /// True if each run's study states the gains that it runs with.
    own_gains: bool,
    told: Vec<NumbersOfKeys>,
    seeds: Option<Vec<u64>>,
    pub(super) runs: usize,
}

impl Rollouts {
    /// Checks everything before the first run: the study and its gains as `phihat run` checks them, every
    /// number against the range of its key. `path` is that of the study, for messages and relative files;
    /// without `seeds`, every run has the seed of the study.
    ///
    /// # Errors
    ///
    /// [`RolloutsError`]: names the first number that cannot be, by what it is called and its place.
    pub fn new(
        (study, path): (Box<Study>, &Path),
        gains: Option<(Gains, &Path)>,
        (numbers, seeds): (Vec<RunNumbers>, Option<Vec<u64>>),
        runs: usize,
        uncertified: bool,
    ) -> Result<Self, RolloutsError> {
        let given = gains.is_some();
        let mut table: Table = study.table().unwrap_or_default();
        let own_gains = !given && table.contains_key("gains");
        let told = numbers.into_iter().map(|numbers| told(&study, numbers, runs, own_gains));
        let told = told.collect::<Result<Vec<_>, _>>()?;
        for (i, one) in told.iter().enumerate() {
            let paths = |told: &NumbersOfKeys| told.numbers.paths.clone();
            let twice = told[..i].iter().find(|other| paths(other) == paths(one));
            if let Some(other) = twice {
                let why = format!("it is told twice, as {} too", other.numbers.name);
                return Err(RolloutsError::Key { name: one.numbers.name.clone(), why });
            }
        }
        if let Some(seeds) = &seeds {
            count("seeds", seeds.len(), runs)?;
            if let Some(at) = seeds.iter().position(|seed| *seed >= SEEDS) {
                return Err(RolloutsError::Value {
                    name: "seeds".to_owned(),
                    at: format!("[{at}]"),
                    value: seeds[at] as f64,
                    limit: "an integer from 0 to 2^53 - 1".to_owned(),
                });
            }
        }
        let session = Session::new(study, path, gains, uncertified)?;
        let (study, gains) = session.into_parts();
        // What a certificate says of this study alone holds for all of its runs.
        set(&mut table, &["spec", "settle_s"], study.spec.settle.into());
        let path = path.to_owned();
        Ok(Self { study, path, table, gains, own_gains, told, seeds, runs })
    }

    /// Number of runs.
    pub fn runs(&self) -> usize {
        self.runs
    }

    /// The gains of all runs, but of those whose study states its own.
    pub fn gains(&self) -> &Gains {
        &self.gains
    }

    /// Joints, in the order of all arrays.
    pub fn joints(&self) -> Vec<String> {
        self.study.robot.joint_names()
    }

    /// The study that a run is; files by their whole paths.
    pub fn study(&self, run: usize) -> Table {
        let mut table = self.table(run);
        for (above, key) in [("robot", "file"), ("reference", "file")] {
            let value = table.get_mut(above).and_then(|above| above.get_mut(key));
            if let Some(Value::String(file)) = value
                && let Ok(whole) = std::path::absolute(self.folder().join(&*file))
            {
                *file = whole.display().to_string();
            }
        }
        table
    }

    fn folder(&self) -> &Path {
        self.path.parent().unwrap_or(Path::new(""))
    }

    fn table(&self, run: usize) -> Table {
        let mut table = self.table.clone();
        if let Some(seed) = self.seeds.as_ref().and_then(|seeds| seeds.get(run)) {
            set(&mut table, &["seed"], i64::try_from(*seed).unwrap_or(i64::MAX).into());
        }
        for NumbersOfKeys { numbers, keys } in &self.told {
            for (place, key) in keys.iter().enumerate() {
                if let Some(value) = numbers.values.get(run * keys.len() + place) {
                    key.put(&mut table, *value);
                }
            }
        }
        table
    }

    /// A run as `phihat run` reads it, and its closed loop.
    pub(super) fn simulation(&self, run: usize) -> Result<(Box<Study>, Simulation), RolloutsError> {
        self.built(run).map_err(|why| RolloutsError::Run {
            run,
            told: self.told_of(run),
            why: Box::new(why),
        })
    }

    fn built(&self, run: usize) -> Result<(Box<Study>, Simulation), RunError> {
        let origin = self.path.display().to_string();
        let text = self.table(run).to_string();
        let mut study = Box::new(Study::from_text(&text, &origin, self.folder())?);
        phihat_sim::derive_substeps(&mut study);
        let own = if self.own_gains { requested_gains(&study) } else { None };
        let gains = own.as_ref().unwrap_or(&self.gains);
        gains.complete(&mut study)?;
        let names = study.robot.joint_names();
        let law = gains.joint_gains(&names, study.control.period_ns, study.control.form)?;
        let simulation = Simulation::new(&study, &law)?;
        Ok((study, simulation))
    }

    /// Numbers and seed of a run, in words.
    fn told_of(&self, run: usize) -> String {
        let one = |told: &NumbersOfKeys| {
            let width = told.keys.len();
            let values = told.numbers.values.get(run * width..(run + 1) * width).unwrap_or(&[]);
            let shown: Vec<String> = values.iter().map(f64::to_string).collect();
            let shown = if width == 1 { shown.concat() } else { format!("[{}]", shown.join(", ")) };
            format!("{}[{run}] = {shown}", told.numbers.name)
        };
        let seed = self.seeds.as_ref().and_then(|seeds| seeds.get(run));
        let seed = seed.map(|seed| format!("seeds[{run}] = {seed}"));
        self.told.iter().map(one).chain(seed).collect::<Vec<_>>().join(", ")
    }

    /// The largest number of samples of a run.
    pub(super) fn samples_max(&self) -> u64 {
        let period = self.study.control.period_ns;
        let told = self.told.iter().find(|told| told.numbers.paths == ["duration_s"]);
        let durations = told.map_or(&[][..], |told| &told.numbers.values);
        let longest = durations.iter().copied().reduce(f64::max).unwrap_or(self.study.duration);
        samples(longest, period)
    }

    /// Returns true if the sample times of the runs differ from those of the study.
    pub(super) fn other_times(&self) -> bool {
        self.told.iter().any(|told| told.numbers.paths == ["loop.rate_hz"])
    }

    /// Time between samples of the study \[ns\].
    pub fn period_ns(&self) -> u64 {
        self.study.control.period_ns
    }
}

/// Finds the keys of some numbers, and checks every one of them.
fn told(
    study: &Study,
    numbers: RunNumbers,
    runs: usize,
    own_gains: bool,
) -> Result<NumbersOfKeys, RolloutsError> {
    let find = |path: &String| NumericKey::find(study, path, ORIGIN);
    let no = |why: String| RolloutsError::Key { name: numbers.name.clone(), why };
    let keys: Vec<NumericKey> = numbers
        .paths
        .iter()
        .map(find)
        .collect::<Result<_, _>>()
        .map_err(|why| no(in_words(&why)))?;
    for key in &keys {
        let fixed = match key.section() {
            "design" => {
                "gains are made once, for the study as it stands: what they are designed for does not vary"
            }
            "gains" if !own_gains => {
                "the study states no gains, or others are given: they do not vary"
            }
            "" if key.path() == "seed" => "the seeds of the runs are told as `seeds`",
            _ => continue,
        };
        return Err(no(fixed.to_owned()));
    }
    let width = keys.len();
    if numbers.values.len() != runs * width {
        let found = numbers.values.len() / width.max(1);
        return Err(RolloutsError::Count { name: numbers.name, found, runs });
    }
    for (at, (value, key)) in numbers.values.iter().zip(keys.iter().cycle()).enumerate() {
        if value.is_finite() && key.admits(*value) {
            continue;
        }
        let (run, place) = (at / width, at % width);
        let at = if width == 1 { format!("[{run}]") } else { format!("[{run}, {place}]") };
        let finite = if value.is_finite() { String::new() } else { "finite, ".to_owned() };
        let unit = if key.unit().is_empty() { String::new() } else { format!(" {}", key.unit()) };
        let limit = format!("{finite}{}{unit}", key.range());
        return Err(RolloutsError::Value { name: numbers.name, at, value: *value, limit });
    }
    Ok(NumbersOfKeys { numbers, keys })
}

fn count(name: &str, found: usize, runs: usize) -> Result<(), RolloutsError> {
    if found == runs {
        return Ok(());
    }
    Err(RolloutsError::Count { name: name.to_owned(), found, runs })
}
