//! Readers of documents: no bytes make them panic, and what they accept is what they give back.

use std::fs;
use std::path::PathBuf;
use std::sync::LazyLock;
use std::sync::atomic::{AtomicU32, Ordering};

use bytes::Bytes;
use phihat_campaign::Journal;
use phihat_certificate::Gains;
use phihat_model::{Robot, Workspace};
use phihat_sim::{ParquetError, ParquetTable, Trace, TraceError, Values};
use phihat_study::Study;

use crate::project;

/// Returns true if a message is readable: not empty, no control characters but line ends and tabs.
fn is_told(message: &str) -> bool {
    let plain = |c: char| !c.is_control() || c == '\n' || c == '\t';
    !message.trim().is_empty() && message.chars().all(plain)
}

/// A study file.
///
/// # Panics
///
/// A promise is broken; so do all targets.
pub fn study(bytes: &[u8]) {
    let Ok(text) = core::str::from_utf8(bytes) else { return };
    match Study::from_text(text, "fuzz.toml", &project().join("studies")) {
        Ok(study) => {
            let n = study.robot.joints.len();
            assert!(n > 0 && study.duration.is_finite() && study.duration > 0.0);
            assert!(study.control.period_ns > 0);
            let limits = [&study.spec.error_bound, &study.spec.velocity_error_bound];
            for limit in limits.into_iter().flatten() {
                assert!(limit.len() == n && limit.iter().all(|x| *x > 0.0 && x.is_finite()));
            }
        }
        Err(why) => assert!(is_told(&why.render()), "{:?}", why.render()),
    }
}

/// A robot file, beside the planar arm's URDF.
///
/// # Panics
///
/// A promise is broken.
pub fn robot_file(bytes: &[u8]) {
    const URDF: &str = include_str!("../../phihat-model/robots/planar3r.urdf");
    let Ok(text) = core::str::from_utf8(bytes) else { return };
    let read = Robot::from_text(URDF, Some(text), "fuzz.toml");
    checked(read);
}

/// A URDF.
///
/// # Panics
///
/// A promise is broken.
pub fn urdf(bytes: &[u8]) {
    let Ok(text) = core::str::from_utf8(bytes) else { return };
    checked(Robot::from_text(text, None, "fuzz.urdf"));
}

/// An MJCF.
///
/// # Panics
///
/// A promise is broken.
pub fn mjcf(bytes: &[u8]) {
    let Ok(text) = core::str::from_utf8(bytes) else { return };
    checked(Robot::from_text(text, None, "fuzz.xml"));
}

/// Limits are ordered, numbers finite, and the mass matrix is symmetric where it is finite.
fn checked(read: Result<Robot, phihat_model::RobotError>) {
    let robot = match read {
        Ok(robot) => robot,
        Err(why) => return assert!(is_told(&why.to_string()), "{why:?}"),
    };
    let n = robot.joints.len();
    for joint in &robot.joints {
        assert!(joint.position.is_none_or(|(low, high)| low < high && (high - low).is_finite()));
        assert!(joint.torque_max.is_none_or(|x| x > 0.0 && x.is_finite()));
        assert!(joint.armature >= 0.0 && joint.armature.is_finite());
        assert!(joint.friction.viscous >= 0.0 && joint.friction.coulomb >= 0.0);
    }
    assert!(robot.poses.values().all(|pose| pose.len() == n));
    let model = robot.plant_model();
    let q = vec![0.3; n];
    let mut m = vec![0.0_f64; n * n];
    model.mass_matrix(&mut Workspace::new(&model), &q, &mut m);
    if m.iter().all(|x| x.abs() < 1e100) {
        for i in 0..n {
            for j in 0..n {
                let apart = (m[i * n + j] - m[j * n + i]).abs();
                assert!(apart <= 1e-9 * (m[i * n + i] + m[j * n + j]).abs(), "not symmetric");
            }
        }
    }
}

/// A gains document; those that are read back are verified too.
///
/// # Panics
///
/// A promise is broken.
pub fn gains(bytes: &[u8]) {
    let Ok(text) = core::str::from_utf8(bytes) else { return };
    match Gains::from_json(text) {
        Ok(gains) => {
            let again = gains.to_json().map(|text| Gains::from_json(&text));
            assert!(matches!(again, Ok(Ok(again)) if again == gains), "does not read back");
            let names: Vec<String> = gains.joints.iter().map(|joint| joint.name.clone()).collect();
            for form in [phihat::Form::Observer, phihat::Form::Positions] {
                if let Ok(laws) = gains.joint_gains(&names, 1_000_000, form) {
                    assert_eq!(laws.len(), names.len());
                }
            }
        }
        Err(why) => assert!(is_told(&why.to_string()), "{why:?}"),
    }
}

/// Studies whose arms the kept traces are of.
static STUDIES: LazyLock<Vec<Study>> = LazyLock::new(|| {
    let read = |name: &str| Study::read(&project().join("studies").join(name)).ok();
    ["panda.toml", "payload_drop.toml"].into_iter().filter_map(read).collect()
});

/// A recorded trace as Parquet, and whatever table the bytes are of.
///
/// # Panics
///
/// A promise is broken.
pub fn trace_parquet(bytes: &[u8]) {
    let read = |bytes: &[u8], study: &Study| Trace::read(Bytes::copy_from_slice(bytes), study);
    recorded(bytes, read, |trace, file| trace.write_parquet(file).is_ok());
    table(bytes);
}

/// A trace of each study's arm is refused with a reason, or is read and written again to bytes that read back the same.
fn recorded(
    bytes: &[u8],
    read: impl Fn(&[u8], &Study) -> Result<Trace, TraceError>,
    write: impl Fn(&Trace, &mut Vec<u8>) -> bool,
) {
    assert_eq!(STUDIES.len(), 2);
    for study in STUDIES.iter() {
        match read(bytes, study) {
            Ok(trace) => {
                let (mut file, mut twice) = (Vec::new(), Vec::new());
                assert!(write(&trace, &mut file));
                let written = read(&file, study).is_ok_and(|again| write(&again, &mut twice));
                assert!(written && file == twice, "does not read back");
            }
            Err(why) => assert!(is_told(&why.to_string()), "{why:?}"),
        }
    }
}

/// Every column of a table that is read.
fn table(bytes: &[u8]) {
    let Ok(table) = ParquetTable::open(Bytes::copy_from_slice(bytes)) else { return };
    let (all, places): (Vec<_>, Vec<usize>) =
        (table.columns().map(|(_, kind)| kind).collect(), (0..table.columns().count()).collect());
    for (place, kind) in places.into_iter().zip(all) {
        let mut rows = 0;
        let read = table.read(&[place], 1000, |first, values| {
            assert_eq!(first, rows);
            rows += match &values[0] {
                Values::Numbers(values) => values.len(),
                Values::Integers(values) => values.len(),
                Values::Flags(values) => values.len(),
                Values::Texts(texts) => texts.rows().len(),
            } as u64;
            Ok::<(), ParquetError>(())
        });
        match read {
            Ok(()) => assert!(kind.is_some() && rows == table.rows()),
            Err(why) => assert!(is_told(&why.to_string()), "{why:?}"),
        }
    }
}

/// A recorded trace.
///
/// # Panics
///
/// A promise is broken.
pub fn trace(bytes: &[u8]) {
    let read = |bytes: &[u8], study: &Study| Trace::read_csv(bytes, study);
    recorded(bytes, read, |trace, file| trace.write_csv(file).is_ok());
}

/// A file of these bytes in the system's folder for such.
fn file(bytes: &[u8]) -> Option<PathBuf> {
    static COUNT: AtomicU32 = AtomicU32::new(0);
    let count = COUNT.fetch_add(1, Ordering::Relaxed);
    let path = std::env::temp_dir().join(format!("phihat_fuzz_{}_{count}", std::process::id()));
    fs::write(&path, bytes).ok()?;
    Some(path)
}

/// A campaign's journal: damaged lines are passed over, the others are there, and it goes on.
///
/// # Panics
///
/// A promise is broken.
pub fn journal(bytes: &[u8]) {
    let Some(path) = file(bytes) else { return };
    let before = Journal::open(&path).map(|mut journal| {
        let appended = journal.append("fuzz", &[1, 2]);
        (journal.len(), journal.damaged().len(), appended.is_ok())
    });
    let after =
        Journal::open(&path).map(|journal| (journal.len(), journal.entry("fuzz").is_some()));
    let gone = fs::remove_file(&path);
    let (Ok((len, damaged, appended)), Ok((again, there))) = (before, after) else {
        panic!("a journal of any bytes opens");
    };
    let lines = bytes.split(|b| *b == b'\n').count();
    assert!(appended && there && again == len && damaged <= lines && gone.is_ok());
}

/// A recorded reference (CSV), named by a study.
///
/// # Panics
///
/// A promise is broken.
pub fn reference_csv(bytes: &[u8]) {
    let Some(path) = file(bytes) else { return };
    let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let study = format!(
        "duration_s = 0.5\n[robot]\nname = \"planar3r\"\n[spec]\nerror_bound_rad = 1e-3\n[design]\n\
         [reference]\nkind = \"samples\"\nfile = \"{name}\"\n"
    );
    let read = Study::from_text(&study, "fuzz.toml", &std::env::temp_dir());
    let gone = fs::remove_file(&path);
    assert!(gone.is_ok());
    if let Err(why) = read {
        assert!(is_told(&why.render()), "{:?}", why.render());
    }
}
