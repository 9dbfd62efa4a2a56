//! The text of a study.

use std::fmt::Write as _;

use super::motion::Sines;

/// Values in the text of a study.
pub(super) struct Words<'a> {
    pub(super) title: &'a str,
    pub(super) robot: &'a [String],
    /// Name of the torque interface, where it is no bare drive's.
    pub(super) profile: Option<&'a str>,
    /// True if the robot holds the arm against gravity, or begins with a torque of its own.
    pub(super) starts_itself: bool,
    pub(super) error: &'a [f64],
    pub(super) payload_kg: f64,
    pub(super) rate_hz: f64,
    pub(super) delay_samples: u32,
    /// True if the form of law is left to the design.
    pub(super) form_designed: bool,
    /// Encoder: `"robot"`, or bits.
    pub(super) encoder: &'a str,
    /// Torque limits where the arm's own are replaced.
    pub(super) torque: &'a [f64],
    pub(super) centre: Centre<'a>,
    pub(super) motion: &'a Sines,
}

/// The middle of the motion: a pose of the arm by its name, or a posture.
pub(super) enum Centre<'a> {
    Pose(&'a str),
    Posture(&'a [f64]),
}

/// Distance of a payload's centre of mass from the tip along each axis, and its radius of gyration \[m\].
const PAYLOAD_REACH_M: f64 = 0.1;
const PAYLOAD_GYRATION_M: f64 = 0.05;

const HEAD: &str = "# A study made by `phihat new`: a first run of this arm, to change step by step.
# `phihat run THIS FILE` designs gains, proves what can be proved, and simulates. Every key: docs/study.md.";

const ERROR: &str = "
# The error you can live with, once the arm has settled; when that is, the certificate says. This is near the least
# that can be promised for this arm, payload, loop and motion: ask for less and `phihat design` says what stands in
# its way.";

impl Words<'_> {
    /// The whole study.
    pub(super) fn text(&self) -> String {
        let mut text = String::new();
        let mut line = |words: String| {
            let _ = writeln!(text, "{words}");
        };
        line(HEAD.into());
        line(format!("title = {}", toml::Value::String(self.title.to_owned())));
        line(format!("duration_s = {:?}", self.motion.duration));
        line("seed = 1                      # everything random comes from this number".into());
        line("\n# The arm. Its own file says what a URDF leaves out: rotor inertia, friction, limits, \
            encoders.".into());
        line("[robot]".into());
        self.robot.iter().for_each(|words| line(words.clone()));
        self.write_profile(&mut text);
        let mut line = |words: String| {
            let _ = writeln!(text, "{words}");
        };
        line(ERROR.into());
        line("[spec]".into());
        line(format!("error_bound_rad = {}", numbers(self.error)));
        line("\n# What the gains must bear. No gains are stated: `phihat run` finds them.".into());
        line("[design]".into());
        self.write_payload(&mut text);
        let mut line = |words: String| {
            let _ = writeln!(text, "{words}");
        };
        line(
            "\n# The control loop: rate, and the samples from measuring to the torque that acts."
                .into(),
        );
        line("[loop]".into());
        line(format!("rate_hz = {:?}", self.rate_hz));
        line(format!("delay_samples = {}", self.delay_samples));
        let form = if self.form_designed {
            "form = \"design\"               # of law: whichever the tube says needs less torque noise"
        } else {
            "form = \"observer\"             # of law: fed with velocity and the torque that acted"
        };
        line(form.into());
        if !self.torque.is_empty() {
            line(format!("torque_max_nm = {}", numbers(self.torque)));
        }
        line("\n# What the controller sees: an encoder, and velocity from its differences, filtered as the design \
            finds best.".into());
        line("[sensor]".into());
        line(format!("encoder_bits = {}", self.encoder));
        line("velocity = \"differenced\"".into());
        line("velocity_filter_hz = \"design\"".into());
        line("\n# What the arm meets, and the controller does not know: the arm's friction, and the payload.".into());
        line("[world]".into());
        line("friction = \"robot\"".into());
        if self.payload_kg > 0.0 {
            line(format!("payload = {{ mass_kg = {:?} }}", self.payload_kg));
        }
        self.write_start(&mut text);
        self.write_reference(&mut text);
        text
    }

    /// The payload: what a hand holds.
    fn write_payload(&self, text: &mut String) {
        let mut line = |words: String| {
            let _ = writeln!(text, "{words}");
        };
        line(format!(
            "payload_max_kg = {:?}           # anything from nothing to this",
            self.payload_kg
        ));
        if self.payload_kg > 0.0 {
            let (reach, spread) = (PAYLOAD_REACH_M, PAYLOAD_GYRATION_M);
            line(format!(
                "# Its centre of mass within {:.0} cm of the tip along each axis, spread by {:.0} cm about it: \
                 assumed, as of a thing in a hand. State yours.",
                100.0 * reach,
                100.0 * spread
            ));
            let side = list(&[-reach, reach]);
            line(format!("payload_com_m = [{side}, {side}, {side}]"));
            line(format!("payload_gyration_m = {spread:?}"));
        }
    }

    /// Torque interface, where it is no bare drive's, and the supervisor that a drive needs.
    fn write_profile(&self, text: &mut String) {
        let Some(profile) = self.profile else { return };
        let _ = writeln!(
            text,
            "\n# The robot's torque interface: what it adds to a torque, and on what it stops. `phihat robots` of the \
             arm has the sources.\n\
             [profile]\nname = {profile:?}\n\n\
             # What a real arm needs around its law; `phihat drive` asks for it. A tube is about the loop without it: \
             design first,\n\
             # then take the # away, and [start] where there is one, and drive with those gains (--gains).\n\
             # [supervisor]\n# error_stop_rad = 0.1"
        );
    }

    /// Torque that holds the arm before the first sample, where the robot's interface begins with none of its own.
    fn write_start(&self, text: &mut String) {
        if self.starts_itself {
            return;
        }
        let _ = writeln!(
            text,
            "\n# Where the run begins: on the reference, held by the torque that keeps the arm as described still, as \
             brakes or a\n\
             # robot's own controller do. The law takes over from there.\n\
             [start]\ntorque_nm = \"gravity\""
        );
    }

    fn write_reference(&self, text: &mut String) {
        let mut line = |words: String| {
            let _ = writeln!(text, "{words}");
        };
        line("\n# What the arm shall do: a sine per joint about a posture, well inside the limits of position, speed \
            and torque. Other".into());
        line("# kinds: \"waypoints\", \"circle\", \"curve\", \"csv\", \"hold\". What the arm might hit is not known \
            here.".into());
        line("[reference]".into());
        line("kind = \"sines\"".into());
        match &self.centre {
            Centre::Pose(name) => {
                line(format!("center = {}", toml::Value::String((*name).to_owned())));
            }
            Centre::Posture(q) => line(format!("center_rad = {}", list(q))),
        }
        line(format!("fade_in_s = {:?}", self.motion.fade_in));
        line("\n[[reference.sine]]".into());
        line(format!("amplitude_rad = {}", list(&self.motion.amplitude)));
        line(format!("frequency_hz = {}", list(&self.motion.frequency)));
        line(format!("phase_rad = {}", list(&self.motion.phase)));
    }
}

fn list(values: &[f64]) -> String {
    let all: Vec<String> = values.iter().map(|x| format!("{x:?}")).collect();
    format!("[{}]", all.join(", "))
}

/// One number where all are the same.
fn numbers(values: &[f64]) -> String {
    match values {
        [first, rest @ ..] if rest.iter().all(|x| x.to_bits() == first.to_bits()) => {
            format!("{first:?}")
        }
        all => list(all),
    }
}
