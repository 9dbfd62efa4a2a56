//! Runs that wait for their torques, gone on with side by side.

use phihat_model::Lanes;

use crate::error::SimError;
use crate::stepped::Stepped;
use crate::world::{PlantLanes, SimulatedWorld};

/// Steps many runs at once: arms of one structure that are at the same sample move in lockstep, eight at a
/// time.
///
/// # Law
///
/// That of [`Stepped::step`], run by run: every record and every reading equals that of the run alone to the
/// last bit, but for the sign of a zero in the record. Sensing, limits and drives are the code of the single
/// run; only the integration is in lanes. Runs with elastic transmissions, stiction, contacts or end stops,
/// and a run that is alone at its sample, are stepped separately.
///
/// # Example
///
/// ```
/// use phihat_sim::{Abreast, Stepped};
/// use phihat_study::Study;
///
/// # let text = |mass: f64| format!(r#"
/// #     duration_s = 0.2
/// #     [robot]
/// #     name = "planar3r"
/// #     [spec]
/// #     settle_s = 0.1
/// #     [gains]
/// #     bandwidth_rad_s = 20.0
/// #     estimator_bandwidth_rad_s = 70.0
/// #     inertia_kg_m2 = [0.42, 0.18, 0.14]
/// #     [world]
/// #     payload = {{ frame = "tool", mass_kg = {mass} }}
/// #     [reference]
/// #     kind = "hold"
/// #     q_rad = [0.4, -0.7, 0.9]
/// # "#);
/// # let study = |mass: f64| Study::from_text(&text(mass), "demo.toml", "".as_ref());
/// let inertia = [0.42, 0.18, 0.14];
/// let begun = |mass: f64| Ok::<_, Box<dyn std::error::Error>>(Stepped::new(&study(mass)?, &inertia)?);
/// let (mut light, mut heavy) = (begun(0.1)?, begun(0.3)?);
/// let mut abreast = Abreast::default();
/// while !light.is_over() {
///     let torque = [0.2, -0.1, 0.0];
///     abreast.step(&mut [(&mut light, &torque), (&mut heavy, &torque)])?;
/// }
/// assert!(light.sensed()[0].q != heavy.sensed()[0].q);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Default)]
pub struct Abreast {
    groups: Vec<RunGroup>,
}

/// Runs that share lanes, by their numbers.
#[derive(Debug)]
struct RunGroup {
    runs: Vec<u64>,
    /// `None`: they do not go in lanes.
    lanes: Option<PlantLanes>,
    /// True if they were stepped together at the last sample.
    used: bool,
}

impl Abreast {
    /// Sends each run the torque \[N·m\] of every joint for its sample, and steps it to the next one. Nothing
    /// happens in a run that is over.
    ///
    /// # Errors
    ///
    /// [`SimError::JointCount`]: some run has not as many torques as joints; then none goes on.
    pub fn step(&mut self, runs: &mut [(&mut Stepped, &[f64])]) -> Result<(), SimError> {
        for (run, torque) in &*runs {
            run.fits(torque)?;
        }
        let mut going: Vec<&mut Stepped> = Vec::with_capacity(runs.len());
        for (run, torque) in runs.iter_mut().filter(|(run, _)| !run.is_over()) {
            run.tell(torque);
            going.push(run);
        }
        going.sort_by_key(|run| run.sample());
        for beside in going.chunk_by_mut(|a, b| a.sample() == b.sample()) {
            for group in beside.chunks_mut(Lanes::COUNT) {
                self.go_on(group);
            }
        }
        self.groups.retain_mut(|group| core::mem::take(&mut group.used));
        Ok(())
    }

    /// One sample of runs that are at the same one.
    fn go_on(&mut self, group: &mut [&mut Stepped]) {
        let mut t = 0.0;
        for run in &mut *group {
            t = run.begin();
        }
        match self.lanes(group) {
            Some(lanes) => lanes.integrate(t, group, |run| run.world()),
            None => group.iter_mut().for_each(|run| run.world().integrate(t)),
        }
        for run in group {
            run.finish(t);
        }
    }

    /// The lanes of these runs, if they go in lanes.
    fn lanes(&mut self, runs: &mut [&mut Stepped]) -> Option<&mut PlantLanes> {
        if runs.len() < 2 {
            return None;
        }
        let is_theirs = |group: &RunGroup| {
            group.runs.len() == runs.len()
                && group.runs.iter().zip(&*runs).all(|(own, run)| *own == run.number)
        };
        let at = self.groups.iter().position(is_theirs).unwrap_or_else(|| {
            let numbers = runs.iter().map(|run| run.number).collect();
            let worlds: Vec<&SimulatedWorld> = runs.iter_mut().map(|run| &*run.world()).collect();
            let lanes = in_lanes(&worlds);
            self.groups.push(RunGroup { runs: numbers, lanes, used: true });
            self.groups.len() - 1
        });
        let group = &mut self.groups[at];
        group.used = true;
        group.lanes.as_mut()
    }
}

/// Lanes for worlds, if they go in lanes together.
fn in_lanes(worlds: &[&SimulatedWorld]) -> Option<PlantLanes> {
    let fits = |world: &&SimulatedWorld| {
        PlantLanes::alone(world).is_none() && PlantLanes::alike(worlds[0], world)
    };
    worlds.iter().all(fits).then(|| PlantLanes::new(worlds).ok()).flatten()
}
