//! Worlds that are drawn: some to train in, some to choose by, some to be judged in once.

use phihat_session::{Dice, set, share, short_hash};
use phihat_study::Study;
use serde::{Deserialize, Serialize};
use toml::{Table, Value};

use super::margin::Harder;
use crate::arm_case::ArmCase;
use crate::arm_in_world::TimeSpan;
use crate::error::CompareError;
use crate::world::numbers;

/// Purpose of a world.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Split {
    /// Gains are tuned in it.
    Train,
    /// Among tuned gains one choice is made by it.
    Validation,
    /// The chosen gains are judged in it, once.
    Test,
}

/// The splits and how many worlds each has in a whole comparison.
pub const SPLITS: [(Split, u32); 3] =
    [(Split::Train, 20), (Split::Validation, 20), (Split::Test, 50)];

/// Link masses of the model that laws are handed, over the arm's.
const MASSES: (f64, f64) = (0.7, 1.3);
/// Dry friction on top of the robot's own, over the torque limit, at most.
const DRY: f64 = 0.03;
/// Samples from a torque's command to its acting, at most.
const DELAY: usize = 3;
/// Bits of the encoders, the same for all joints.
const BITS: [u32; 5] = [17, 18, 19, 20, 21];
/// Largest error at the start \[rad\].
const START: f64 = 0.05;

/// A drawn world, as data.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Drawn {
    /// Its purpose.
    pub split: Split,
    /// Its number in its split, from 1.
    pub number: u32,
    /// Link masses of the model that laws are handed, over the arm's: 0.7 to 1.3, the same error for every law.
    pub model_masses: f64,
    /// Dry friction on top of the robot's own, over the torque limit of each joint: 0 to 0.03.
    pub dry: f64,
    /// Samples of delay: 0 to 3.
    pub delay_samples: u32,
    /// Bits of the encoders: 17 to 21.
    pub encoder_bits: u32,
    /// Payload over the design's heaviest: 0 to 1; 0 in a quarter of the worlds.
    pub payload: f64,
    /// The name that the motion is drawn from.
    pub motion: String,
    /// Largest error at the start \[rad\]: 0 in half of the worlds, else up to 0.05; its sign and size differ
    /// from joint to joint.
    pub start_rad: f64,
    /// Seed of the random numbers of the run.
    pub seed: u32,
}

/// The worlds of a split: the same for every arm and law. Worlds of different splits, seeds or numbers have
/// nothing in common but the ranges that they are drawn from; more of a split begin with fewer of it.
pub fn draw(seed: u64, split: Split, count: u32) -> Vec<Drawn> {
    (1..=count).map(|number| one(seed, split, number)).collect()
}

fn one(seed: u64, split: Split, number: u32) -> Drawn {
    let motion = format!("fronts {seed} {split:?} {number}");
    let head = short_hash(&[&motion]);
    let start = u64::from_str_radix(head.get(..12).unwrap_or_default(), 16).unwrap_or(seed);
    let mut dice = Dice::new(start, u64::from(number));
    let model_masses = dice.between(MASSES.0, MASSES.1);
    let dry = dice.between(0.0, DRY);
    let delay_samples = u32::try_from(dice.below(DELAY + 1)).unwrap_or(0);
    let encoder_bits = dice.pick(&BITS);
    let payload = if dice.chance(0.25) { 0.0 } else { dice.share() };
    let start_rad = if dice.chance(0.5) { 0.0 } else { dice.between(0.0, START) };
    Drawn {
        split,
        number,
        model_masses,
        dry,
        delay_samples,
        encoder_bits,
        payload,
        motion,
        start_rad,
        seed: number,
    }
}

/// The longest delay \[samples\] and the coarsest encoder \[bit\] that are drawn.
pub(crate) fn hardest() -> (u32, u32) {
    let bits = BITS.iter().copied().min().unwrap_or(1);
    (u32::try_from(DELAY).unwrap_or(u32::MAX), bits)
}

impl ArmCase {
    /// The arm in a drawn world, perturbed or not, as a study of its own that `phihat run` would read. The
    /// robot's own limits of torque rate are on, where its description has them. `span`: length, and start of
    /// the scored part \[s\].
    ///
    /// # Errors
    ///
    /// [`CompareError::Study`]: the arm's study does not bear the world.
    pub fn in_drawn(
        &self,
        drawn: &Drawn,
        harder: Harder,
        span: (f64, f64),
    ) -> Result<Study, CompareError> {
        let mut table = self.drawn_table(drawn, harder, span);
        let study = self.moved(&mut table, &drawn.motion)?;
        let Some(needed) = self.too_stiff(&study) else { return Ok(study) };
        set(&mut table, &["world", "substeps"], i64::from(needed).into());
        self.parse(&table)
    }

    /// The same, with designs for the hardest loop that can be drawn: its longest delay and its coarsest
    /// encoder. Laws with scalars meet those in the training worlds; a design needs them as inputs.
    pub(crate) fn told_of_drawn(mut self) -> Self {
        let (delay, bits) = hardest();
        let mut told = self.study.clone();
        told.control.delay_samples = delay;
        told.sensor.encoder_bits = Some(vec![bits; self.joints()]);
        self.harder = Some(told);
        self
    }

    fn drawn_table(&self, drawn: &Drawn, harder: Harder, (duration, settle): TimeSpan) -> Table {
        let mut table = self.table.clone();
        table.remove("supervisor");
        if let Some(world) = table.get_mut("world").and_then(Value::as_table_mut) {
            for key in ["payload", "push", "coulomb_extra_nm", "viscous_extra_nm_s_rad"] {
                world.remove(key);
            }
        }
        let title = format!("{}: {}", self.name, drawn.motion);
        set(&mut table, &["title"], title.into());
        set(&mut table, &["duration_s"], duration.into());
        set(&mut table, &["spec", "settle_s"], settle.into());
        set(&mut table, &["seed"], i64::from(drawn.seed).into());
        let n = self.joints();
        harder.change(&mut table, drawn.delay_samples, n);
        let bits = vec![Value::from(i64::from(drawn.encoder_bits)); n];
        set(&mut table, &["sensor", "encoder_bits"], Value::Array(bits));
        let dry = self.limits.iter().map(|limit| drawn.dry * limit);
        set(&mut table, &["world", "coulomb_extra_nm"], numbers(dry));
        let payload = drawn.payload * self.study.design.payload.mass.1;
        if payload > 0.0 {
            let mut section = Table::new();
            section.insert("mass_kg".to_owned(), payload.into());
            set(&mut table, &["world", "payload"], section.into());
        }
        let rates = self.study.robot.joints.iter().map(|joint| joint.torque_rate_max);
        if let Some(rates) = rates.collect::<Option<Vec<f64>>>() {
            set(&mut table, &["loop", "torque_rate_max_nm_s"], numbers(rates.into_iter()));
        }
        // Drawn motions begin at their middle.
        let start = self.range.center.iter().enumerate().map(|(i, center)| {
            center + drawn.start_rad * (2.0 * share(&drawn.motion, &format!("start {i}")) - 1.0)
        });
        let mut section = Table::new();
        section.insert("q_rad".to_owned(), numbers(start));
        table.insert("start".to_owned(), section.into());
        table
    }
}

#[cfg(test)]
mod tests {
    use super::{ArmCase, Drawn, Harder, SPLITS, Split, draw};
    use crate::sure::Sure as _;
    use phihat_sim::Simulation;

    const TEXT: &str = include_str!("../../../../studies/table1.toml");

    /// The same seed, the same worlds, and more of them begin alike; another split or seed has none of them.
    #[test]
    fn a_seed_decides_the_worlds_and_splits_share_none() {
        let all: Vec<Drawn> = SPLITS.iter().flat_map(|(split, n)| draw(7, *split, *n)).collect();
        assert_eq!(all.len(), 90);
        assert_eq!(draw(7, Split::Test, 50)[..5], draw(7, Split::Test, 5));
        let mut masses: Vec<f64> = all.iter().map(|drawn| drawn.model_masses).collect();
        masses.extend(draw(8, Split::Train, 20).iter().map(|drawn| drawn.model_masses));
        masses.sort_by(f64::total_cmp);
        assert!(masses.windows(2).all(|pair| pair[0] < pair[1]));
    }

    /// All of each range is drawn from, and nothing beyond.
    #[test]
    fn the_ranges_are_filled() {
        let all = draw(1, Split::Test, 400);
        let spread = |of: &dyn Fn(&Drawn) -> f64| {
            let values: Vec<f64> = all.iter().map(of).collect();
            let ends = |f: fn(f64, f64) -> f64, x: f64| values.iter().copied().fold(x, f);
            (ends(f64::min, f64::INFINITY), ends(f64::max, f64::NEG_INFINITY))
        };
        let (low, high) = spread(&|drawn| drawn.model_masses);
        assert!(low > 0.7 && low < 0.72 && high < 1.3 && high > 1.28);
        assert_eq!(spread(&|drawn| f64::from(drawn.delay_samples)), (0.0, 3.0));
        assert_eq!(spread(&|drawn| f64::from(drawn.encoder_bits)), (17.0, 21.0));
        let (low, high) = spread(&|drawn| drawn.dry);
        assert!(low < 1e-3 && high > 0.029 && high < 0.03);
        let (still, empty) = all.iter().fold((0, 0), |(a, b), drawn| {
            (a + i32::from(drawn.start_rad <= 0.0), b + i32::from(drawn.payload <= 0.0))
        });
        assert!((160..240).contains(&still) && (70..130).contains(&empty), "{still} {empty}");
    }

    /// The study has the drawn values, and its world can be simulated; a perturbed study differs in its
    /// perturbation alone.
    #[test]
    fn a_drawn_world_is_a_study() {
        let arm = ArmCase::from_text(TEXT, "table1.toml").sure();
        for drawn in draw(3, Split::Train, 4) {
            let study = arm.in_drawn(&drawn, Harder::NOT, (1.5, 1.0)).sure();
            assert_eq!(study.control.delay_samples, drawn.delay_samples);
            let mass = study.world.payload.as_ref().map_or(0.0, |payload| payload.body().mass);
            assert!((mass - 0.5 * drawn.payload).abs() < 1e-12);
            for (extra, limit) in study.world.extra_coulomb.iter().zip(&arm.limits) {
                assert!((extra - drawn.dry * limit).abs() < 1e-12);
            }
            let driver = Box::new(crate::arm_in_world::Idle);
            assert!(Simulation::driven(&study, driver, &arm.units).is_ok());
            let [louder, later] =
                Harder::TRIALS.map(|harder| arm.in_drawn(&drawn, harder, (1.5, 1.0)).sure());
            assert_eq!(later.control.delay_samples, drawn.delay_samples + 1);
            assert_eq!(louder.control.delay_samples, drawn.delay_samples);
            assert!(
                louder.text.contains("1.3") && louder.text.contains("[world.drive]"),
                "{}",
                louder.text
            );
        }
    }
}
