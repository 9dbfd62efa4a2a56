//! A study for an arm whose description has joints and no masses: each joint's intervals are left to be filled in.

use std::fmt::Write as _;
use std::path::Path;

use phihat_model::{Joint, JointKind, MotionOnly, Part, Robot, RobotError};

use super::options::BeginOptions;
use crate::error::SessionError;

/// Error that is allowed where none is stated \[rad, m\].
const ERROR_BOUND: f64 = 5e-3;

/// Amplitude of the motion \[rad\], \[m\], and as a share of the travel; its frequency \[Hz\], and the share of a
/// largest speed that it takes.
const AMPLITUDE: f64 = 0.2;
const AMPLITUDE_M: f64 = 0.02;
const SHARE: f64 = 0.2;
const FREQUENCY_HZ: f64 = 0.1;
const SPEED: f64 = 0.3;

/// Keys that a description without masses cannot fill, with what each one is.
const OPEN: [(&str, &str); 4] = [
    (
        "inertia_min_kg_m2",
        "least inertia that the joint moves: rotor included, in any posture, with any load",
    ),
    ("inertia_max_kg_m2", "largest inertia that it moves"),
    (
        "phi_rate_max_nm_s",
        "how fast gravity and what the other joints do to it change at most, in N·m/s",
    ),
    ("phi_jump_max_nm", "twice its dry friction"),
];

/// Joints of the file that describes motion only; `None`: it has masses, or cannot be read at all.
pub(super) fn joints_of(options: &BeginOptions) -> Option<MotionOnly> {
    let (path, files) = (Path::new(&options.arm.arm), &options.arm.files);
    let without_mass = |part: &Part| {
        let read = Robot::read_from(files, path, part);
        matches!(read, Err(RobotError::NoInertia { .. }))
            .then(|| Robot::joints_of(files, path, part).ok())
            .flatten()
    };
    if !files.is_file(path) || path.extension().is_some_and(|extension| extension == "toml") {
        return None;
    }
    if options.arm.part.is_stated() {
        return without_mass(&options.arm.part);
    }
    let chain = Robot::chains_from(files, path).ok()?.into_iter().next()?;
    without_mass(&Part { base: Some(chain.base), tip: Some(chain.tip), ..Part::default() })
}

/// Study of such an arm.
pub(super) struct MotionOnlyStudy {
    pub(super) text: String,
    pub(super) joints: Vec<Joint>,
    pub(super) error_bound: f64,
    /// Reason why no gains can be designed yet.
    pub(super) lacks: String,
    pub(super) warnings: Vec<String>,
}

/// The study of such an arm.
pub(super) fn study_of(
    (options, named): (&BeginOptions, &str),
    MotionOnly { name, mut joints, warnings }: MotionOnly,
) -> Result<MotionOnlyStudy, SessionError> {
    options.arm.limit(&mut joints)?;
    let text = study(options, &name, &joints);
    let keys = OPEN.map(|(key, _)| key).join(", ");
    let lacks = format!(
        "{named} has no masses, so no gains can be designed yet: fill in {keys} of each [[joint]] in {}; `phihat \
         identify` finds them from records of the arm",
        options.out.display()
    );
    let error_bound = options.error_bound.unwrap_or(ERROR_BOUND);
    Ok(MotionOnlyStudy { text, joints, error_bound, lacks, warnings })
}

fn slides(joint: &Joint) -> bool {
    joint.kind == JointKind::Prismatic
}

/// The whole study.
fn study(options: &BeginOptions, name: &str, joints: &[Joint]) -> String {
    let word = |text: &str| toml::Value::String(text.to_owned()).to_string();
    let mut text = format!(
        "# A study made by `phihat new` of a description without masses. Fill in what stands behind a # in each \
         [[joint]];\n# `phihat identify` finds it from records of the arm. Then `phihat run THIS FILE`. Every key: \
         docs/study.md.\ntitle = {}\nduration_s = 20.0\nseed = 1\n",
        word(&format!("First run of {name}, joint by joint")),
    );
    for joint in joints {
        // Infallible: a String takes everything.
        let _ = write!(text, "\n[[joint]]\nname = {}\n", word(&joint.name));
        if slides(joint) {
            let _ = writeln!(
                text,
                "slides = true                # read kg for kg·m², N for N·m, m for rad"
            );
        }
        for (key, doc) in OPEN {
            let _ = writeln!(text, "# {key} =        # {doc}");
        }
        if joint.torque_max.is_none() {
            let _ = writeln!(
                text,
                "# torque_max_nm =        # the drive's largest torque at the joint"
            );
        }
        let travel = joint.position;
        for (key, value) in [
            ("torque_max_nm", joint.torque_max),
            ("velocity_max_rad_s", joint.velocity_max),
            ("position_min_rad", travel.map(|(low, _)| low)),
            ("position_max_rad", travel.map(|(_, high)| high)),
        ] {
            if let Some(value) = value {
                let _ = writeln!(text, "{key} = {value:?}");
            }
        }
    }
    let error = options.error_bound.unwrap_or(ERROR_BOUND);
    let (rate, delay) = (options.rate_hz.unwrap_or(1000.0), options.delay_samples.unwrap_or(1));
    let bits = options.encoder_bits.unwrap_or(18);
    let _ = write!(
        text,
        "\n# The error you can live with, from settle_s on.\n[spec]\nsettle_s = 2.0\nerror_bound_rad = \
         {error:?}\n\n[design]\n\n# The control loop: rate, and the samples from measuring to the torque that acts.\n\
         [loop]\nrate_hz = {rate:?}\ndelay_samples = {delay}\n\n\
         # Bits of the encoders over one turn of the joint: those of your arm.\n\
         [sensor]\nencoder_bits = {bits}\nvelocity = \"differenced\"\nvelocity_filter_hz = \"design\"\n",
    );
    reference(&mut text, joints);
    text
}

/// A slow sine per joint about the middle of its travel.
fn reference(text: &mut String, joints: &[Joint]) {
    let centre = |joint: &Joint| joint.position.map_or(0.0, |(low, high)| 0.5 * (low + high));
    let amplitude = |joint: &Joint| {
        let most = if slides(joint) { AMPLITUDE_M } else { AMPLITUDE };
        joint.position.map_or(most, |(low, high)| most.min(SHARE * (high - low)))
    };
    let frequency = |joint: &Joint| {
        let speed = joint.velocity_max.map_or(f64::INFINITY, |most| SPEED * most);
        FREQUENCY_HZ.min(speed / (core::f64::consts::TAU * amplitude(joint)))
    };
    let list = |of: &dyn Fn(&Joint) -> f64| {
        let all: Vec<String> = joints.iter().map(|joint| format!("{:.4}", of(joint))).collect();
        format!("[{}]", all.join(", "))
    };
    let _ = write!(
        text,
        "\n# What the arm shall do: a slow sine per joint about the middle of its travel. What it might hit is not \
         known here.\n[reference]\nkind = \"sines\"\ncenter_rad = {}\nfade_in_s = 2.0\n\n\
         [[reference.sine]]\namplitude_rad = {}\nfrequency_hz = {}\n",
        list(&centre),
        list(&amplitude),
        list(&frequency),
    );
}

#[cfg(test)]
mod tests {
    use std::fs;

    use phihat_study::Study;

    use super::OPEN;
    use crate::begin::{ArmOptions, BeginOptions, begin};

    /// Two joints without masses: the first turns within a degree either way more than a radian, the second slides.
    const URDF: &str = r#"<robot name="bare"><link name="base"/><link name="a"/><link name="b"/>
        <joint name="swing" type="revolute"><parent link="base"/><child link="a"/><axis xyz="0 0 1"/>
        <limit lower="-1" upper="2" effort="0" velocity="0.1"/></joint>
        <joint name="lift" type="prismatic"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/>
        <limit lower="0" upper="0.4" effort="50" velocity="-1"/></joint></robot>"#;

    /// Fails where the study does not ask for what is missing, or where filling that in does not make it a study.
    #[test]
    fn a_description_without_masses_becomes_a_study_that_asks_for_them() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("bare.urdf");
        fs::write(&file, URDF).unwrap();
        let out = folder.path().join("bare.toml");
        let arm = ArmOptions { arm: file.display().to_string(), ..ArmOptions::default() };
        let options = BeginOptions { arm, out: out.clone(), ..BeginOptions::default() };
        let begun = begin(&options, &mut ()).unwrap();
        assert_eq!(
            (&begun.joints[..], &begun.slides[..]),
            (&["swing".into(), "lift".into()][..], &[false, true][..])
        );
        assert!(begun.notes.iter().any(|note| note.contains("lift") && note.contains("-1")));
        let why = begun.infeasible.unwrap();
        assert!(why.contains("no masses") && why.contains("inertia_min_kg_m2"), "{why}");
        let why = Study::read(&out).unwrap_err().to_string();
        assert!(why.contains("inertia_min_kg_m2"), "{why}");
        // Nothing is written over.
        assert!(begin(&options, &mut ()).is_err());
        let text = fs::read_to_string(&out).unwrap();
        let filled =
            OPEN.iter().map(|(key, _)| *key).chain(["torque_max_nm"]).fold(text, |text, key| {
                text.replace(&format!("# {key} ="), &format!("{key} = 0.5"))
            });
        fs::write(&out, filled).unwrap();
        let study = Study::read(&out).unwrap();
        let [swing, lift] = &study.robot.joints[..] else { panic!() };
        assert_eq!(
            (swing.position, swing.torque_max, swing.velocity_max),
            (Some((-1.0, 2.0)), Some(0.5), Some(0.1))
        );
        assert_eq!((lift.position, lift.torque_max), (Some((0.0, 0.4)), Some(50.0)));
    }
}
