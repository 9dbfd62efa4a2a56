//! The velocity filter where a study leaves it to the design: the gains carry it.

use phihat_study::Study;

use crate::{Gains, GainsError, LoopModel};

impl Gains {
    /// Gives a study the velocity filter that the gains carry, where it leaves that to the design.
    ///
    /// # Errors
    ///
    /// [`GainsError::NoFilter`].
    pub fn give_filter(&self, study: &mut Study) -> Result<(), GainsError> {
        if study.sensor.velocity_filter_designed {
            study.sensor.velocity_filter_hz =
                Some(self.velocity_filter_hz.ok_or(GainsError::NoFilter)?);
        }
        Ok(())
    }
}

impl LoopModel {
    /// This loop with the velocity filter that gains carry, where the study leaves it to them.
    #[must_use]
    pub fn with_filter_of(mut self, gains: &Gains, study: &Study) -> Self {
        if study.sensor.velocity_filter_designed {
            self.velocity_filter_hz = gains.velocity_filter_hz;
        }
        self
    }
}
