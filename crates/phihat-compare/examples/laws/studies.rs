//! The studies: of each arm, and of the Panda's worlds, in each kind of law.

use std::error::Error;
use std::path::Path;

use phihat_session::set;
use phihat_study::Study;
use toml::{Table, Value};

/// Arms, and their studies.
pub(crate) const ARMS: [(&str, &str); 4] = [
    ("panda", include_str!("arms/panda.toml")),
    ("iiwa14", include_str!("arms/iiwa14.toml")),
    ("ur5", include_str!("arms/ur5.toml")),
    ("planar3r", include_str!("arms/planar3r.toml")),
];

/// The study of the worlds.
pub(crate) const PANDA: &str = include_str!("../../../../studies/panda_rate.toml");

/// A kind of law, and the errors requested of it.
#[derive(Debug)]
pub(crate) struct Kind {
    pub(crate) name: &'static str,
    /// Form of the loop.
    form: &'static str,
    /// True if it may filter its innovation.
    filtered: bool,
    /// First error that is requested on an arm \[rad\].
    pub(crate) first: f64,
    /// Errors that the worlds' gains are designed for, the first that can be proved \[rad\].
    pub(crate) worlds: &'static [f64],
}

/// Errors requested of the gains for the worlds, from positions \[rad\].
const OF_POSITIONS: &[f64] = &[5e-4, 7.5e-4, 1e-3, 1.5e-3, 2e-3];

/// Laws from positions, the same with a filter on their innovation, and those that use a velocity.
pub(crate) const KINDS: [Kind; 3] = [
    Kind {
        name: "positions",
        form: "positions",
        filtered: false,
        first: 4e-4,
        worlds: OF_POSITIONS,
    },
    Kind {
        name: "filtered",
        form: "positions",
        filtered: true,
        first: 4e-4,
        // The first is one that laws without a filter do not reach, and that a filter is sought for.
        worlds: &[3.55e-4, 5e-4, 7.5e-4, 1e-3, 1.5e-3, 2e-3],
    },
    Kind {
        name: "observer",
        form: "observer",
        filtered: false,
        first: 1.2e-3,
        worlds: &[1e-3, 1.5e-3, 2e-3, 3e-3, 4e-3, 6e-3, 8e-3, 12e-3, 16e-3],
    },
];

/// Change of a study: the path of a key, and its new value.
pub(crate) type Edit<'a> = (&'a [&'a str], Value);

/// A study with some keys changed, for a kind of law.
pub(crate) fn study(
    text: &str,
    kind: &Kind,
    edits: &[Edit<'_>],
) -> Result<Box<Study>, Box<dyn Error>> {
    let mut table: Table = text.parse()?;
    set(&mut table, &["loop", "form"], kind.form.into());
    if kind.filtered {
        set(&mut table, &["design", "innovation_filter"], true.into());
    }
    if kind.form == "observer" {
        // Its designer chooses the filter, as it chooses the gains.
        set(&mut table, &["sensor", "velocity"], "differenced".into());
        set(&mut table, &["sensor", "velocity_filter_hz"], "design".into());
    }
    for (path, value) in edits {
        set(&mut table, path, value.clone());
    }
    Ok(Box::new(Study::from_text(
        &table.to_string(),
        &format!("{}.toml", kind.name),
        Path::new(""),
    )?))
}

/// A world: its name, and what differs from the study's.
pub(crate) type World = (&'static str, Vec<Edit<'static>>);

/// Worlds that gains designed for 18 bits run in.
pub(crate) fn worlds() -> Result<Vec<World>, Box<dyn Error>> {
    let table: Table = PANDA.parse()?;
    let sine = |key: &str| table["reference"]["sine"][0][key].clone();
    let mut fast = Table::new();
    for key in ["amplitude_rad", "phase_rad"] {
        fast.insert(key.to_owned(), sine(key));
    }
    let slow = sine("frequency_hz");
    let slow = slow.as_array().ok_or("the Panda's motion has a frequency per joint")?;
    let twice = slow.iter().filter_map(Value::as_float).map(|hz| Value::Float(2.0 * hz));
    fast.insert("frequency_hz".to_owned(), Value::Array(twice.collect()));
    Ok(vec![
        ("as designed", vec![]),
        ("exact sensors", vec![(&["sensor", "encoder_bits"], "none".into())]),
        ("one sample later, untold", vec![(&["loop", "delay_samples"], 2.into())]),
        (
            "payload of 2 kg",
            vec![
                (&["world", "payload", "mass_kg"], 2.0.into()),
                // Only so that the study may be written; the gains know of 1 kg.
                (&["design", "payload_max_kg"], 2.0.into()),
            ],
        ),
        (
            "friction three times",
            vec![
                (&["world", "friction_cold_factor"], 3.0.into()),
                (&["world", "friction_warm_up_s"], 86_400.0.into()),
                (&["world", "substeps"], 4.into()),
            ],
        ),
        (
            "motion twice as fast",
            vec![(&["reference", "sine"], Value::Array(vec![Value::Table(fast)]))],
        ),
        ("encoder of 16 bits", vec![BITS_16]),
    ])
}

/// A coarser encoder.
pub(crate) const BITS_16: Edit<'static> = (&["sensor", "encoder_bits"], Value::Integer(16));
