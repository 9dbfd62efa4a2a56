//! The same statements on other arms, paths and worlds: how much of an answer is the surrogate's.

use phihat::Form;
use phihat_study::Study;

use super::claims::{Claim, EXPERIMENTED, SIMULATED};
use super::run::resized;
use super::runs::Runs;
use super::studies::{Studies, StudyKind};
use super::variations::{Other, PATHS, WORLDS};
use crate::compose::{figure, log_axis, number, rests_on, section, table, three};
use crate::part::{Extent, PartError};
use crate::record::{Assumption, PaperNumber, Section, Statement};
use phihat_report::kit::figure::{Content, Panel};

/// Factors on the masses of the links.
const LINKS: &[f64] = &[0.3, 0.5, 1.0, 2.0, 3.0];
/// Rotor inertia of every joint \[kg·m²\].
const ARMATURES: &[f64] = &[0.1, 0.2, 0.3, 0.4, 0.6, 0.8, 1.6];

/// Truth of each statement on one variation: by claim, in the printed and in the observer form.
type SurrogateAnswers = Vec<[bool; 2]>;

/// The statements of one kind over all variations.
#[derive(Debug)]
pub(crate) struct Varied {
    claims: &'static [Claim],
    links: Vec<f64>,
    armatures: Vec<f64>,
    /// Row by row of `links`.
    arms: Vec<SurrogateAnswers>,
    others: Vec<(&'static str, &'static str, SurrogateAnswers)>,
    /// True if all variations were run.
    whole: bool,
}

/// Varies what the simulations rest on.
pub(crate) fn simulated(
    studies: &Studies,
    extent: Extent,
    progress: &dyn Fn(f64),
) -> Result<Varied, PartError> {
    vary(studies, StudyKind::Simulation, (SIMULATED, PATHS), extent, progress)
}

/// Varies what the experiments rest on.
pub(crate) fn experimented(
    studies: &Studies,
    extent: Extent,
    progress: &dyn Fn(f64),
) -> Result<Varied, PartError> {
    vary(studies, StudyKind::Experiment, (EXPERIMENTED, WORLDS), extent, progress)
}

fn vary(
    studies: &Studies,
    kind: StudyKind,
    (claims, others): (&'static [Claim], &'static [Other]),
    extent: Extent,
    progress: &dyn Fn(f64),
) -> Result<Varied, PartError> {
    let few = |all: &[f64]| -> Vec<f64> {
        let ends = [all.first(), all.last()];
        if extent.quick { ends.into_iter().flatten().copied().collect() } else { all.to_vec() }
    };
    let (links, armatures) = (few(LINKS), few(ARMATURES));
    let others = if extent.quick { &others[..1] } else { others };
    let all = (links.len() * armatures.len() + others.len()) as f64;
    let mut done = 0.0;
    let mut answers = |change: &dyn Fn(Study) -> Study| -> Result<SurrogateAnswers, PartError> {
        let runs = Runs::of(studies, kind, change, || ())?;
        done += 1.0;
        progress(done / all);
        let both = |claim: &Claim| -> Result<[bool; 2], PartError> {
            Ok([claim.everywhere(&runs, Form::Literal)?, claim.everywhere(&runs, Form::Observer)?])
        };
        claims.iter().map(both).collect()
    };
    let mut arms = Vec::new();
    for times in &links {
        for armature in &armatures {
            arms.push(answers(&|study| resized(study, *times, *armature))?);
        }
    }
    let other = |(id, says, change): &Other| Ok((*id, *says, answers(change)?));
    let others = others.iter().map(other).collect::<Result<Vec<_>, PartError>>()?;
    Ok(Varied { claims, links, armatures, arms, others, whole: !extent.quick })
}

impl Varied {
    /// On how many arms a claim holds, in one form.
    fn share(&self, claim: usize, form: usize) -> usize {
        self.arms.iter().filter(|answers| answers[claim][form]).count()
    }

    /// Under which single changes of an assumption a claim holds in the printed form, in words; empty where there
    /// were none.
    pub(crate) fn depends(&self, claim: usize) -> String {
        let listed = |holds: bool| {
            let those = self.others.iter().filter(|(.., answers)| answers[claim][0] == holds);
            let those: Vec<&str> = those.map(|(_, says, _)| *says).collect();
            if those.is_empty() { "none".to_owned() } else { those.join("; ") }
        };
        if self.others.is_empty() {
            return String::new();
        }
        format!(
            "One assumption changed at a time, the printed form does where: {}. It does not where: {}.",
            listed(true),
            listed(false)
        )
    }

    /// Adds what a statement was varied over, and the arms at which it turns in the printed form.
    pub(crate) fn around(&self, statement: Statement, claim: usize) -> Statement {
        let lost = self.others.iter().filter(|(.., answers)| !answers[claim][0]);
        let lost: Vec<&str> = lost.map(|(_, says, _)| *says).collect();
        let lost = if lost.is_empty() { "none".to_owned() } else { lost.join("; ") };
        let (held, all) = (self.share(claim, 0), self.arms.len());
        let ends =
            |all: &[f64]| [all.first(), all.last()].map(|end| three(end.copied())).join(" to ");
        let fails = |(k, answers): (usize, &SurrogateAnswers)| {
            let (row, column) = (k / self.armatures.len(), k % self.armatures.len());
            (!answers[claim][0]).then(|| {
                let place = [self.links.get(row), self.armatures.get(column)];
                place.map(|value| three(value.copied())).join(" and ")
            })
        };
        let failing: Vec<String> = self.arms.iter().enumerate().filter_map(fails).collect();
        let turns = if failing.is_empty() {
            "On none of the arms tried.".to_owned()
        } else {
            format!("Arms on which it does not hold, by links and rotors: {}.", failing.join("; "))
        };
        statement
            .varying(format!(
                "Links {} times as heavy, rotors of {} kg·m²: holds on {held} of {all} arms. One change at a time, it \
                    does not hold where: {lost}.",
                ends(&self.links),
                ends(&self.armatures)
            ))
            .turning(turns)
    }

    /// Under how many single changes a claim holds, by form; nothing of a quick run, which tries fewer.
    pub(crate) fn counts(&self, claim: usize, what: &str) -> Vec<PaperNumber> {
        let forms = ["printed form", "observer form"].into_iter().enumerate();
        let count = |(form, name): (usize, &str)| {
            let held = self.others.iter().filter(|(.., answers)| answers[claim][form]).count();
            number(&format!("single changes under which {what}, {name}"), "", held as f64, 0.0)
        };
        if self.whole { forms.map(count).collect() } else { Vec::new() }
    }

    /// Table and map.
    pub(crate) fn section(&self, kind: StudyKind, studies: &[String]) -> Section {
        let (id, title) = match kind {
            StudyKind::Simulation => {
                ("surrogates-simulation", "Other arms: the statements on Figs. 5 to 8")
            }
            StudyKind::Experiment => {
                ("surrogates-experiment", "Other arms: the statements on Figs. 9 to 11")
            }
        };
        let text = "Links so many times as heavy, rotors of so much inertia, friction and torque limits in \
                    proportion to the links; then one assumption at a time. A statement counts where it \
                    holds for every gain set that it is about.";
        let mut section = section(id, title, &[text]);
        let all = self.arms.len();
        let rows = self.claims.iter().enumerate().map(|(i, claim)| {
            let changed = |form: usize| {
                let no = self
                    .others
                    .iter()
                    .filter(|(.., answers)| !answers[i][form])
                    .map(|(_, says, _)| *says);
                let no: Vec<&str> = no.collect();
                if no.is_empty() { "none".to_owned() } else { no.join("; ") }
            };
            let of = |form| format!("{} of {all}", self.share(i, form));
            vec![claim.says.to_owned(), of(0), of(1), changed(0), changed(1)]
        });
        let columns = [
            "statement",
            "arms, printed form",
            "arms, observer form",
            "printed form: not where",
            "observer form: not where",
        ];
        section.tables.push(table(id, title, &columns, rows.collect()));
        section.figures.push(self.map(id));
        rests_on(&mut section, &[], studies);
        section
    }

    /// Map of the arms on which (48), (49) are satisfied.
    fn map(&self, id: &str) -> phihat_report::kit::figure::Figure {
        let class = |answers: &SurrogateAnswers| {
            let bounds = || self.claims.iter().zip(answers).filter(|(claim, _)| claim.bounds);
            let all = |form: usize| u8::from(bounds().all(|(_, holds)| holds[form]));
            all(0) + 2 * all(1)
        };
        let cells =
            self.arms.chunks(self.armatures.len()).map(|row| row.iter().map(class).collect());
        let content = Content::Map {
            x: self.armatures.clone(),
            y: self.links.clone(),
            cells: cells.collect(),
            classes: ["neither", "printed form only", "observer form only", "both"]
                .map(str::to_owned)
                .into(),
        };
        let panel = Panel {
            title: "(48), (49) kept by all gain sets".to_owned(),
            x: log_axis("rotor inertia [kg·m²]"),
            y: log_axis("links' mass over the surrogate's"),
            content,
            ..Panel::default()
        };
        let caption = "The gains as printed, M̄ = 1 kg·m², on all arms tried. A cell counts for a form where every \
                       gain set keeps its bounds, |∬e| of (49) included.";
        figure(&format!("fig-{id}"), "On which arms the bounds are kept", caption, vec![panel])
    }

    /// Writes what was measured into the assumptions.
    pub(crate) fn tell(&self, assumptions: &mut [Assumption]) {
        for assumption in assumptions {
            let listed =
                if assumption.id == "arm" { self.over_arms() } else { self.over(&assumption.id) };
            if !listed.is_empty() {
                assumption.influence = listed;
            }
        }
    }

    fn over_arms(&self) -> String {
        let all = self.arms.len();
        let ends = |all: &[f64]| {
            let (first, last) = (all.first(), all.last());
            format!("{} to {}", three(first.copied()), three(last.copied()))
        };
        let (links, rotors) = (ends(&self.links), ends(&self.armatures));
        let claims = self.claims.iter().enumerate().map(|(i, claim)| {
            let (printed, ours) = (self.share(i, 0), self.share(i, 1));
            format!(
                " “{}”: printed form on {printed} of {all} arms, observer form on {ours}.",
                claim.says
            )
        });
        let claims: String = claims.collect();
        format!("Links {links} times as heavy, rotors of {rotors} kg·m².{claims}")
    }

    /// Effect of the variations of one assumption, in words; empty where there were none.
    fn over(&self, id: &str) -> String {
        let varied = || self.others.iter().filter(|(other, ..)| *other == id);
        let all: Vec<&str> = varied().map(|(_, says, _)| *says).collect();
        if all.is_empty() {
            return String::new();
        }
        let claims = self.claims.iter().enumerate().map(|(i, claim)| {
            let holds = |form: usize| {
                let lost = varied().filter(|(.., answers)| !answers[i][form]);
                let lost: Vec<&str> = lost.map(|(_, says, _)| *says).collect();
                match lost.len() {
                    0 => "in every case".to_owned(),
                    n if n == all.len() => "in no case".to_owned(),
                    _ => format!("but for: {}", lost.join(", ")),
                }
            };
            format!(
                " “{}” holds: printed form {}; observer form {}.",
                claim.says,
                holds(0),
                holds(1)
            )
        });
        let claims: String = claims.collect();
        format!("Varied one at a time: {}.{claims}", all.join("; "))
    }
}
