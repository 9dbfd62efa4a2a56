//! Result of a run as a row of fixed width, and the file of all rows, which NumPy reads.

use phihat_sim::{Ended, Metrics};

/// End of a run of a sweep, as in the column `ended`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum SweepEnd {
    /// It ran to its end.
    Whole = 0,
    /// The arm left every plausible state.
    Diverged = 1,
    /// The robot's interface stopped it.
    Stopped = 2,
    /// Its study could not be run.
    Refused = 3,
    /// The program panicked: a fault of this program.
    Panicked = 4,
}

impl SweepEnd {
    /// All, in the order of their numbers.
    pub const ALL: [Self; 5] =
        [Self::Whole, Self::Diverged, Self::Stopped, Self::Refused, Self::Panicked];

    /// End of a run that began.
    pub fn of(ended: &Ended) -> Self {
        match ended {
            Ended { divergence: Some(_), .. } => Self::Diverged,
            Ended { abort: Some(_), .. } => Self::Stopped,
            _ => Self::Whole,
        }
    }

    /// In a word.
    pub fn word(self) -> &'static str {
        match self {
            Self::Whole => "whole",
            Self::Diverged => "diverged",
            Self::Stopped => "stopped",
            Self::Refused => "refused",
            Self::Panicked => "panicked",
        }
    }

    /// Returns true if the run began, and so has figures.
    pub fn ran(self) -> bool {
        matches!(self, Self::Whole | Self::Diverged | Self::Stopped)
    }
}

/// A figure of every run: the largest of all joints.
#[derive(Debug)]
pub struct FigureKind {
    /// Its name, the unit included.
    pub name: &'static str,
    /// Description.
    pub what: &'static str,
    /// Its unit as people write it.
    pub unit: &'static str,
    of: fn(&Metrics) -> f64,
}

/// The figures of every run; a figure of a joint that slides is in metres and newtons.
pub static FIGURES: [FigureKind; 10] = [
    FigureKind {
        name: "error_steady_max_rad",
        what: "largest |e| after settling",
        unit: "rad",
        of: |m| worst(m, |j| Some(j.error_steady_max_rad)),
    },
    FigureKind {
        name: "error_over_spec",
        what: "largest |e| over its bound: up to 1 it is kept",
        unit: "",
        of: |m| worst(m, |j| j.error_bound_rad.map(|bound| j.error_steady_max_rad / bound)),
    },
    FigureKind {
        name: "error_rms_rad",
        what: "root mean square of e after settling",
        unit: "rad",
        of: |m| worst(m, |j| Some(j.error_rms_rad)),
    },
    FigureKind {
        name: "error_peak_rad",
        what: "largest |e| of the whole run",
        unit: "rad",
        of: |m| worst(m, |j| Some(j.error_peak_rad)),
    },
    FigureKind {
        name: "velocity_error_steady_max_rad_s",
        what: "largest velocity error after settling",
        unit: "rad/s",
        of: |m| worst(m, |j| Some(j.velocity_error_steady_max_rad_s)),
    },
    FigureKind {
        name: "tip_error_steady_max_m",
        what: "largest error of the tip after settling",
        unit: "m",
        of: |m| m.tip.as_ref().map_or(f64::NAN, |tip| tip.error_steady_max_m),
    },
    FigureKind {
        name: "tau_over_limit",
        what: "largest torque over its limit",
        unit: "",
        of: |m| worst(m, |j| j.tau_limit_nm.map(|limit| j.tau_max_nm / limit)),
    },
    FigureKind {
        name: "tau_step_max_nm",
        what: "largest change of the commanded torque per sample",
        unit: "N·m",
        of: |m| worst(m, |j| Some(j.tau_step_max_nm)),
    },
    FigureKind {
        name: "limited_steady_share",
        what: "share of the commands after settling that met a limit",
        unit: "",
        of: |m| m.limited_steady_share,
    },
    FigureKind {
        name: "phi_error_steady_max_nm",
        what: "largest error of the estimate of φ after settling",
        unit: "N·m",
        of: |m| worst(m, |j| Some(j.phi_error_steady_max_nm)),
    },
];

/// The largest of all joints that have the figure; no number where one is none, or none has it.
fn worst(metrics: &Metrics, of: impl Fn(&phihat_sim::JointMetrics) -> Option<f64>) -> f64 {
    let all = metrics.joints.iter().filter_map(of);
    let larger = |most: f64, x: f64| if most.is_nan() || x <= most { most } else { x };
    all.reduce(larger).unwrap_or(f64::NAN)
}

/// A row.
#[derive(Debug, Clone, PartialEq)]
pub struct SweepRow {
    /// The run's place in the sweep.
    pub run: u64,
    /// The seed of its study.
    pub seed: u64,
    /// Values of the numbers that varied, in the order in which they were requested.
    pub values: Vec<f64>,
    /// End of the run.
    pub end: SweepEnd,
    /// True if every bound of the study was satisfied to the end.
    pub within_spec: bool,
    /// [`FIGURES`], then the largest |e| after `settle_s` of each joint; infinite if the run did not reach
    /// its end, NaN if it did not begin.
    pub figures: Vec<f64>,
}

impl SweepRow {
    /// Of a run with these figures.
    pub(crate) fn of(at: (u64, u64, Vec<f64>), metrics: &Metrics, ended: &Ended) -> Self {
        let end = SweepEnd::of(ended);
        let whole = end == SweepEnd::Whole;
        let joints = metrics.joints.iter().map(|joint| joint.error_steady_max_rad);
        let all = FIGURES.iter().map(|figure| (figure.of)(metrics)).chain(joints);
        // What a run would have come to that ended early is worse than any number.
        let told = |x: f64| if whole || x.is_nan() { x } else { f64::INFINITY };
        let (run, seed, values) = at;
        let within_spec = whole && metrics.within_spec;
        Self { run, seed, values, end, within_spec, figures: all.map(told).collect() }
    }

    /// Of a run that could not be.
    pub(crate) fn none(at: (u64, u64, Vec<f64>), end: SweepEnd, joints: usize) -> Self {
        let (run, seed, values) = at;
        let figures = vec![f64::NAN; FIGURES.len() + joints];
        Self { run, seed, values, end, within_spec: false, figures }
    }

    /// The row's bytes, appended.
    pub(crate) fn write(&self, out: &mut Vec<u8>) {
        out.extend(self.run.to_le_bytes());
        out.extend(self.seed.to_le_bytes());
        self.values.iter().for_each(|value| out.extend(value.to_le_bytes()));
        out.extend([self.end as u8, u8::from(self.within_spec)]);
        self.figures.iter().for_each(|value| out.extend(value.to_le_bytes()));
    }
}

/// The columns of a file of rows.
#[derive(Debug, Clone, PartialEq)]
pub struct SweepColumns {
    varied: Vec<String>,
    joints: Vec<String>,
}

impl SweepColumns {
    /// Of a sweep over these numbers of an arm with these joints.
    pub fn new(varied: Vec<String>, joints: Vec<String>) -> Self {
        Self { varied, joints }
    }

    /// Numbers that vary.
    pub fn varied(&self) -> &[String] {
        &self.varied
    }

    /// Joints.
    pub fn joints(&self) -> &[String] {
        &self.joints
    }

    /// Bytes of a row.
    pub fn width(&self) -> usize {
        8 + 8 + 8 * self.varied.len() + 2 + 8 * (FIGURES.len() + self.joints.len())
    }

    /// Every column: its name, and its type as NumPy has it.
    pub fn all(&self) -> Vec<(String, &'static str)> {
        let mut all = vec![("run".to_owned(), "<u8"), ("seed".to_owned(), "<u8")];
        all.extend(self.varied.iter().map(|name| (name.clone(), "<f8")));
        all.extend([("ended".to_owned(), "|u1"), ("within_spec".to_owned(), "|b1")]);
        all.extend(FIGURES.iter().map(|figure| (figure.name.to_owned(), "<f8")));
        let joint = |name: &String| (format!("error_steady_max_rad.{name}"), "<f8");
        all.extend(self.joints.iter().map(joint));
        all
    }

    /// The head of a NumPy file (format 2.0) of so many rows, as long as it is for any other number of them.
    pub fn head(&self, rows: u64) -> Vec<u8> {
        let quoted = |name: &str| name.replace('\\', "\\\\").replace('\'', "\\'");
        let all = self.all();
        let types = all.iter().map(|(name, kind)| format!("('{}', '{kind}')", quoted(name)));
        let types = types.collect::<Vec<_>>().join(", ");
        let mut text =
            format!("{{'descr': [{types}], 'fortran_order': False, 'shape': ({rows},), }}");
        // Room for the longest number, then up to a multiple of 64, a line feed last.
        let room = text.len() - rows.to_string().len() + 20 + 12 + 1;
        let length = room.next_multiple_of(64) - 12;
        while text.len() + 1 < length {
            text.push(' ');
        }
        text.push('\n');
        let mut head = b"\x93NUMPY\x02\x00".to_vec();
        head.extend(u32::try_from(text.len()).unwrap_or(u32::MAX).to_le_bytes());
        head.extend(text.bytes());
        head
    }

    /// A row from its bytes; `None` where they are too few or say an end that there is not.
    pub fn row(&self, bytes: &[u8]) -> Option<SweepRow> {
        let mut at = 0;
        let mut eight = || -> Option<[u8; 8]> {
            let piece = bytes.get(at..at + 8)?.try_into().ok();
            at += 8;
            piece
        };
        let run = u64::from_le_bytes(eight()?);
        let seed = u64::from_le_bytes(eight()?);
        let values = (0..self.varied.len()).map(|_| eight().map(f64::from_le_bytes));
        let values: Vec<f64> = values.collect::<Option<_>>()?;
        let flags = 16 + 8 * self.varied.len();
        let (end, within) = (*bytes.get(flags)?, *bytes.get(flags + 1)?);
        let rest = bytes.get(flags + 2..self.width())?;
        let number = |piece: &[u8]| piece.try_into().ok().map(f64::from_le_bytes);
        let figures = rest.chunks_exact(8).map(number).collect::<Option<_>>()?;
        let end = *SweepEnd::ALL.get(usize::from(end))?;
        Some(SweepRow { run, seed, values, end, within_spec: within != 0, figures })
    }
}

#[cfg(test)]
mod tests {
    use super::{FIGURES, SweepColumns, SweepEnd, SweepRow};

    #[test]
    fn a_row_is_read_back_to_the_same_bits_behind_a_head_of_one_length() {
        let columns =
            SweepColumns::new(vec!["a.b[0]".to_owned()], vec!["j'1".to_owned(), "j2".to_owned()]);
        let row = SweepRow {
            run: 7,
            seed: 1 << 52,
            values: vec![0.1],
            end: SweepEnd::Stopped,
            within_spec: false,
            figures: (0..FIGURES.len() + 2).map(|i| i as f64 / 3.0).collect(),
        };
        let mut bytes = Vec::new();
        row.write(&mut bytes);
        assert_eq!(bytes.len(), columns.width());
        assert_eq!(columns.row(&bytes), Some(row));
        assert_eq!(columns.row(&bytes[1..]), None);
        let lengths: Vec<_> = [0, 9, 10, u64::MAX].map(|n| columns.head(n).len()).to_vec();
        assert!(lengths.iter().all(|n| *n == lengths[0] && n % 64 == 0), "{lengths:?}");
    }
}
