//! The studies: of each arm, and of the Panda's worlds, in either form.

use std::error::Error;
use std::path::Path;

use phihat_session::set;
use phihat_study::Study;
use toml::{Table, Value};

/// Arms, and what is asked of each form at first \[rad\]: positions, observer.
pub(crate) const ARMS: [(&str, &str, [f64; 2]); 4] = [
    ("panda", include_str!("arms/panda.toml"), [4e-4, 1.2e-3]),
    ("iiwa14", include_str!("arms/iiwa14.toml"), [4e-4, 1.2e-3]),
    ("ur5", include_str!("arms/ur5.toml"), [4e-4, 1.2e-3]),
    ("planar3r", include_str!("arms/planar3r.toml"), [4e-4, 1.2e-3]),
];

/// The study of the worlds.
pub(crate) const PANDA: &str = include_str!("../../../../studies/panda_rate.toml");

/// Forms of the loop: the new one, and the one before.
pub(crate) const FORMS: [&str; 2] = ["positions", "observer"];

/// What a change to a study's text is.
pub(crate) type Edit<'a> = (&'a [&'a str], Value);

/// A study with some keys changed, in a form of the loop.
pub(crate) fn study(
    text: &str,
    form: &str,
    edits: &[Edit<'_>],
) -> Result<Box<Study>, Box<dyn Error>> {
    let mut table: Table = text.parse()?;
    set(&mut table, &["loop", "form"], form.into());
    if form == "observer" {
        // Its designer chooses the filter, as it chooses the gains.
        set(&mut table, &["sensor", "velocity"], "differenced".into());
        set(&mut table, &["sensor", "velocity_filter_hz"], "design".into());
    }
    for (path, value) in edits {
        set(&mut table, path, value.clone());
    }
    Ok(Box::new(Study::from_text(&table.to_string(), &format!("{form}.toml"), Path::new(""))?))
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
