//! The runs of every setting in both forms.

use phihat::Form;
use phihat_study::Study;

use super::run::Run;
use super::studies::{GainSetting, Studies, StudyKind};
use crate::part::PartError;

/// Every setting in both forms of the law.
#[derive(Debug)]
pub(crate) struct Runs {
    runs: Vec<(GainSetting, Form, Run)>,
}

/// Both forms.
pub(crate) const FORMS: [Form; 2] = [Form::Literal, Form::Observer];

/// `printed` or `observer`: the name of a form for readers.
pub(crate) fn form_name(form: Form) -> &'static str {
    match form {
        Form::Literal => "printed",
        Form::Observer | Form::Positions => "observer",
    }
}

impl Runs {
    /// Runs all ten, each study changed by `change` before; `done` is told after each.
    pub(crate) fn of(
        studies: &Studies,
        kind: StudyKind,
        change: impl Fn(Study) -> Study,
        mut done: impl FnMut(),
    ) -> Result<Self, PartError> {
        let mut runs = Vec::new();
        for setting in GainSetting::ALL {
            for form in FORMS {
                let run = Run::of(change(studies.study(kind, setting, form)?))?;
                runs.push((setting, form, run));
                done();
            }
        }
        Ok(Self { runs })
    }

    /// One of them.
    pub(crate) fn get(&self, setting: GainSetting, form: Form) -> Result<&Run, PartError> {
        let found = self.runs.iter().find(|(s, f, _)| (*s, *f) == (setting, form));
        found.map(|(.., run)| run).ok_or(PartError::NotRun(setting.label()))
    }

    /// All of them, in the order of [`Setting::ALL`], printed form first.
    pub(crate) fn iter(&self) -> impl Iterator<Item = (GainSetting, Form, &Run)> {
        self.runs.iter().map(|(setting, form, run)| (*setting, *form, run))
    }
}
