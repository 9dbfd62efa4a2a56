//! Reading a study: caps before parsing, two passes after it.

use std::io::{ErrorKind, Read as _};
use std::path::{Path, PathBuf};

use phihat_model::{NamedTexts, input};
use sha2::{Digest, Sha256};
use toml::de::DeTable;

use crate::arm::StudyArm;
use crate::base::Base;
use crate::check::check_table;
use crate::error::{StudyError, StudyErrorKind as Kind, TextPlace};
use crate::found::StudyErrors;
use crate::keys::STUDY;
use crate::node::Node;
use crate::run::ReferenceRun;
use crate::source::Source;
use crate::study::{Interface, MotionClass, ReferenceRequest, Sensor, Study};
use crate::supervisor::SupervisorRequest;
use crate::{
    contact, control, design, fault, feedforward, gains, profile, reference, renamed, spec,
    supervisor, world,
};

/// Largest study \[byte\].
const BYTES_MAX: usize = 1 << 20;
/// Keys and headers at most.
const KEYS_MAX: usize = 10_000;
/// Brackets, braces, commas, dots and equals signs at most: they bound the parser's memory.
const MARKS_MAX: usize = 250_000;

impl Study {
    /// Reads a study; files it names are relative to its own directory.
    ///
    /// # Errors
    ///
    /// The first thing that is wrong, with its place.
    pub fn read(path: &Path) -> Result<Self, StudyError> {
        let (text, origin) = text_of(path)?;
        Self::from_text(&text, &origin, path.parent().unwrap_or(Path::new("")))
    }

    /// Reads a study, and goes on after an error, so that all errors can be corrected at once.
    ///
    /// Errors that only follow from another one are left out: where a robot cannot be read, no errors of
    /// values per joint are reported.
    ///
    /// # Errors
    ///
    /// All errors, up to 100, in the order of the file.
    pub fn check(path: &Path) -> Result<Self, Vec<StudyError>> {
        let (text, origin) = text_of(path).map_err(|error| vec![error])?;
        Self::check_text(&text, &origin, path.parent().unwrap_or(Path::new("")))
    }

    /// As [`check`](Self::check), from text, as [`from_text`](Self::from_text) takes it.
    ///
    /// # Errors
    ///
    /// As [`check`](Self::check).
    pub fn check_text(text: &str, origin: &str, base: &Path) -> Result<Self, Vec<StudyError>> {
        Self::check_texts(text, origin, (base, &NamedTexts::DISK))
    }

    /// As [`check`](Self::check), from text, as [`from_texts`](Self::from_texts) takes it.
    ///
    /// # Errors
    ///
    /// As [`check`](Self::check).
    pub fn check_texts(
        text: &str,
        origin: &str,
        (folder, files): (&Path, &NamedTexts),
    ) -> Result<Self, Vec<StudyError>> {
        let found = StudyErrors::all();
        let source = Source { text, origin, found: &found };
        let read = read_text(source, Base { folder, files, flat: false });
        match (read, found) {
            (Ok(study), found) if found.is_clean("") => Ok(study),
            (read, found) => Err(found.into_errors(read.err(), origin)),
        }
    }

    /// Reads a study from text.
    ///
    /// `origin` stands for the file in messages, and its stem is the study's name; files that the
    /// study names are relative to `base`.
    ///
    /// # Errors
    ///
    /// The first thing that is wrong, with its place.
    pub fn from_text(text: &str, origin: &str, base: &Path) -> Result<Self, StudyError> {
        Self::from_texts(text, origin, (base, &NamedTexts::DISK))
    }

    /// As [`from_text`](Self::from_text), with the files that the study names from wherever they are.
    ///
    /// # Errors
    ///
    /// The first thing that is wrong, with its place.
    pub fn from_texts(
        text: &str,
        origin: &str,
        (folder, files): (&Path, &NamedTexts),
    ) -> Result<Self, StudyError> {
        first_error(text, origin, Base { folder, files, flat: false })
    }

    /// Reads the study of a record, whose [`inputs`](Self::inputs) are in a folder under the names that they
    /// have there.
    ///
    /// # Errors
    ///
    /// The first thing that is wrong, with its place.
    pub fn from_record(text: &str, origin: &str, inputs: &Path) -> Result<Self, StudyError> {
        let files = &NamedTexts::DISK;
        first_error(text, origin, Base { folder: inputs, files, flat: true })
    }
}

fn first_error(text: &str, origin: &str, base: Base<'_>) -> Result<Study, StudyError> {
    let found = StudyErrors::first();
    read_text(Source { text, origin, found: &found }, base)
}

/// The text of a study's file, and what the file is called.
fn text_of(path: &Path) -> Result<(String, String), StudyError> {
    let origin = path.display().to_string();
    let refuse = |kind, why: String, help: &str| {
        StudyError::new(kind, TextPlace::whole_file(&origin), "", why).with_help(help)
    };
    let text = input::text(path, BYTES_MAX as u64).map_err(|error| match error.kind() {
        ErrorKind::FileTooLarge => {
            refuse(Kind::TooLarge, format!("larger than {BYTES_MAX} bytes"), "")
        }
        ErrorKind::InvalidData => {
            let why = if is_utf16(path) { "UTF-16, not UTF-8 text" } else { "not UTF-8 text" };
            refuse(Kind::Syntax, why.to_owned(), "save it as UTF-8")
        }
        _ => {
            let why = format!("the study cannot be read: {error}");
            refuse(Kind::Unreadable, why, "a study is a TOML file, such as studies/first.toml")
        }
    })?;
    let other = match text.trim_start_matches('\u{feff}').trim_start().chars().next() {
        Some('<') => {
            Some(("XML, such as a URDF or MJCF, not a study", "name it in one: `file` in [robot]"))
        }
        Some('{') => Some(("JSON, not a study", "gains are given beside one: --gains FILE")),
        None => Some(("is empty", "begin with a copy of studies/first.toml")),
        _ => None,
    };
    match other {
        Some((why, help)) => Err(refuse(Kind::Syntax, why.to_owned(), help)),
        None => Ok((text, origin)),
    }
}

/// Returns true if a file begins as UTF-16 text does.
fn is_utf16(path: &Path) -> bool {
    let mut mark = [0; 2];
    let read = input::open(path).and_then(|mut file| file.read_exact(&mut mark));
    read.is_ok() && (mark == [0xff, 0xfe] || mark == [0xfe, 0xff])
}

fn read_text(source: Source<'_>, base: Base<'_>) -> Result<Study, StudyError> {
    let found = source.found;
    let name = found.keep(study_name(source.origin))?.unwrap_or_default();
    check_size(&source)?;
    // What stands behind text that is not TOML is not known.
    let mut document = DeTable::parse(source.text).map_err(|error| syntax(&source, &error))?;
    let renamed = renamed::rename(&source, document.get_mut())?;
    check_table(&source, &STUDY, "", &(0..0), document.get_ref())?;
    found.first_pass_ends();
    let study = resolve(&Node::top(source, &STUDY, document.get_ref()), name, base)?;
    Ok(Study { renamed, ..study })
}

/// The robot's files and the reference's: what they are called in a record, and where they are.
fn inputs(
    top: &Node<'_>,
    arm: &StudyArm,
    base: Base<'_>,
) -> Result<Vec<(PathBuf, PathBuf)>, StudyError> {
    let robot = &arm.robot.files;
    let beside = robot.first().and_then(|named| named.parent()).unwrap_or(Path::new(""));
    let mut inputs: Vec<_> = robot
        .iter()
        .map(|path| (path.strip_prefix(beside).unwrap_or(path).to_owned(), path.clone()))
        .collect();
    let reference = top.child("reference");
    if reference.word("kind")? == "csv" {
        let path = base.join(reference.word("file")?);
        inputs.push((path.file_name().map(PathBuf::from).unwrap_or_default(), path));
    }
    Ok(inputs)
}

/// The second pass: everything that needs the robot, or more than one key.
fn resolve(top: &Node<'_>, name: String, base: Base<'_>) -> Result<Study, StudyError> {
    let found = top.source.found;
    let duration = found.keep(top.number("duration_s"))?;
    let rate = found.keep(top.child("loop").number("rate_hz"))?;
    let period = duration.zip(rate).map(|run| control::period_ns(top, run));
    let period_ns = period.map_or(Ok(None), |period| found.keep(period))?;
    let arm = StudyArm::read(top, base)?;
    // Where there are none, no time is beyond the end, and no frequency above half of the rate.
    let [duration, rate] = [duration, rate].map(|known| known.unwrap_or(f64::INFINITY));
    let gains = found.keep(stated_gains(top, &arm, rate))?.flatten();
    let sensor = found.keep(sensor(top, &arm, rate, gains.is_some()))?;
    let given = (period_ns.unwrap_or_default(), gains.is_some());
    let control = found.keep(control::read(&top.child("loop"), &arm, given))?;
    let world = found.keep(world::read(top, &arm, duration))?;
    let (Some(control), Some(world)) = (control, world) else { return Err(found.last()) };
    found.keep(control::fits(&control, gains.as_ref(), top))?;
    found.keep(searched_for(top, (gains.is_some(), control.form)))?;
    let interface = found.keep(interface(top, &arm, (rate, world.held.is_some())))?;
    let spec = found.keep(spec::read(&top.child("spec"), &arm.joints, duration))?;
    let design = found.keep(design::read(&top.child("design"), (&arm, &world), base))?;
    let feedforward = found.keep(feedforward::read(top, &arm, &control))?;
    let supervisor = found.keep(guarded(top, &arm, (duration, control.form)))?;
    let faults = fault::read(top, &arm, duration)?;
    // Along a run of no known length there is nothing to look at.
    let seed = top.count("seed")?;
    let run = period_ns.map(|_| ReferenceRun { duration, rate, seed, base });
    let reference = run.map_or(Ok(None), |run| motion(top, &arm, run))?;
    let (
        Some(sensor),
        Some(interface),
        Some(spec),
        Some(design),
        Some(feedforward),
        Some(supervisor),
        Some(reference),
    ) = (sensor, interface, spec, design, feedforward, supervisor, reference)
    else {
        return Err(found.last());
    };
    Ok(Study {
        title: top.text("title").unwrap_or(&name).to_owned(),
        name,
        text: top.source.text.to_owned(),
        sha256: sha256(top.source.text),
        seed,
        duration,
        spec,
        gains,
        design,
        feedforward,
        contact: contact::read(top, supervisor.is_some())?,
        supervisor: of_class(supervisor, &reference),
        control,
        sensor,
        world,
        interface: Box::new(interface),
        faults,
        reference,
        inputs: inputs(top, &arm, base)?,
        renamed: Vec::new(),
        robot: arm.robot,
        springs: arm.springs,
    })
}

/// `[reference]`; `None`: it is wrong, and that is found.
fn motion(
    top: &Node<'_>,
    arm: &StudyArm,
    run: ReferenceRun<'_>,
) -> Result<Option<ReferenceRequest>, StudyError> {
    top.source.found.keep(reference::read(&top.child("reference"), arm, run))
}

/// The supervisor of a class of motions shapes references to the class.
#[inline(never)]
fn of_class(
    mut supervisor: Option<Box<SupervisorRequest>>,
    reference: &ReferenceRequest,
) -> Option<Box<SupervisorRequest>> {
    if let (Some(own), ReferenceRequest::Any { class, .. }) = (&mut supervisor, reference) {
        let MotionClass { low, high, speed, acceleration, jerk, .. } = class;
        own.motion = Some([speed.clone(), acceleration.clone(), jerk.clone()]);
        own.reference_box = Some([low.clone(), high.clone()]);
    }
    supervisor
}

/// `[supervisor]`, which takes the limits of a reference from a class of motions.
fn guarded(
    top: &Node<'_>,
    arm: &StudyArm,
    given: (f64, phihat::Form),
) -> Result<Option<Box<SupervisorRequest>>, StudyError> {
    let any = top.child("reference").word("kind")? == "any";
    supervisor::read(&top.child("supervisor"), arm, given, any)
}

/// `[profile]`, which does not say beside `[start]` with which torque the law begins.
fn interface(
    top: &Node<'_>,
    arm: &StudyArm,
    (rate, held): (f64, bool),
) -> Result<Interface, StudyError> {
    let interface = profile::read(&top.child("profile"), arm, rate)?;
    if held {
        top.source.found.keep(takes_over(top, &interface))?;
    }
    Ok(interface)
}

/// `[sensor]`, whose filter is not left to the design where the study states its gains.
fn sensor(
    top: &Node<'_>,
    arm: &StudyArm,
    rate: f64,
    has_gains: bool,
) -> Result<Sensor, StudyError> {
    let node = top.child("sensor");
    let sensor = control::read_sensor(&node, arm, rate)?;
    if sensor.velocity_filter_designed && has_gains {
        let message = "left to the design, while the study states its [gains]";
        let error = node.error(Kind::Conflict, "velocity_filter_hz", message);
        node.note(error.with_help("give a cut-off, or leave the gains to `[design]`"))?;
    }
    Ok(sensor)
}

/// Keys of `[design]` that steer a search for gains, and say nothing of gains that are there.
const SEARCH: [&str; 6] =
    ["method", "orders", "innovation_filter", "settling_time_s", "rise_time_s", "paper"];

/// Those of them that laws from positions have no clause for: their outer loop is not apart from their observer.
const TIMES: [&str; 2] = ["settling_time_s", "rise_time_s"];

/// That nothing tells a search what to look for while the gains are stated, nor what it does not look for.
fn searched_for(top: &Node<'_>, (has_gains, form): (bool, phihat::Form)) -> Result<(), StudyError> {
    let node = top.child("design");
    let timed = TIMES.into_iter().find(|key| form == phihat::Form::Positions && node.has(key));
    if let Some(key) = timed.filter(|_| !has_gains) {
        let message = "a law from positions is not designed for it";
        let help = "leave it out: when the error has settled is told with the tube, and `settle_s` in [spec] asks for \
                    it; or `form = \"observer\"` in [loop]";
        return Err(node.error(Kind::Conflict, key, message).with_help(help));
    }
    let stated = top.child("loop").text("form");
    let other = stated.is_some_and(|word| !["positions", "design"].contains(&word));
    if other && !has_gains && node.flag("innovation_filter")? {
        let message = "only a law from positions has an innovation to filter";
        let help = "leave it out, or `form = \"positions\"` in [loop]";
        return Err(node.error(Kind::Conflict, "innovation_filter", message).with_help(help));
    }
    match SEARCH.into_iter().find(|key| has_gains && node.has(key)) {
        Some(key) => {
            let message =
                "it tells a search for gains what to look for, while the study states its [gains]";
            let help = "leave out [gains] to have them found, or this key: margins, payloads and friction of [design] \
                        are what stated gains are certified for";
            Err(node.error(Kind::Conflict, key, message).with_help(help))
        }
        None => Ok(()),
    }
}

/// That nothing else says with which torque the law begins.
fn takes_over(top: &Node<'_>, interface: &Interface) -> Result<(), StudyError> {
    let refused = |message: &str, help: &str| {
        let error = top.child("start").error(Kind::Conflict, "torque_nm", message);
        Err(error.with_help(help))
    };
    if top.child("supervisor").exists() {
        return refused("a supervisor arms the law", "give `preset_nm` in `[supervisor]`");
    }
    if interface.kept && interface.profile.first_torque_max.is_some() {
        return refused(
            "the robot's interface begins with a torque of its own",
            "leave it out, or `profile.controller_keeps = false`",
        );
    }
    Ok(())
}

/// `[gains]`, unless they are left to `[design]`.
fn stated_gains(
    top: &Node<'_>,
    arm: &StudyArm,
    rate: f64,
) -> Result<Option<crate::GainsRequest>, StudyError> {
    let node = top.child("gains");
    if !node.exists() && top.child("design").exists() {
        return Ok(None);
    }
    if !node.exists() {
        let help = "state `[gains]`, or leave them to `phihat design` by a `[design]` section";
        return Err(top
            .error(Kind::MissingKey, "gains", "missing section [gains]")
            .with_help(help));
    }
    gains::read(&node, &arm.joints, rate).map(Some)
}

/// The study's name: the stem of its file.
fn study_name(origin: &str) -> Result<String, StudyError> {
    let stem = Path::new(origin).file_stem().and_then(|stem| stem.to_str()).unwrap_or_default();
    let fits = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_' || c == '-';
    if (1..=64).contains(&stem.len()) && stem.chars().all(fits) {
        return Ok(stem.to_owned());
    }
    let message = "the file's name is the study's name, and this one cannot be";
    Err(StudyError::new(Kind::UnknownName, TextPlace::whole_file(origin), "", message)
        .with_help("1 to 64 of the characters a-z, 0-9, _ and - before `.toml`"))
}

fn check_size(source: &Source<'_>) -> Result<(), StudyError> {
    let text = source.text;
    let refuse = |at: usize, message| Err(source.error(Kind::TooLarge, &(at..at), "", message));
    if text.len() > BYTES_MAX {
        return refuse(0, format!("larger than {BYTES_MAX} bytes"));
    }
    let key = text.bytes().enumerate().filter(|&(_, b)| b == b'=').nth(KEYS_MAX);
    let mark = text.bytes().enumerate().filter(|(_, b)| b"[]{}.,=".contains(b)).nth(MARKS_MAX);
    let header = text.match_indices("\n[").nth(KEYS_MAX);
    match (key, header, mark) {
        (Some((at, _)), ..) => refuse(at, format!("more than {KEYS_MAX} keys")),
        (_, Some((at, _)), _) => refuse(at + 1, format!("more than {KEYS_MAX} sections")),
        (.., Some((at, _))) => {
            refuse(at, format!("more than {MARKS_MAX} brackets, braces, commas, dots and `=`"))
        }
        _ => Ok(()),
    }
}

fn syntax(source: &Source<'_>, error: &toml::de::Error) -> StudyError {
    let span = error.span().unwrap_or(0..0);
    let slice = source.text.get(span.clone()).unwrap_or_default();
    if error.message() == "duplicate key" {
        let message = format!("duplicate key `{}`", crate::entries::clip(slice));
        return source.error(Kind::Syntax, &span, "", message).with_help("keep one of them");
    }
    let told = source.error(Kind::Syntax, &span, "", format!("not TOML: {}", error.message()));
    let place = source.place(&span);
    let Some((_, value)) = place.line_text.split_once('=') else { return told };
    let value = value.split('#').next().unwrap_or_default().trim();
    let figure = |text: &str| !text.is_empty() && text.chars().all(|c| c.is_ascii_digit());
    let shown = crate::entries::clip(value);
    let comma = value.split_once(',').is_some_and(|(one, other)| figure(one) && figure(other));
    let word = value.chars().next().is_some_and(char::is_alphabetic)
        && !value.contains(['"', '\'', '[', '{']);
    told.with_help(if comma {
        format!("`{shown}`: write a decimal point")
    } else if value.starts_with('"') && value.contains('\\') {
        format!("in {shown} a backslash begins an escape: write `/`, or put it in single quotes")
    } else if word {
        format!("`{shown}`: text stands in quotes")
    } else {
        String::new()
    })
}

fn sha256(text: &str) -> String {
    let digits = |byte: u8| [byte >> 4, byte & 15].map(|half| char::from_digit(half.into(), 16));
    Sha256::digest(text.as_bytes()).into_iter().flat_map(digits).flatten().collect()
}
