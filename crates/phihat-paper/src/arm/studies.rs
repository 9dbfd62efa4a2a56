//! The studies of the paper's three-joint arm, as shipped in `studies/paper/`.

use phihat::Form;
use std::collections::BTreeMap;
use std::path::Path;

use phihat_study::Study;

use crate::part::PartError;

macro_rules! shipped {
    ($($name:literal),* $(,)?) => {
        &[$((
            concat!("studies/paper/", $name, ".toml"),
            include_str!(concat!("../../studies/", $name, ".toml")),
        )),*]
    };
}

/// Path in the repository, and text.
pub(crate) const SHIPPED: &[(&str, &str)] = shipped![
    "simulation_m1",
    "simulation_m2_h1",
    "simulation_m2_h2",
    "simulation_m2_h3",
    "simulation_m2_h4",
    "experiment_m1",
    "experiment_m2_h1",
    "experiment_m2_h2",
    "experiment_m2_h3",
    "experiment_m2_h4",
    "order_switch",
];

/// A set of gains that the paper's figures may have been made with.
///
/// `K_p` and `K_d` are printed, the coefficients `a_i` are not.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum GainSetting {
    /// m = 1.
    First,
    /// m = 2, `a = (4844, 69.6)`.
    H1,
    /// m = 2, `a = (9688, 139.2)`.
    H2,
    /// m = 2, `a = (4844, 139.2)`.
    H3,
    /// m = 2, `a = (1211, 69.6)`.
    H4,
}

impl GainSetting {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::First, Self::H1, Self::H2, Self::H3, Self::H4];
    /// Those of second order.
    pub const SECOND: [Self; 4] = [Self::H1, Self::H2, Self::H3, Self::H4];

    /// `m = 2, H1`.
    pub fn label(self) -> &'static str {
        match self {
            Self::First => "m = 1",
            Self::H1 => "m = 2, H1",
            Self::H2 => "m = 2, H2",
            Self::H3 => "m = 2, H3",
            Self::H4 => "m = 2, H4",
        }
    }

    fn stem(self) -> &'static str {
        match self {
            Self::First => "m1",
            Self::H1 => "m2_h1",
            Self::H2 => "m2_h2",
            Self::H3 => "m2_h3",
            Self::H4 => "m2_h4",
        }
    }
}

/// Simulation or experiment, in the paper's words.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StudyKind {
    /// Exact sensors, no limits.
    Simulation,
    /// Encoders, delay, drives, friction, a torque limit.
    Experiment,
}

/// The texts of the studies, by their path in the repository.
#[derive(Debug, Clone)]
pub struct Studies {
    texts: BTreeMap<String, String>,
}

impl Studies {
    /// Those in the repository.
    pub fn shipped() -> Self {
        let own = |(name, text): &(&str, &str)| ((*name).to_owned(), (*text).to_owned());
        Self { texts: SHIPPED.iter().map(own).collect() }
    }

    /// These studies with `old` replaced by `new` in every study: to see what an answer depends on.
    #[must_use]
    pub fn replaced(mut self, old: &str, new: &str) -> Self {
        self.texts.values_mut().for_each(|text| *text = text.replace(old, new));
        self
    }

    /// Every path in the repository with its text.
    pub fn iter(&self) -> impl Iterator<Item = (&str, &str)> {
        self.texts.iter().map(|(path, text)| (path.as_str(), text.as_str()))
    }

    /// The study of a setting, in a form of the law.
    ///
    /// # Errors
    ///
    /// [`PartError`]: there is no such study, or its text is not valid.
    pub fn study(
        &self,
        kind: StudyKind,
        setting: GainSetting,
        form: Form,
    ) -> Result<Study, PartError> {
        let mut study = self.read(&name(kind, setting))?;
        study.control.form = form;
        Ok(study)
    }

    /// A study by name.
    ///
    /// # Errors
    ///
    /// [`PartError`]: there is no such study, or its text is not valid.
    pub fn read(&self, name: &str) -> Result<Study, PartError> {
        let path = path(name);
        let Some(text) = self.texts.get(&path) else { return Err(PartError::NoStudy(path)) };
        Ok(Study::from_text(text, &path, Path::new(""))?)
    }
}

/// Path of the study of a setting in the repository.
pub(crate) fn path_of(kind: StudyKind, setting: GainSetting) -> String {
    path(&name(kind, setting))
}

/// Path of a study in the repository.
pub(crate) fn path(name: &str) -> String {
    format!("studies/paper/{name}.toml")
}

fn name(kind: StudyKind, setting: GainSetting) -> String {
    let kind = match kind {
        StudyKind::Simulation => "simulation",
        StudyKind::Experiment => "experiment",
    };
    format!("{kind}_{}", setting.stem())
}
