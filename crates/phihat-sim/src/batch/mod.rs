//! Many closed loops at once: arms of one structure side by side.

mod figures;
mod group;
mod law;
mod plain;
mod told;

use phihat_model::Lanes;
use phihat_study::Study;

use crate::metrics::{Measured, Metrics};
use crate::simulation::{Ended, Simulation};
use crate::trace::Trace;
use crate::world::PlantLanes;
use group::LaneGroup;
use plain::Plain;

/// Samples that are kept before their figures are taken.
const BLOCK: usize = 64;

/// Many simulations, run so that arms of one structure move in lockstep, eight at a time.
///
/// Every arm has a study of its own: payload, friction, gains, reference, seed, delay, encoders, limits,
/// faults, supervisor, duration. Structure alone decides which arms share lanes: the joints, the sample
/// period and the integration steps.
///
/// # Law
///
/// The batch is the single run, eight at a time: every arm's record, figures and end equal those of its own
/// [`Simulation`] to the last bit. Sensing, control and drives are the code of the single run; only the
/// integration is in lanes, with the operations of the single one in their order. The one difference is the
/// sign of a zero, in the record.
///
/// # Alone
///
/// Elastic transmissions, stiction, contacts, end stops, and trees run one by one; [`alone`](Self::alone)
/// reports which and why. So does the rest of a group in which only one arm is left.
///
/// # Example
///
/// ```
/// use phihat::{Form, JointDesign, JointGains};
/// use phihat_sim::{Batch, Metrics, Simulation};
/// use phihat_study::Study;
///
/// let text = |mass: f64| format!(r#"
///     duration_s = 0.5
///     [robot]
///     name = "planar3r"
///     [spec]
///     settle_s = 0.1
///     error_bound_rad = 2e-3
///     [gains]
///     order = 1
///     bandwidth_rad_s = 20.0
///     estimator_bandwidth_rad_s = 70.0
///     inertia_kg_m2 = [0.42, 0.18, 0.14]
///     [world]
///     payload = {{ frame = "tool", mass_kg = {mass} }}
///     [reference]
///     kind = "hold"
///     q_rad = [0.4, -0.7, 0.9]
/// "#);
/// let gains = JointDesign {
///     inertia: 0.2, kp: 400.0, kd: 40.0, a: &[70.0], period: 1e-3, form: Form::Observer,
/// };
/// let law = vec![JointGains::new(&gains)?; 3];
/// let studies = [0.1, 0.2, 0.3]
///     .map(|mass| Study::from_text(&text(mass), "demo.toml", "".as_ref()))
///     .into_iter().collect::<Result<Vec<_>, _>>()?;
/// let simulations = studies.iter().map(|study| Simulation::new(study, &law));
/// let batch = Batch::new(simulations.collect::<Result<_, _>>()?);
/// assert_eq!(batch.alone().count(), 0);
///
/// let measured = batch.measure(&studies.iter().collect::<Vec<_>>());
/// let alone = Simulation::new(&studies[1], &law)?.run(|_| ());
/// assert!(measured[1].0 == Metrics::of(&alone.trace, &studies[1])); // to the last bit
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Batch {
    arms: usize,
    groups: Vec<Vec<(usize, Simulation)>>,
    alone: Vec<(usize, Simulation, &'static str)>,
}

impl Batch {
    /// Puts prepared simulations together; their places in the list are the arms' numbers.
    pub fn new(simulations: Vec<Simulation>) -> Self {
        let arms = simulations.len();
        let (mut open, mut groups) = (Vec::<Vec<(usize, Simulation)>>::new(), Vec::new());
        let mut alone = Vec::new();
        for (arm, simulation) in simulations.into_iter().enumerate() {
            if let Some(why) = PlantLanes::alone(&simulation.world) {
                alone.push((arm, simulation, why));
                continue;
            }
            let alike = |group: &Vec<(usize, Simulation)>| {
                group
                    .first()
                    .is_some_and(|(_, first)| PlantLanes::alike(&first.world, &simulation.world))
            };
            match open.iter().position(alike) {
                None => open.push(vec![(arm, simulation)]),
                Some(at) => {
                    open[at].push((arm, simulation));
                    if open[at].len() == Lanes::COUNT {
                        groups.push(open.swap_remove(at));
                    }
                }
            }
        }
        for group in open {
            match <[_; 1]>::try_from(group) {
                Ok([(arm, simulation)]) => alone.push((arm, simulation, "no other arm is like it")),
                Err(group) => groups.push(group),
            }
        }
        Self { arms, groups, alone }
    }

    /// The arms that run one by one, and why.
    pub fn alone(&self) -> impl Iterator<Item = (usize, &'static str)> {
        self.alone.iter().map(|(arm, _, why)| (*arm, *why))
    }

    /// Runs all to their ends and hands every arm's record over in blocks of at most so many samples, as
    /// [`Simulation::stream`] does; how each one ended, in the order of the arms.
    ///
    /// # Errors
    ///
    /// The error of `each` on a block; all runs end there.
    pub fn stream<E>(
        self,
        block: usize,
        mut each: impl FnMut(usize, &mut Trace) -> Result<(), E>,
    ) -> Result<Vec<Ended>, E> {
        let arms = self.arms;
        let ends = self.ends(block, &mut each)?;
        debug_assert_eq!(ends.len(), arms, "every arm ends once");
        Ok(ends.into_iter().map(|(_, ended)| ended).collect())
    }

    /// Runs all, and tells how each arm ended, in their order.
    fn ends<E>(
        self,
        block: usize,
        each: &mut impl FnMut(usize, &mut Trace) -> Result<(), E>,
    ) -> Result<Vec<(usize, Ended)>, E> {
        let mut ends = Vec::with_capacity(self.arms);
        for group in self.groups {
            LaneGroup::new(group, block).run(each, &mut ends)?;
        }
        for (arm, simulation, _) in self.alone {
            ends.push((arm, simulation.stream(block, |_| (), |trace| each(arm, trace))?));
        }
        ends.sort_by_key(|(arm, _)| *arm);
        Ok(ends)
    }

    /// Runs all to their ends and returns the figures that [`Metrics::of`] makes of each one's record, and
    /// its end. `studies` are those of the simulations, in their order; an arm without one has no figures.
    ///
    /// No record is made: where there are no faults, no losses, no supervisor and no robot's interface,
    /// sensing, law, delays, drives and figures are in lanes too.
    pub fn measure(mut self, studies: &[&Study]) -> Vec<(Metrics, Ended)> {
        let (mut done, mut kept) = (Vec::new(), Vec::new());
        self.groups.retain(|group| {
            let plain = Plain::of(group, studies).and_then(|plain| plain.run(group, &mut kept));
            let Some(figures) = plain else { return true };
            done.extend(group.iter().map(|(arm, _)| *arm).zip(figures));
            false
        });
        let mut measured: Vec<Measured> =
            studies.iter().map(|study| Measured::new(study)).collect();
        let mut take = |arm: usize, trace: &mut Trace| -> Result<(), core::convert::Infallible> {
            if let Some(measured) = measured.get_mut(arm) {
                measured.block(trace);
            }
            Ok(())
        };
        let Ok(ends) = self.ends(BLOCK, &mut take);
        let mut measured: Vec<Option<Measured>> = measured.into_iter().map(Some).collect();
        done.extend(ends.into_iter().filter_map(|(arm, ended)| {
            let measured = measured.get_mut(arm)?.take()?;
            Some((arm, (measured.metrics(), ended)))
        }));
        done.sort_by_key(|(arm, _)| *arm);
        done.into_iter().map(|(_, figures)| figures).collect()
    }
}
