//! The worlds of the comparison, as changes of a study.

use phihat_sim::Demand;
use phihat_study::Study;
use toml::{Table, Value};

use phihat_session::set;

/// A world: its contents besides the arm.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ComparisonWorld {
    /// Its name, `[a-z-]`.
    pub name: &'static str,
    /// Its contents, in one line.
    pub what: &'static str,
    parts: WorldParts,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum WorldParts {
    Exact,
    Encoder,
    Delay,
    Payload,
    Friction,
    Saturation,
}

/// The worlds, from easy to hard.
pub const WORLDS: &[ComparisonWorld] = &[
    ComparisonWorld {
        name: "exact",
        what: "exact position and velocity, no delay; gravity and the robot's own friction",
        parts: WorldParts::Exact,
    },
    ComparisonWorld {
        name: "encoder",
        what: "the study's encoder and velocity filter",
        parts: WorldParts::Encoder,
    },
    ComparisonWorld {
        name: "delay",
        what: "encoder and filter, and a torque acts a sample later at least",
        parts: WorldParts::Delay,
    },
    ComparisonWorld {
        name: "payload",
        what: "encoder, filter, delay; the design's heaviest payload at the tip, unknown to the rival",
        parts: WorldParts::Payload,
    },
    ComparisonWorld {
        name: "friction",
        what: "encoder, filter, delay; dry friction of 2 % of each torque limit on top",
        parts: WorldParts::Friction,
    },
    ComparisonWorld {
        name: "saturation",
        what: "encoder, filter, delay; torque limits just above what the motion asks for, and for 0.1 s a push \
               on every joint that is 1.3 times its limit",
        parts: WorldParts::Saturation,
    },
];

/// The worlds that rivals are tuned in: gains have to bear the arm with dry friction, and with its heaviest load.
/// Figures of the whole row are those of the first.
pub(crate) const TRAINING: [&ComparisonWorld; 2] = [&WORLDS[4], &WORLDS[3]];

/// The world whose torque limits are drawn in on purpose.
pub const SATURATION: &str = WORLDS[5].name;

/// Dry friction over the torque limit.
const DRY: f64 = 0.02;

/// Torque limit over what the motion asks for, and its least over the study's own.
const ROOM: (f64, f64) = (1.2, 0.2);

/// A push over the torque limit, and how long it lasts \[s\].
const PUSH: (f64, f64) = (1.3, 0.1);

/// The world of a name.
pub fn world(name: &str) -> Option<&'static ComparisonWorld> {
    WORLDS.iter().find(|world| world.name == name)
}

impl ComparisonWorld {
    /// Puts the world into a study's table. `study` is the same table, read.
    pub(crate) fn change(&self, table: &mut Table, study: &Study, demand: &Demand) {
        for section in ["payload", "push", "coulomb_extra_nm", "viscous_extra_nm_s_rad"] {
            if let Some(world) = table.get_mut("world").and_then(Value::as_table_mut) {
                world.remove(section);
            }
        }
        table.remove("supervisor");
        let late = match self.parts {
            WorldParts::Exact | WorldParts::Encoder => 0,
            _ => study.control.delay_samples.max(1),
        };
        set(table, &["loop", "delay_samples"], i64::from(late).into());
        let limits = study.control.torque_max.as_deref().unwrap_or_default();
        match self.parts {
            WorldParts::Exact => _ = table.remove("sensor"),
            WorldParts::Encoder | WorldParts::Delay => {}
            WorldParts::Payload => {
                let mut payload = Table::new();
                payload.insert("mass_kg".to_owned(), study.design.payload.mass.1.into());
                set(table, &["world", "payload"], payload.into());
            }
            WorldParts::Friction => {
                let dry = limits.iter().map(|limit| DRY * limit);
                set(table, &["world", "coulomb_extra_nm"], numbers(dry));
            }
            WorldParts::Saturation => {
                let limits: Vec<f64> = limits
                    .iter()
                    .enumerate()
                    .map(|(i, limit)| {
                        limit.min((ROOM.0 * demand.phi(i, 0.0).size).max(ROOM.1 * limit))
                    })
                    .collect();
                set(table, &["loop", "torque_max_nm"], numbers(limits.iter().copied()));
                let start = push_start(study.spec.settle, study.duration);
                let pushes = study.robot.joints.iter().zip(&limits).map(|(joint, limit)| {
                    let mut push = Table::new();
                    push.insert("joint".to_owned(), joint.name.clone().into());
                    push.insert("torque_nm".to_owned(), (PUSH.0 * limit).into());
                    push.insert("start_s".to_owned(), start.into());
                    push.insert("duration_s".to_owned(), PUSH.1.into());
                    Value::Table(push)
                });
                set(table, &["world", "push"], Value::Array(pushes.collect()));
            }
        }
    }
}

/// A third of the way through the scored part, on a whole millisecond.
fn push_start(settle: f64, duration: f64) -> f64 {
    ((settle + (duration - settle) / 3.0) * 1e3).round() * 1e-3
}

pub(crate) fn numbers(values: impl Iterator<Item = f64>) -> Value {
    Value::Array(values.map(Value::from).collect())
}
