//! What a study leaves to the design: the gains carry it.

use phihat::Form;
use phihat_study::Study;

use crate::{Gains, GainsError, LoopModel};

impl Gains {
    /// Gives a study what it leaves to the design and these gains carry: the form of the law, the velocity filter.
    ///
    /// # Errors
    ///
    /// [`GainsError::NoFilter`].
    pub fn complete(&self, study: &mut Study) -> Result<(), GainsError> {
        let form = self.form_in(study);
        if study.control.form_designed {
            study.control.form = form;
            study.control.preview |= form == Form::Positions;
        }
        if study.sensor.velocity_filter_designed && form != Form::Positions {
            study.sensor.velocity_filter_hz =
                Some(self.velocity_filter_hz.ok_or(GainsError::NoFilter)?);
        }
        Ok(())
    }

    /// The form of the law in a study's loop.
    fn form_in(&self, study: &Study) -> Form {
        let seen = self.joints.first().is_some_and(|joint| joint.observer.is_some());
        match study.control.form {
            _ if !study.control.form_designed => study.control.form,
            _ if seen => Form::Positions,
            form => form,
        }
    }
}

impl LoopModel {
    /// This loop with what gains carry, where the study leaves it to them.
    #[must_use]
    pub fn with_choices_of(mut self, gains: &Gains, study: &Study) -> Self {
        self.form = gains.form_in(study);
        if study.sensor.velocity_filter_designed {
            self.velocity_filter_hz = gains.velocity_filter_hz;
        }
        self
    }
}
