//! Choices that a study leaves to the design, and that the gains carry.

use phihat::Form;
use phihat_study::Study;

use crate::{Gains, GainsError, LoopModel};

impl Gains {
    /// Gives a study what it leaves to the design and these gains carry: the form, and the velocity filter,
    /// which a law from positions does not have.
    ///
    /// # Errors
    ///
    /// [`GainsError::NoFilter`].
    pub fn complete(&self, study: &mut Study) -> Result<(), GainsError> {
        if study.control.form_designed {
            study.control.takes(self.designed_form());
        }
        if study.sensor.velocity_filter_designed && study.control.form != Form::Positions {
            study.sensor.velocity_filter_hz =
                Some(self.velocity_filter_hz.ok_or(GainsError::NoFilter)?);
        }
        Ok(())
    }

    /// The form that a design gave them.
    fn designed_form(&self) -> Form {
        let positions = self.joints.iter().any(|joint| joint.observer.is_some());
        if positions { Form::Positions } else { Form::Observer }
    }
}

impl LoopModel {
    /// This loop with what gains carry, where the study leaves it to them.
    #[must_use]
    pub fn with_choices_of(mut self, gains: &Gains, study: &Study) -> Self {
        if study.sensor.velocity_filter_designed {
            self.velocity_filter_hz = gains.velocity_filter_hz;
        }
        if study.control.form_designed {
            self.form = gains.designed_form();
        }
        self
    }
}
