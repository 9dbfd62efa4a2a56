//! The sentence of a certificate whose study states no springs.

use super::document::SpringBasis;
use crate::Certificate;

const ASSUMED: &str = "rigid joints: ASSUMED, not checked";

impl Certificate {
    /// One sentence on joints that the claims take as rigid: the softest springs that the gains are shown to bear, and
    /// those of such joints; `None`: the study states its springs.
    pub fn rigid_joints(&self) -> Option<String> {
        let Some(elastic) = &self.elastic else {
            let why = "no springs are known that these gains are shown to bear";
            return self.elastic_refused.is_none().then(|| format!("{ASSUMED}; {why}"));
        };
        if elastic.basis == SpringBasis::Stated {
            return None;
        }
        let joints = self.joints.iter().zip(&elastic.joints).map(|(joint, own)| {
            let least = 1e-3 * own.stiffness_nm_rad.0;
            let usual = own.usual_nm_rad.filter(|usual| usual.0 < own.stiffness_nm_rad.0);
            let usual = usual.map_or_else(String::new, |(low, high)| {
                format!(", such joints have {} … {}", 1e-3 * low, 1e-3 * high)
            });
            format!("{} ≥ {least} kN·m/rad{usual}", joint.name)
        });
        Some(format!(
            "{ASSUMED}; with encoders at the {} and 1 % damping of their springs these gains are stable for {}",
            elastic.encoder.word(),
            joints.collect::<Vec<_>>().join("; ")
        ))
    }
}
