//! A study's world behind the Franka Control Interface.

use std::net::{IpAddr, SocketAddr};
use std::path::{Path, PathBuf};

use phihat_fci::{
    Ending, Event, FciError, Host, JOINTS, NO_POSE, Pace, Packets, RobotRules, RobotSide,
    StateSensed, World,
};
use phihat_model::{FrameId, JointKind, Model, Workspace};
use phihat_study::Study;
use thiserror::Error;

use crate::design;
use crate::error::SessionError;
use crate::layout::TraceKind;
use crate::outside::OutsideRun;
use crate::served_record::{RecordPlace, ServedMotion, ServedRecorder, WriterReport};

/// Options of serving a study.
#[derive(Debug, Clone)]
pub struct ServeOptions {
    /// The study file (TOML).
    pub study: PathBuf,
    /// Folder for the results; `None`: `out/STUDY`.
    pub out: Option<PathBuf>,
    /// Address that is listened on.
    pub listen: IpAddr,
    /// Port that is listened on; 0: any that is free.
    pub port: u16,
    /// Kind of file of a motion's trace.
    pub trace: TraceKind,
    /// Clock of the loop: the client's commands, or this machine's.
    pub pace: Pace,
    /// Cycles of motion after which serving ends; `None`: never.
    pub cycles: Option<u64>,
}

/// Observer of a study that is served.
pub trait ServeWatch {
    /// A client comes, goes, or is sent away.
    fn event(&mut self, event: Event);

    /// Reports files that are being written; they are invalid unless the motion that is recorded there comes
    /// to its end.
    fn begun(&mut self, unfinished: &[PathBuf]) {
        let _ = unfinished;
    }

    /// A motion has ended. Without a record: no command ever acted.
    fn motion(&mut self, motion: &ServedMotion);
}

/// A study that is listened for clients of.
#[derive(Debug)]
pub struct Serve {
    host: Host,
    world: ServedWorld,
}

/// The world of a study, begun anew by each motion.
#[derive(Debug)]
struct ServedWorld {
    study: Box<Study>,
    path: PathBuf,
    folder: PathBuf,
    command: String,
    /// The world of the motion; `None`: it was taken for its record.
    run: Option<OutsideRun>,
    robot: RobotGeometry,
    sensed: StateSensed,
    stepped: u64,
    left: Option<u64>,
    done: bool,
    recorder: ServedRecorder,
    /// True while the record of the motion before is being written to the disk.
    writing: bool,
}

/// The robot's model of its arm: gravity torque and pose of the hand.
#[derive(Debug)]
struct RobotGeometry {
    model: Model,
    workspace: Workspace<f64>,
    tip: Option<FrameId>,
    adds_gravity: bool,
}

impl ServeOptions {
    /// Reads and checks everything, and listens.
    ///
    /// # Errors
    ///
    /// [`SessionError`]: the study cannot be simulated, is of no arm that the interface supports, or the port
    /// cannot be opened.
    pub fn open(&self) -> Result<Serve, SessionError> {
        let study = design::read(&self.study)?;
        fits(&study, self.cycles).map_err(|why| SessionError::at(&self.study, why))?;
        let default = || Path::new("out").join(&study.name);
        let folder = self.out.clone().unwrap_or_else(default);
        let model = description(&study)?;
        let side = RobotSide::new(rules(&study), model);
        let waits = matches!(self.pace, Pace::LockStep { .. });
        let place = (folder, self.trace, waits);
        let world = ServedWorld::new(study, &self.study, place, self.cycles)?;
        let host = Host::listen(self.listen, self.port, self.pace, side);
        Ok(Serve { host: host.map_err(SessionError::other)?, world })
    }
}

impl Serve {
    /// Address on which it listens.
    pub fn address(&self) -> SocketAddr {
        self.host.address()
    }

    /// The study that is served.
    pub fn study(&self) -> &Study {
        &self.world.study
    }

    /// Folder for the results.
    pub fn folder(&self) -> &Path {
        &self.world.folder
    }

    /// Serves until the requested cycles are over. Each motion leaves its record, with its page, in place of
    /// the one before.
    ///
    /// # Errors
    ///
    /// [`SessionError`]: a record cannot be written.
    pub fn run(&mut self, watch: &mut dyn ServeWatch) -> Result<(), SessionError> {
        let mut watched = Watched { world: &mut self.world, watch, failure: None };
        self.host.serve(&mut watched)?;
        watched.failure.map_or(Ok(()), Err)
    }
}

/// Why a study is not served.
#[derive(Debug, Error)]
enum Unserved {
    #[error(
        "robot {robot} has {joints} joints; the Franka Control Interface knows arms of {JOINTS}"
    )]
    Joints { robot: String, joints: usize },
    #[error("{0} slides; the Franka Control Interface knows joints that turn")]
    Slides(String),
    #[error("loop.rate_hz = {0}; the Franka Control Interface runs at 1000")]
    Rate(f64),
    #[error("{cycles} cycles; its motion has {samples}, so 1 to {samples} is valid")]
    Cycles { cycles: u64, samples: u64 },
}

/// Checks that the interface can serve a study.
fn fits(study: &Study, cycles: Option<u64>) -> Result<(), Unserved> {
    let joints = study.robot.joints.len();
    if joints != JOINTS {
        return Err(Unserved::Joints { robot: study.robot.name.clone(), joints });
    }
    if let Some(joint) = study.robot.joints.iter().find(|j| j.kind == JointKind::Prismatic) {
        return Err(Unserved::Slides(joint.name.clone()));
    }
    if study.control.period_ns != 1_000_000 {
        return Err(Unserved::Rate(1e9 / study.control.period_ns as f64));
    }
    let samples = phihat_sim::samples(study.duration, study.control.period_ns);
    match cycles {
        Some(cycles) if !(1..=samples).contains(&cycles) => {
            Err(Unserved::Cycles { cycles, samples })
        }
        _ => Ok(()),
    }
}

/// Stop conditions of the robot: those of the study's profile, and the arm's own limits of speed.
fn rules(study: &Study) -> RobotRules {
    let profile = &study.interface.profile;
    let period = study.control.period_ns as f64 * 1e-9;
    let mut velocity_max = [f64::INFINITY; JOINTS];
    for (most, joint) in velocity_max.iter_mut().zip(&study.robot.joints) {
        *most = joint.velocity_max.unwrap_or(f64::INFINITY);
    }
    RobotRules {
        torque_step_max: profile.torque_rate_max.map(|rate| rate * period),
        first_torque_max: profile.first_torque_max,
        velocity_max,
        losses_max: profile.losses_max,
    }
}

/// Element that libfranka reads for each joint in addition to its `<limit>`: the speed that is safe at a
/// distance `d` from an end of travel is `−offset + √(2 d deceleration)`. Here it is 100 rad/s everywhere: no
/// such rule acts.
const SPEED_BY_POSITION: &str =
    "<position_based_velocity_limits velocity_offset=\"-100\" deceleration_limit=\"0\"/>";

/// The arm's URDF as a robot would send it: libfranka recognizes joints by names that contain `joint1` to
/// `joint7`, so the arm's have these names, and no other has.
fn description(study: &Study) -> Result<String, SessionError> {
    let urdf = study.robot.urdf().map_err(SessionError::other)?;
    let arm = &study.robot.name;
    let mut whole = String::with_capacity(urdf.len() + 1024);
    for (n, piece) in urdf.split_inclusive("</joint>").enumerate() {
        let Some((before, name, after)) = joint_of(piece) else {
            whole.push_str(piece);
            continue;
        };
        let place = study.robot.joints.iter().position(|joint| joint.name == name);
        let Some(place) = place else {
            whole.extend([before, arm, "_fixed", &n.to_string(), after]);
            continue;
        };
        let body = after.strip_suffix("</joint>").unwrap_or(after);
        let number = (place + 1).to_string();
        whole.extend([before, arm, "_joint", &number, body, SPEED_BY_POSITION, "</joint>"]);
    }
    Ok(whole)
}

/// Text before the name of the joint that ends a piece of a URDF, the name, and the text after it.
fn joint_of(piece: &str) -> Option<(&str, &str, &str)> {
    let begun = piece.rfind("<joint").filter(|_| piece.ends_with("</joint>"))?;
    let name = begun + piece.get(begun..)?.find("name=")? + "name=".len();
    let quote = piece.get(name..)?.chars().next()?;
    let (before, rest) = piece.split_at_checked(name + quote.len_utf8())?;
    let (name, _) = rest.split_once(quote)?;
    Some((before, name, rest.get(name.len()..)?))
}

impl ServedWorld {
    fn new(
        study: Box<Study>,
        path: &Path,
        (folder, kind, waits): (PathBuf, TraceKind, bool),
        cycles: Option<u64>,
    ) -> Result<Self, SessionError> {
        let command = format!("phihat serve {} --fci", path.display());
        let run = OutsideRun::served(study.clone(), path, command.clone())?;
        let model = study.robot.plant_model().with_gravity(study.world.gravity);
        let robot = RobotGeometry {
            workspace: Workspace::new(&model),
            tip: model.frame(&study.robot.tip),
            model,
            adds_gravity: study.interface.profile.adds_gravity,
        };
        let place =
            RecordPlace { study: Box::new(run.study().clone()), folder: folder.clone(), kind };
        let recorder = ServedRecorder::new(place, waits);
        let (path, done, writing) = (path.to_owned(), false, false);
        let (run, sensed) = (Some(run), StateSensed::default());
        Ok(Self {
            study,
            path,
            folder,
            command,
            run,
            robot,
            sensed,
            stepped: 0,
            left: cycles,
            done,
            recorder,
            writing,
        })
    }

    fn begin(&mut self) -> Result<(), SessionError> {
        let (study, command) = (self.study.clone(), self.command.clone());
        self.run = Some(OutsideRun::served(study, &self.path, command)?);
        self.stepped = 0;
        Ok(())
    }

    fn sensed(&mut self) -> StateSensed {
        let Some(OutsideRun { run, .. }) = &self.run else {
            // Between motions something holds the arm where it is.
            let rest = [0.0; JOINTS];
            self.sensed = StateSensed { dq: rest, tau_j_d: rest, arrives: true, ..self.sensed };
            return self.sensed;
        };
        let sensed = run.sensed();
        for (i, joint) in sensed.iter().enumerate().take(JOINTS) {
            self.sensed.q[i] = joint.q;
            self.sensed.dq[i] = joint.dq;
            self.sensed.tau_j[i] = joint.tau_applied;
            self.sensed.tau_j_d[i] = run.accepted().get(i).copied().unwrap_or_default();
        }
        self.sensed.arrives = run.is_fresh();
        self.robot.complete(&mut self.sensed);
        self.sensed
    }

    fn step(&mut self, torque: &[f64; JOINTS]) {
        if let Some(OutsideRun { run, .. }) = &mut self.run {
            // As many as joints: that was looked at first.
            let _ = run.step(torque);
            self.recorder.take(run);
            self.stepped += 1;
            self.left = self.left.map(|left| left.saturating_sub(1));
        }
    }

    fn is_over(&self) -> bool {
        self.left == Some(0) || self.run.as_ref().is_none_or(|run| run.run.is_over())
    }

    /// Hands the rest of a motion over to be written.
    fn ended(&mut self, ending: Ending, packets: Packets) {
        self.done = self.left == Some(0);
        let run = self.run.take().filter(|_| self.stepped > 0);
        let cycles = self.stepped;
        self.recorder.ended(ServedMotion { ending, cycles, packets, record: None }, run);
        self.writing = true;
    }
}

impl RobotGeometry {
    /// Adds what the robot computes from its joints.
    fn complete(&mut self, sensed: &mut StateSensed) {
        if self.adds_gravity {
            let mut gravity = [0.0; JOINTS];
            self.model.gravity_torque(&mut self.workspace, &sensed.q, &mut gravity);
            for (tau, gravity) in sensed.tau_j.iter_mut().zip(gravity) {
                *tau += gravity;
            }
        }
        let Some(tip) = self.tip else { return };
        self.model.forward_kinematics(&mut self.workspace, &sensed.q);
        let pose = self.model.pose(&self.workspace, tip);
        sensed.pose = NO_POSE;
        for column in 0..3 {
            for row in 0..3 {
                sensed.pose[4 * column + row] = pose.r[row][column];
            }
            sensed.pose[12 + column] = pose.p[column];
        }
    }
}

/// The world, and who looks on.
struct Watched<'a> {
    world: &'a mut ServedWorld,
    watch: &'a mut dyn ServeWatch,
    failure: Option<SessionError>,
}

impl Watched<'_> {
    /// Tells what became of the records; with `wait`, until that of the motion before is written.
    fn hear(&mut self, wait: bool) {
        while let Some(told) = self.world.recorder.told(wait && self.world.writing) {
            match told {
                WriterReport::Begun(files) => self.watch.begun(&files),
                WriterReport::Motion(motion) => {
                    self.world.writing = false;
                    self.watch.motion(&motion);
                }
                WriterReport::Failed(why) => {
                    self.world.writing = false;
                    self.failure = Some(why);
                }
            }
        }
    }
}

impl World for Watched<'_> {
    type Error = SessionError;

    fn begin(&mut self) -> Result<(), SessionError> {
        self.world.begin()
    }

    fn sensed(&mut self) -> StateSensed {
        self.world.sensed()
    }

    fn loses_command(&mut self) -> bool {
        self.world.run.as_mut().is_some_and(|run| run.run.loses_torque())
    }

    fn step(&mut self, torque: &[f64; JOINTS]) {
        self.world.step(torque);
    }

    fn is_over(&self) -> bool {
        self.failure.is_some() || self.world.is_over()
    }

    fn ended(&mut self, ending: Ending, packets: Packets) -> Result<(), SessionError> {
        // One record after the other.
        self.hear(true);
        if self.failure.is_none() {
            self.world.ended(ending, packets);
        }
        Ok(())
    }

    fn is_done(&mut self) -> bool {
        self.hear(false);
        self.failure.is_some() || self.world.done && !self.world.writing
    }

    fn told(&mut self, event: Event) {
        self.watch.event(event);
    }
}

impl From<FciError> for SessionError {
    fn from(why: FciError) -> Self {
        Self::other(why)
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;
    use std::fs;

    use phihat_sim::BLOCK;

    use super::*;
    use crate::page::write_report;

    /// A Panda that holds its own weight, for two blocks and some.
    const STUDY: &str = r#"
duration_s = 9.0
[robot]
name = "panda"
[profile]
name = "franka"
[spec]
settle_s = 1.0
[gains]
order = 1
bandwidth_rad_s = 20.0
estimator_bandwidth_rad_s = 50.0
inertia_kg_m2 = [1.78, 2.22, 1.02, 1.28, 0.247, 0.259, 0.212]
[loop]
rate_hz = 1000.0
[world]
friction = "robot"
[reference]
kind = "sines"
center = "ready"
[[reference.sine]]
amplitude_rad = 0.1
frequency_hz = 0.5
"#;

    struct Looks(Vec<ServedMotion>);

    impl ServeWatch for Looks {
        fn event(&mut self, _: Event) {}
        fn motion(&mut self, motion: &ServedMotion) {
            let ServedMotion { ending, cycles, packets, .. } = *motion;
            self.0.push(ServedMotion { ending, cycles, packets, record: None });
        }
    }

    fn torque(k: u64) -> [f64; JOINTS] {
        core::array::from_fn(|joint| 0.2 * (1e-2 * k as f64 + joint as f64).sin())
    }

    fn files_of(folder: &Path) -> BTreeMap<String, Vec<u8>> {
        let text = |path: &Path| path.file_name().unwrap().to_string_lossy().into_owned();
        let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
        let files = entries.filter(|path| path.is_file());
        files.map(|path| (text(&path), fs::read(&path).unwrap())).collect()
    }

    /// Wrong if a byte of the record differed from that of a run that is stored as a whole, or if more than a
    /// block stayed in memory.
    #[test]
    fn a_record_that_is_written_as_it_comes_is_that_of_the_whole() {
        let folder = std::env::temp_dir().join(format!("phihat-served-{}", std::process::id()));
        let path = folder.join("study.toml");
        fs::create_dir_all(&folder).unwrap();
        fs::write(&path, STUDY).unwrap();
        let study = design::read(&path).unwrap();
        for kind in TraceKind::ALL {
            let [streamed, whole] = ["streamed", "whole"].map(|name| folder.join(name));
            let place = (streamed.clone(), kind, true);
            let mut world = ServedWorld::new(study.clone(), &path, place, None).unwrap();
            let command = world.command.clone();
            let mut looks = Looks(Vec::new());
            let mut watched = Watched { world: &mut world, watch: &mut looks, failure: None };
            watched.begin().unwrap();
            let mut run = OutsideRun::served(study.clone(), &path, command).unwrap();
            for k in 0..9_000 {
                watched.step(&torque(k));
                run.run.step(&torque(k)).unwrap();
                assert!(watched.world.run.as_ref().unwrap().run.trace().len() < BLOCK, "{k}");
            }
            assert!(watched.is_over() && !watched.is_done());
            watched.ended(Ending::Over, Packets::default()).unwrap();
            watched.hear(true);
            assert!(watched.failure.is_none(), "{:?}", watched.failure);
            let [ServedMotion { cycles: 9_000, .. }] = looks.0[..] else { panic!("{:?}", looks.0) };
            let (done, trace) = run.stop(None, Vec::new());
            assert_eq!(trace.len(), 9_000);
            done.write(&trace, &whole, kind).unwrap();
            write_report(&done.record(), &whole.join("report.html")).unwrap();
            for part in ["", "figures"] {
                let [streamed, whole] = [&streamed, &whole].map(|at| files_of(&at.join(part)));
                assert!(streamed.len() > 2 && streamed.keys().eq(whole.keys()));
                for (name, bytes) in &whole {
                    assert!(streamed[name] == *bytes, "{kind:?}: {name}");
                }
            }
        }
        fs::remove_dir_all(folder).unwrap();
    }

    /// Wrong if a motion whose record cannot be written went on as if it could, or if nobody were told.
    #[test]
    fn a_disk_that_takes_nothing_ends_the_motion_with_its_reason() {
        let folder = std::env::temp_dir().join(format!("phihat-unserved-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        let path = folder.join("study.toml");
        fs::write(&path, STUDY).unwrap();
        let study = design::read(&path).unwrap();
        // A file stands where the folder of the record has to be.
        let place = (path.clone(), TraceKind::Parquet, true);
        let mut world = ServedWorld::new(study, &path, place, None).unwrap();
        let mut looks = Looks(Vec::new());
        let mut watched = Watched { world: &mut world, watch: &mut looks, failure: None };
        watched.begin().unwrap();
        for k in 0..2 * BLOCK as u64 {
            watched.step(&torque(k));
        }
        let mut looks_left = 60_000;
        while !watched.is_done() && looks_left > 0 {
            std::thread::sleep(std::time::Duration::from_millis(1));
            looks_left -= 1;
        }
        assert!(looks_left > 0 && watched.is_over(), "nobody was told");
        let why = watched.failure.unwrap().to_string();
        assert!(why.contains("study.toml"), "{why}");
        assert!(looks.0.is_empty());
        fs::remove_dir_all(folder).unwrap();
    }
}
