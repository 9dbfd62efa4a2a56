//! Numbers of a study by their path. Wrong if a value lands anywhere but at its key, if another one changes,
//! or if a name that is no number's is accepted, or refused without the right one.

use phihat_study::{NumericKey, Study};
use toml::Table;

const TEXT: &str = "duration_s = 2.0\n[robot]\nname = \"planar3r\"\n[gains]\nbandwidth_rad_s = 20.0\n\
    estimator_bandwidth_rad_s = 70.0\ninertia_kg_m2 = [0.42, 0.18, 0.14]\n[loop]\ndelay_samples = 1\n\
    [world]\ncoulomb_extra_nm = { joint1 = 0.1, joint2 = 0.2, joint3 = 0.3 }\n\
    [[fault]]\nkind = \"push\"\nstart_s = 1.0\nsize = 0.4\n\
    [reference]\nkind = \"sines\"\ncenter = \"ready\"\n[[reference.sine]]\namplitude_rad = 0.1\nfrequency_hz = 0.3\n";

fn study(text: &str) -> Study {
    Study::from_text(text, "numeric.toml", "".as_ref()).unwrap()
}

fn with(path: &str, value: f64) -> Study {
    let mut table: Table = TEXT.parse().unwrap();
    NumericKey::find(&study(TEXT), path, "--vary").unwrap().put(&mut table, value);
    study(&table.to_string())
}

#[test]
fn a_value_lands_at_its_key() {
    assert!((with("duration_s", 3.0).duration - 3.0).abs() < 1e-15);
    assert_eq!(with("loop.delay_samples", 2.0).control.delay_samples, 2);
    let payload = with("world.payload.mass_kg", 0.7).world.payload.unwrap();
    assert!((payload.mass - 0.7).abs() < 1e-15);
    assert_eq!(with("world.coulomb_extra_nm", 0.5).world.extra_coulomb, [0.5; 3]);
    assert_eq!(with("world.coulomb_extra_nm[1]", 0.5).world.extra_coulomb, [0.1, 0.5, 0.3]);
    assert_eq!(with("world.coulomb_extra_nm.joint3", 0.5).world.extra_coulomb, [0.1, 0.2, 0.5]);
    assert_eq!(with("world.viscous_extra_nm_s_rad[2]", 0.5).world.extra_viscous, [0.0, 0.0, 0.5]);
    assert_eq!(with("world.gravity_m_s2[0]", 1.5).world.gravity.to_vec(), [1.5, 0.0, -9.81]);
    assert!((with("fault[0].size", 0.9).faults[0].size - 0.9).abs() < 1e-15);
    let before = study(TEXT);
    assert_ne!(with("reference.sine[0].amplitude_rad", 0.2).reference, before.reference);
    assert_ne!(with("gains.inertia_kg_m2.joint2", 0.5).gains, before.gains);
}

#[test]
fn what_is_there_is_multiplied() {
    let scaled = |path: &str| {
        let mut table: Table = TEXT.parse().unwrap();
        let key = NumericKey::find(&study(TEXT), path, "--vary").unwrap();
        let had = key.scale(&mut table, 2.0);
        (had, key.numbers(&table))
    };
    assert_eq!(scaled("gains.inertia_kg_m2"), (true, vec![0.84, 0.36, 0.28]));
    assert_eq!(scaled("gains.inertia_kg_m2[1]"), (true, vec![0.36]));
    assert_eq!(scaled("world.coulomb_extra_nm"), (true, vec![0.2, 0.4, 0.6]));
    assert_eq!(scaled("fault[0].size"), (true, vec![0.8]));
    assert_eq!(scaled("world.payload.mass_kg"), (false, vec![]));
}

#[test]
fn what_is_no_number_is_told_with_what_is() {
    let told = |path: &str| {
        NumericKey::find(&study(TEXT), path, "--vary").map(drop).unwrap_err().to_string()
    };
    for (path, words) in [
        ("world.payload.mass_g", "the unit here is kg; write `world.payload.mass_kg`"),
        ("world.payload.mas_kg", "did you mean `world.payload.mass_kg`?"),
        ("wrld.payload.mass_kg", "did you mean"),
        ("amplitude_rad", "`reference.sine.amplitude_rad`"),
        ("world.payload", "a section, not a number; `world.payload.mass_kg`"),
        ("robot.name", "`name` is not a number"),
        ("fault.size", "name one by its place, from 0: `fault[0]`"),
        ("fault[3].size", "the study has one [[fault]]: `fault[0]`"),
        ("world.push[0].torque_nm", "the study has no [[push]]"),
        ("world.coulomb_extra_nm.elbow", "its joints are joint1, joint2, joint3"),
        ("world.coulomb_extra_nm[3]", "its joints are joint1, joint2, joint3"),
        ("world.gravity_m_s2", "name one by its place, from 0: `gravity_m_s2[0]`"),
        ("duration_s.x", "`duration_s` is one number"),
        ("a..b", "not the path of a key"),
        ("", "not the path of a key"),
        ("fault[x].size", "not the path of a key"),
    ] {
        let told = told(path);
        assert!(told.starts_with("--vary: ") && told.contains(words), "{path}: {told}");
    }
}
