//! Errors that no law keeps, known before any search.

use phihat_certificate::TorqueNoise;
use phihat_design::{Clause, Infeasible, LeastError, Outcome};
use phihat_model::JointKind;
use phihat_study::Study;

use crate::class_study::{in_its_form, is_class};
use crate::error::SynthesisError;
use crate::judged::{ERROR_KEY, beyond_error};

/// Clauses of a study that no law keeps.
///
/// Any motion of a class has the bound from below of (CM2); one motion that of its readings: a reading that stays off
/// by `N` moves a joint by as much once the loop has settled.
pub(crate) struct BeyondAnyLaw {
    clauses: Vec<Clause>,
    /// The joint whose least error is the largest of those.
    words: String,
}

impl BeyondAnyLaw {
    /// Clauses of a study that no law keeps; `None`: there are none.
    ///
    /// # Errors
    ///
    /// [`SynthesisError::Class`]: the theorem does not cover the class.
    pub(crate) fn of(study: &Study) -> Result<Option<Self>, SynthesisError> {
        let Some(wanted) = &study.spec.error_bound else { return Ok(None) };
        let all = if is_class(study) {
            LeastError::of_class(&in_its_form(study))?
        } else {
            readings(study)
        };
        let (mut clauses, mut most) = (Vec::new(), None);
        for ((wanted, least), joint) in wanted.iter().zip(&all).zip(&study.robot.joints) {
            let sum = least.reading_rad + least.force_rad;
            if *wanted > sum || sum <= 0.0 {
                continue;
            }
            if most.is_none_or(|(before, _, _)| sum > before) {
                most = Some((sum, least, &joint.name));
            }
            let (key, joint) = (ERROR_KEY.to_owned(), Some(joint.name.clone()));
            clauses.push(Clause { key, joint, wanted: *wanted, possible: None });
        }
        Ok(most
            .map(|(sum, least, name)| Self { clauses, words: sentence(study, sum, least, name) }))
    }

    /// The answer before a search that says how little can be asked for.
    pub(crate) fn step(&self) -> String {
        format!("NO GAINS: {}; looking for the least that can be asked for", self.words)
    }

    /// The answer, with what each joint's error can be by clauses of a search, and more words on it.
    pub(crate) fn with_possible(
        mut self,
        possible: impl Fn(&str) -> Option<f64>,
        words: Option<String>,
    ) -> Infeasible {
        for clause in &mut self.clauses {
            clause.possible = clause.joint.as_deref().and_then(&possible);
        }
        let words = core::iter::once(self.words).chain(words).collect();
        Infeasible { clauses: self.clauses, words, beyond_any_law: true, ..Infeasible::default() }
    }

    /// The answer after a search for one motion.
    pub(crate) fn beside(self, study: &Study, outcome: Outcome) -> Outcome {
        let mut no = match outcome {
            Outcome::Infeasible(no) => no,
            Outcome::Designed(gains) => {
                let clauses = beyond_error(study, &gains).unwrap_or_else(|| self.clauses.clone());
                Infeasible { clauses, nearest: Some(gains), ..Infeasible::default() }
            }
        };
        no.words.insert(0, self.words);
        no.beyond_any_law = true;
        Outcome::Infeasible(no)
    }
}

/// Error of each joint by its readings alone \[rad, m\]: half an encoder step, and bias.
fn readings(study: &Study) -> Vec<LeastError> {
    let step = |joint: usize| {
        let bits = study.sensor.encoder_bits.as_ref().and_then(|bits| bits.get(joint));
        bits.map_or(0.0, |bits| TorqueNoise::quantum(*bits))
    };
    let biases = study.sensor.position_bias.iter().enumerate();
    let readings = biases.map(|(joint, bias)| 0.5 * step(joint) + bias.abs());
    readings.map(|reading_rad| LeastError { reading_rad, force_rad: 0.0 }).collect()
}

fn sentence(study: &Study, sum: f64, least: &LeastError, name: &str) -> String {
    let joint = study.robot.joints.iter().find(|joint| joint.name == name);
    let slides = joint.is_some_and(|joint| joint.kind == JointKind::Prismatic);
    let unit = if slides { "mm" } else { "mrad" };
    let [sum, reading, force] = [sum, least.reading_rad, least.force_rad].map(milli);
    if is_class(study) {
        return format!(
            "no law keeps less than {sum} {unit} on {name}: its readings are off by up to {reading} {unit} (encoder \
             step, bias, noise), and dry friction or a push moves it by {force} {unit} before a torque answers"
        );
    }
    format!(
        "no law that settles within the motion keeps less than {sum} {unit} on {name}: its readings are off by up to \
         {reading} {unit} (half an encoder step, bias)"
    )
}

/// A number of SI units in thousandths, to four digits.
fn milli(value: f64) -> String {
    let short = format!("{:.3e}", 1e3 * value).parse::<f64>();
    short.map_or_else(|_| value.to_string(), |short| short.to_string())
}
