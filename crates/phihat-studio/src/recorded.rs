//! A run that was recorded, played again: the record of `phihat run` or `phihat drive`, or a log of joint states.

use std::collections::BTreeMap;
use std::path::Path;

use mcap::MessageStream;
use phihat_sim::Trace;
use phihat_study::Study;

use crate::error::StudioError;
use crate::sampled::Sampled;

/// Topics of a log, and what of them is shown: which of position, velocity and effort, and of what.
const TOPICS: [(&str, usize, SampledColumn); 5] = [
    ("/joint_states", 0, |joint| &mut joint.q),
    ("/phihat/reference", 0, |joint| &mut joint.q_d),
    ("/phihat/error", 0, |joint| &mut joint.e),
    ("/phihat/torque_command", 2, |joint| &mut joint.tau),
    ("/phihat/phi_hat", 2, |joint| &mut joint.phi_hat),
];

type SampledColumn = fn(&mut Sampled) -> &mut f64;

/// Values in messages, by their times \[ns\]: the topic, and a value for each joint that it names.
type MessageValues = BTreeMap<u64, Vec<(usize, Vec<Option<f64>>)>>;

/// A run of the past.
#[derive(Debug, Default)]
pub(crate) struct Recorded {
    /// Times \[s\] since its begin.
    t: Vec<f64>,
    /// A row per joint, sample after sample.
    rows: Vec<Sampled>,
    joints: usize,
    /// The sample that comes next.
    k: usize,
}

impl Recorded {
    pub(crate) fn of_trace(trace: &Trace) -> Self {
        let rows = (0..trace.len()).flat_map(|k| {
            trace.joints.iter().map(move |joint| Sampled {
                q: joint.q[k],
                q_d: joint.q_desired[k],
                e: joint.e[k],
                tau: joint.tau_command[k],
                phi_hat: joint.phi_hat[k],
            })
        });
        Self {
            t: trace.t_ns.iter().map(|t_ns| *t_ns as f64 * 1e-9).collect(),
            rows: rows.collect(),
            joints: trace.joints.len(),
            k: 0,
        }
    }

    /// A log (MCAP, CDR) with `/joint_states` that name the arm's joints; other topics that phihat writes into a log
    /// are read where they are there. A value that is missing is 0.
    pub(crate) fn of_log(path: &Path, study: &Study) -> Result<Self, StudioError> {
        let told = |why: String| StudioError::refused(format!("{}: {why}", path.display()));
        let bytes = std::fs::read(path).map_err(|why| told(why.to_string()))?;
        let names: Vec<&str> = study.robot.joints.iter().map(|joint| joint.name.as_str()).collect();
        let mut told_at = MessageValues::new();
        for message in MessageStream::new(&bytes).map_err(|why| told(why.to_string()))? {
            let message = message.map_err(|why| told(why.to_string()))?;
            let topic = TOPICS.iter().position(|(topic, ..)| *topic == message.channel.topic);
            let Some(topic) = topic else { continue };
            let (name, which, _) = TOPICS[topic];
            let state = RecordedJointState::read(&message.data)
                .ok_or_else(|| told(format!("a message of {name} is no JointState in CDR")))?;
            let of = |name: &&str| {
                let place = state.names.iter().position(|known| known == name)?;
                state.values[which].get(place).copied()
            };
            let values: Vec<_> = names.iter().map(of).collect();
            // A gripper's, say.
            if values.iter().any(Option::is_some) {
                told_at.entry(message.log_time).or_default().push((topic, values));
            }
        }
        let whole = Self::together(told_at, names.len());
        if whole.t.is_empty() {
            let why = format!("has no /joint_states of the joints {}", names.join(", "));
            return Err(told(why));
        }
        Ok(whole)
    }

    /// Samples at the times of positions, with the last reported value of every other topic; before the first desired
    /// position, the measured one in its place.
    fn together(told_at: MessageValues, joints: usize) -> Self {
        let mut whole = Self { joints, ..Self::default() };
        let (mut now, mut referred) = (vec![Sampled::default(); joints], false);
        let mut first = None;
        for (t_ns, messages) in told_at {
            for (topic, values) in &messages {
                referred |= *topic == 1;
                for (row, value) in now.iter_mut().zip(values) {
                    if let Some(value) = value {
                        *TOPICS[*topic].2(row) = *value;
                    }
                }
            }
            if messages.iter().any(|(topic, _)| *topic == 0) {
                if !referred {
                    for row in &mut now {
                        row.q_d = row.q;
                    }
                }
                let first = *first.get_or_insert(t_ns);
                whole.t.push((t_ns - first) as f64 * 1e-9);
                whole.rows.extend_from_slice(&now);
            }
        }
        whole
    }

    pub(crate) fn joints(&self) -> usize {
        self.joints
    }

    /// Its length \[s\].
    pub(crate) fn length(&self) -> f64 {
        self.t.last().copied().unwrap_or(0.0)
    }

    /// Time of the next sample \[s\].
    pub(crate) fn time(&self) -> f64 {
        self.t.get(self.k).copied().unwrap_or_else(|| self.length())
    }

    pub(crate) fn step(&mut self) -> Option<&[Sampled]> {
        let rows = self.rows.get(self.k * self.joints..(self.k + 1) * self.joints)?;
        self.k += 1;
        Some(rows)
    }

    /// To the first sample at a time \[s\] or after it, to a nanosecond.
    pub(crate) fn seek(&mut self, t: f64) {
        self.k = self.t.partition_point(|at| *at < t - 1e-9).min(self.t.len().saturating_sub(1));
    }

    /// Desired positions at some hundred times, to draw a path from.
    pub(crate) fn path(&self) -> (Vec<f64>, Vec<Vec<f64>>) {
        let stride = self.t.len().div_ceil(400).max(1);
        let some = (0..self.t.len()).step_by(stride);
        let wanted = |k: usize| {
            self.rows[k * self.joints..(k + 1) * self.joints].iter().map(|row| row.q_d).collect()
        };
        some.map(|k| (self.t[k], wanted(k))).unzip()
    }
}

/// `sensor_msgs/msg/JointState`.
struct RecordedJointState {
    names: Vec<String>,
    /// Position, velocity, effort.
    values: [Vec<f64>; 3],
}

impl RecordedJointState {
    /// Of XCDR1, little-endian; `None`: it is not, or ends too early.
    fn read(message: &[u8]) -> Option<Self> {
        let (head, body) = message.split_first_chunk::<4>()?;
        if head[..2] != [0, 1] {
            return None;
        }
        let mut from = CdrReader { body, at: 0 };
        // The stamp, and the frame's name.
        from.take::<4>()?;
        from.take::<4>()?;
        from.string()?;
        let count = from.count()?;
        let names = (0..count).map(|_| from.string()).collect::<Option<_>>()?;
        let mut numbers = || {
            let count = from.count()?;
            (0..count).map(|_| from.take().map(f64::from_le_bytes)).collect::<Option<_>>()
        };
        Some(Self { names, values: [numbers()?, numbers()?, numbers()?] })
    }
}

struct CdrReader<'a> {
    body: &'a [u8],
    at: usize,
}

impl CdrReader<'_> {
    /// The next number of so many bytes, at a multiple of its size.
    fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let at = self.at.checked_next_multiple_of(N)?;
        let bytes = self.body.get(at..)?.first_chunk::<N>()?;
        self.at = at + N;
        Some(*bytes)
    }

    /// A length that what is left can hold.
    fn count(&mut self) -> Option<usize> {
        let count = u32::from_le_bytes(self.take()?) as usize;
        (count <= self.body.len()).then_some(count)
    }

    fn string(&mut self) -> Option<String> {
        let size = self.count()?;
        let bytes = self.body.get(self.at..self.at.checked_add(size)?)?;
        self.at += size;
        let bytes = bytes.strip_suffix(&[0]).unwrap_or(bytes);
        String::from_utf8(bytes.to_vec()).ok()
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;
    use std::io::Cursor;
    use std::path::Path;

    use mcap::records::MessageHeader;
    use mcap::{WriteOptions, Writer};
    use phihat_study::Study;

    use super::Recorded;

    const STUDY: &str = "duration_s = 12.0\n[robot]\nname = \"planar3r\"\n[gains]\nbandwidth_rad_s = 20.0\n\
        estimator_bandwidth_rad_s = 60.0\ninertia_kg_m2 = 0.4\n[reference]\nkind = \"sines\"\n\
        center = \"ready\"\nfade_in_s = 0.3\n[[reference.sine]]\namplitude_rad = 0.3\nfrequency_hz = 0.2\n";

    /// A message as the standard lays it out.
    fn state(names: &[&str], position: &[f64], effort: &[f64]) -> Vec<u8> {
        let mut bytes = vec![0, 1, 0, 0, 7, 0, 0, 0, 9, 0, 0, 0];
        let pad = |bytes: &mut Vec<u8>, to: usize| {
            while !(bytes.len() - 4).is_multiple_of(to) {
                bytes.push(0);
            }
        };
        let string = |bytes: &mut Vec<u8>, text: &str| {
            pad(bytes, 4);
            bytes.extend(u32::try_from(text.len() + 1).unwrap().to_le_bytes());
            bytes.extend(text.bytes().chain([0]));
        };
        string(&mut bytes, "base");
        pad(&mut bytes, 4);
        bytes.extend(u32::try_from(names.len()).unwrap().to_le_bytes());
        for name in names {
            string(&mut bytes, name);
        }
        for numbers in [position, &[], effort] {
            pad(&mut bytes, 4);
            bytes.extend(u32::try_from(numbers.len()).unwrap().to_le_bytes());
            for number in numbers {
                pad(&mut bytes, 8);
                bytes.extend(number.to_le_bytes());
            }
        }
        bytes
    }

    fn log(name: &str, messages: &[(&str, u64, Vec<u8>)]) -> std::path::PathBuf {
        let options = WriteOptions::new().compression(None);
        let mut file: Writer<_> = options.create(Cursor::new(Vec::new())).unwrap();
        let schema = file.add_schema("sensor_msgs/msg/JointState", "ros2msg", b"").unwrap();
        for (sequence, (topic, log_time, data)) in (1..).zip(messages) {
            let channel_id = file.add_channel(schema, topic, "cdr", &BTreeMap::new()).unwrap();
            let header = MessageHeader {
                channel_id,
                sequence,
                log_time: *log_time,
                publish_time: *log_time,
            };
            file.write_to_known_channel(&header, data).unwrap();
        }
        file.finish().unwrap();
        let path = std::env::temp_dir().join(format!("phihat-{}-{name}.mcap", std::process::id()));
        std::fs::write(&path, file.into_inner().into_inner()).unwrap();
        path
    }

    fn read(name: &str, messages: &[(&str, u64, Vec<u8>)]) -> Result<Recorded, String> {
        let path = log(name, messages);
        let study = Study::from_text(STUDY, "log.toml", Path::new(".")).unwrap();
        let found = Recorded::of_log(&path, &study).map_err(|why| why.to_string());
        std::fs::remove_file(path).unwrap();
        found
    }

    #[test]
    fn a_log_is_played_by_the_names_in_its_messages() {
        let order = ["joint3", "joint1", "joint2"];
        let mut run = read(
            "names",
            &[
                ("/joint_states", 5_000_000_000, state(&order, &[0.3, 0.1, 0.2], &[])),
                ("/joint_states", 5_001_000_000, state(&["finger"], &[0.04], &[])),
                ("/phihat/reference", 5_002_000_000, state(&order, &[1.3, 1.1, 1.2], &[])),
                ("/phihat/torque_command", 5_002_000_000, state(&order, &[], &[33.0, 11.0, 22.0])),
                ("/joint_states", 5_002_000_000, state(&order, &[0.6, 0.4, 0.5], &[])),
            ],
        )
        .unwrap();
        assert!((run.length() - 2e-3).abs() < 1e-12);
        let first: Vec<_> = run.step().unwrap().iter().map(|row| [row.q, row.q_d]).collect();
        assert_eq!(first, [[0.1, 0.1], [0.2, 0.2], [0.3, 0.3]]);
        let next: Vec<_> =
            run.step().unwrap().iter().map(|row| [row.q, row.q_d, row.tau]).collect();
        assert_eq!(next, [[0.4, 1.1, 11.0], [0.5, 1.2, 22.0], [0.6, 1.3, 33.0]]);
        assert!(run.step().is_none());
        run.seek(1.5e-3);
        assert_eq!(run.time().to_bits(), run.length().to_bits());
    }

    #[test]
    fn a_log_of_nothing_that_can_be_played_is_refused() {
        let whole = state(&["joint1", "joint2", "joint3"], &[0.1, 0.2, 0.3], &[]);
        let no = |name: &str, data: Vec<u8>| read(name, &[("/joint_states", 1, data)]).unwrap_err();
        for end in 0..whole.len() - 4 {
            no("short", whole[..end].to_vec());
        }
        let mut huge = whole.clone();
        huge[12..16].copy_from_slice(&[0xff; 4]);
        assert!(no("huge", huge).contains("no JointState"));
        assert!(no("others", state(&["elbow"], &[0.1], &[])).contains("joint1, joint2, joint3"));
        assert!(read("nothing", &[]).unwrap_err().contains("no /joint_states"));
    }
}
