//! The worlds behind `phihat.gym`: many runs of a study side by side, each of which waits for the torque of
//! its next sample.

use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::thread;

use numpy::{IntoPyArray, PyArray1, PyArray2, PyArrayMethods, PyUntypedArrayMethods};
use phihat::{Command, JointGains, JointState, Limits, update_joints};
use phihat_campaign::rollouts::RolloutsError;
use phihat_session::{OutsideRun, SessionError, set};
use phihat_sim::{Abreast, Stepped};
use phihat_study::{NumericKey, Study};
use pyo3::prelude::*;
use toml::Table;

use crate::gains::Gains;
use crate::raised::{internal, plain};
use crate::run::Trace;
use crate::{failure, study};

/// Samples of all worlds together below which one thread does them: starting others would take longer.
const ALONE: usize = 512;

/// Codes of a world's state.
const RUNS: u8 = 0;
const AT_ITS_END: u8 = 1;
const DIVERGED: u8 = 2;
const STOPPED: u8 = 3;

/// Many worlds of one study.
#[pyclass(frozen, module = "phihat._phihat")]
#[derive(Debug)]
pub(crate) struct Worlds {
    maker: Maker,
    held: Mutex<HeldWorlds>,
    #[pyo3(get)]
    joint_names: Vec<String>,
    #[pyo3(get)]
    period: f64,
    #[pyo3(get)]
    torque_max: Vec<f64>,
    #[pyo3(get)]
    error_bound: Vec<f64>,
}

/// The worlds, and what those of each thread share.
#[derive(Debug)]
struct HeldWorlds {
    worlds: Vec<Option<WorldOfPython>>,
    abreast: Vec<Abreast>,
}

/// Description from which every world is made.
#[derive(Debug)]
struct Maker {
    study: Box<Study>,
    origin: PathBuf,
    table: Table,
    inertia: Vec<f64>,
    gains: Option<phihat_design::Gains>,
    /// True if the law of the gains runs too, and the caller's torque is added to it.
    corrects: bool,
    /// True if every sample is recorded.
    records: bool,
}

/// A run, and the law that answers in it, if one does.
#[derive(Debug)]
struct WorldOfPython {
    run: OutsideRun,
    law: Option<WorldLaw>,
    tau: Vec<f64>,
}

#[derive(Debug)]
struct WorldLaw {
    gains: Vec<JointGains<f64>>,
    states: Vec<JointState<f64>>,
    commands: Vec<Command<f64>>,
}

#[pymethods]
impl Worlds {
    #[new]
    #[pyo3(signature = (path, document, name, count, gains, corrects_and_records))]
    fn new(
        py: Python<'_>,
        path: Option<PathBuf>,
        document: Option<&str>,
        name: &str,
        count: usize,
        gains: Option<&Gains>,
        corrects_and_records: (bool, bool),
    ) -> PyResult<Self> {
        let (corrects, records) = corrects_and_records;
        let (study, origin) = study::read(py, path.as_deref(), document, name)?;
        let gains = gains.map(|gains| gains.inner.clone());
        if let Some(has) = beside_the_law(&study).filter(|_| corrects) {
            let limit = "\"torque\" for such a study";
            let message = format!(
                "action: \"correction\", but the study has {has}, which acts beside the law; it must be {limit}"
            );
            return Err(failure::argument(py, "action", None, "correction", limit, &message));
        }
        let n = study.robot.joints.len();
        let limits = (0..n).map(|i| study.limits(i).0.unwrap_or(f64::INFINITY)).collect();
        let bounds = study.spec.error_bound.clone().unwrap_or_else(|| vec![f64::NAN; n]);
        let joint_names = study.robot.joint_names();
        let period = study.control.period_ns as f64 * 1e-9;
        let table: Table = study.table().map_err(|why| internal(py, why))?;
        let mut maker =
            Maker { study, origin, table, inertia: Vec::new(), gains, corrects, records };
        let first = maker.world(maker.study.clone(), None);
        maker.inertia = first.map_err(|why| why.raise(py))?.run.inertia;
        let worlds = (0..count).map(|_| None).collect();
        let held = Mutex::new(HeldWorlds { worlds, abreast: Vec::new() });
        Ok(Self { maker, held, joint_names, period, torque_max: limits, error_bound: bounds })
    }

    /// Begins a world anew: its seed, and numbers of the study by their paths.
    fn begin(
        &self,
        py: Python<'_>,
        world: usize,
        seed: u64,
        numbers: Vec<(String, f64)>,
    ) -> PyResult<()> {
        let made = py.detach(|| self.maker.begin(seed, &numbers)).map_err(|why| why.raise(py))?;
        let mut held = self.held.lock().unwrap_or_else(PoisonError::into_inner);
        let place = held.worlds.get_mut(world).ok_or_else(|| internal(py, "no such world"))?;
        *place = Some(made);
        Ok(())
    }

    /// Tells what acts in some of the worlds for so many samples; one row per world.
    fn step(
        &self,
        py: Python<'_>,
        acting: Vec<bool>,
        actions: &Bound<'_, PyArray2<f64>>,
        repeat: u32,
    ) -> PyResult<()> {
        let n = self.joint_names.len();
        if actions.shape() != [acting.len(), n] {
            return Err(internal(py, "actions of another shape"));
        }
        let values = actions.to_vec().map_err(|why| internal(py, why))?;
        let not_finite = |(at, x): (usize, &f64)| !x.is_finite() && acting[at / n];
        if let Some(at) = values.iter().enumerate().position(not_finite) {
            let (world, joint, value) = (at / n, &self.joint_names[at % n], values[at]);
            let message = format!("action[{world}]: {value} at joint {joint}; it must be finite");
            return Err(failure::argument(py, "action", Some(joint), value, "finite", &message));
        }
        let mut held = self.held.lock().unwrap_or_else(PoisonError::into_inner);
        let HeldWorlds { worlds, abreast } = &mut *held;
        let told = worlds.iter_mut().zip(values.chunks_exact(n)).zip(&acting);
        let mut told: Vec<_> = told
            .filter_map(|((world, action), acts)| Some((world.as_mut().filter(|_| *acts)?, action)))
            .collect();
        py.detach(|| {
            let work = told.len() * repeat as usize;
            let threads = if work < ALONE { 1 } else { phihat_session::threads(None) };
            let each = told.len().div_ceil(threads).max(1);
            if abreast.len() < threads {
                abreast.resize_with(threads, Abreast::default);
            }
            thread::scope(|scope| {
                let mut shares = told.chunks_mut(each).zip(abreast);
                let own = shares.next();
                for (share, abreast) in shares {
                    scope.spawn(move || go(share, repeat, abreast));
                }
                if let Some((share, abreast)) = own {
                    go(share, repeat, abreast);
                }
            });
        });
        Ok(())
    }

    /// Measurements and references of every world: positions, velocities, torques that acted, then wanted
    /// positions, velocities, accelerations; one row per world, no numbers where none was begun.
    fn observed<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let n = self.joint_names.len();
        let held = self.held.lock().unwrap_or_else(PoisonError::into_inner);
        let worlds = &held.worlds;
        let mut all = Vec::with_capacity(worlds.len() * 6 * n);
        for world in worlds {
            let Some(WorldOfPython { run, .. }) = world else {
                all.extend(std::iter::repeat_n(f64::NAN, 6 * n));
                continue;
            };
            let (sensed, wanted) = (run.run.sensed(), run.run.wanted());
            all.extend(sensed.iter().map(|m| m.q));
            all.extend(sensed.iter().map(|m| m.dq));
            all.extend(sensed.iter().map(|m| m.tau_applied));
            all.extend(wanted.iter().map(|r| r.q));
            all.extend(wanted.iter().map(|r| r.dq));
            all.extend(wanted.iter().map(|r| r.ddq));
        }
        PyArray1::from_vec(py, all).reshape([worlds.len(), 6 * n])
    }

    /// Time of the sample that waits [s], and how each world is: 0 it runs, 1 at its end, 2 diverged, 3
    /// stopped by the robot's interface.
    fn states<'py>(
        &self,
        py: Python<'py>,
    ) -> (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<u8>>) {
        let held = self.held.lock().unwrap_or_else(PoisonError::into_inner);
        let worlds = &held.worlds;
        let times = worlds.iter().map(|w| w.as_ref().map_or(f64::NAN, |world| world.run.run.t()));
        let times: Vec<f64> = times.collect();
        let states: Vec<u8> = worlds.iter().map(|w| w.as_ref().map_or(AT_ITS_END, state)).collect();
        (times.into_pyarray(py), states.into_pyarray(py))
    }

    /// The record of a world that is over; it can be taken once.
    fn trace(&self, py: Python<'_>, world: usize) -> PyResult<Trace> {
        if !self.maker.records {
            let message = "record: False, so there is no record; it must be True where the environment is made";
            return Err(failure::argument(py, "record", None, false, "True", message));
        }
        let mut held = self.held.lock().unwrap_or_else(PoisonError::into_inner);
        let over = |world: &mut WorldOfPython| state(world) != RUNS;
        let taken = held.worlds.get_mut(world).and_then(|place| place.take_if(over));
        let ended = taken.and_then(|world| py.detach(|| world.run.end()));
        let (done, trace) = ended.ok_or_else(|| {
            let message =
                format!("world {world}: its episode is not over, or its record was taken");
            failure::argument(py, "world", None, world, "an episode that is over", &message)
        })?;
        Ok(Trace::new(done, trace))
    }
}

/// Why a world cannot begin.
enum WorldRefused {
    Key(RolloutsError),
    Session(SessionError),
}

impl WorldRefused {
    fn raise(&self, py: Python<'_>) -> PyErr {
        match self {
            Self::Key(why) => plain(py, "ArgumentError", &why.to_string()),
            Self::Session(why) => failure::session(py, why),
        }
    }
}

impl From<SessionError> for WorldRefused {
    fn from(why: SessionError) -> Self {
        Self::Session(why)
    }
}

impl Maker {
    fn begin(&self, seed: u64, numbers: &[(String, f64)]) -> Result<WorldOfPython, WorldRefused> {
        let mut table = self.table.clone();
        set(&mut table, &["seed"], i64::try_from(seed).unwrap_or(i64::MAX).into());
        for (path, value) in numbers {
            let no =
                |why: String| WorldRefused::Key(RolloutsError::Key { name: path.clone(), why });
            let key = NumericKey::find(&self.study, path, "reset");
            let key = key.map_err(|why| no(why.message().to_owned()))?;
            if !key.admits(*value) {
                return Err(no(format!("{value} {}: it must be {}", key.unit(), key.range())));
            }
            key.put(&mut table, *value);
        }
        let (origin, folder) =
            (self.origin.display().to_string(), self.origin.parent().unwrap_or(Path::new("")));
        let study = Study::from_text(&table.to_string(), &origin, folder).map(Box::new);
        let mut study = study.map_err(SessionError::from)?;
        phihat_sim::derive_substeps(&mut study);
        self.world(study, Some(self.inertia.clone()))
    }

    fn world(
        &self,
        mut study: Box<Study>,
        inertia: Option<Vec<f64>>,
    ) -> Result<WorldOfPython, WorldRefused> {
        let (mut inertia, mut law) = (inertia, None);
        if let Some(gains) = &self.gains {
            let own = |why| WorldRefused::from(SessionError::at(&self.origin, why));
            gains.complete(&mut study).map_err(own)?;
            // The filter that the gains were designed with is the study's now.
            study.sensor.velocity_filter_designed = false;
            inertia = Some(gains.joints.iter().map(|joint| joint.inertia_kg_m2).collect());
            law = if self.corrects {
                Some(WorldLaw::new(&study, gains, &self.origin)?)
            } else {
                None
            };
        }
        let command = "phihat.gym, in Python".to_owned();
        let n = study.robot.joints.len();
        let mut run = OutsideRun::new(study, &self.origin, inertia, command)?;
        if !self.records {
            run.run.forget();
        }
        Ok(WorldOfPython { run, law, tau: vec![0.0; n] })
    }
}

impl WorldOfPython {
    /// The run, and the torque that it waits for.
    fn waiting(&mut self) -> (&mut Stepped, &[f64]) {
        (&mut self.run.run, &self.tau)
    }
}

impl WorldLaw {
    /// The law of gains, behind the limits of a study.
    fn new(
        study: &Study,
        gains: &phihat_design::Gains,
        origin: &Path,
    ) -> Result<Self, WorldRefused> {
        let names = study.robot.joint_names();
        let period = study.control.period_ns;
        let laws = gains.joint_gains(&names, period, study.control.form);
        let laws = laws.map_err(|why| SessionError::at(origin, why))?;
        let limited = |(i, law): (usize, &JointGains<f64>)| {
            let (torque, rate) = study.limits(i);
            let limits = Limits::new(torque, rate, period as f64 * 1e-9);
            limits.map(|limits| law.with_limits(limits)).map_err(|error| {
                let joint = names[i].clone();
                SessionError::at(origin, phihat_design::GainsError::Joint { joint, error })
            })
        };
        let gains = laws.iter().enumerate().map(limited).collect::<Result<Vec<_>, _>>()?;
        let n = gains.len();
        let (states, commands) = (vec![JointState::new(); n], vec![Command::default(); n]);
        Ok(Self { gains, states, commands })
    }
}

/// Part of a study that makes torque in addition to the law, if any.
fn beside_the_law(study: &Study) -> Option<&'static str> {
    let parts = [
        (study.supervisor.is_some(), "a supervisor"),
        (study.feedforward.is_some(), "a feedforward"),
        (study.world.held.is_some(), "a start that something else holds"),
    ];
    parts.into_iter().find_map(|(has, name)| has.then_some(name))
}

/// Some worlds, so many samples on.
fn go(told: &mut [(&mut WorldOfPython, &[f64])], repeat: u32, abreast: &mut Abreast) {
    for _ in 0..repeat {
        for (world, action) in &mut *told {
            let WorldOfPython { run, law, tau } = &mut **world;
            tau.copy_from_slice(action);
            if let Some(WorldLaw { gains, states, commands }) =
                law.as_mut().filter(|_| !run.run.is_over())
            {
                update_joints(gains, states, run.run.sensed(), run.run.wanted(), commands);
                tau.iter_mut().zip(&*commands).for_each(|(tau, command)| *tau += command.tau);
            }
        }
        let mut runs: Vec<_> = told.iter_mut().map(|(world, _)| world.waiting()).collect();
        // As many torques as joints, by the shape that was checked.
        if abreast.step(&mut runs).is_err() {
            break;
        }
    }
}

fn state(world: &WorldOfPython) -> u8 {
    let run = &world.run.run;
    match (run.is_over(), run.diverged(), run.stopped()) {
        (false, ..) => RUNS,
        (true, true, _) => DIVERGED,
        (true, _, true) => STOPPED,
        _ => AT_ITS_END,
    }
}
