//! Trade-off between error bound and torque noise: the laws that no other beats in both.

use phihat_certificate::TradeOff;

use crate::quick::Quick;

/// Indices of those laws, ascending in noise as given, of which no quieter one has smaller gains from φ, φ̇ and
/// the encoder: few enough to be measured against a specification.
pub(crate) fn worth_measuring<'a>(laws: impl Iterator<Item = (f64, &'a Quick)>) -> Vec<usize> {
    let mut kept: Vec<[f64; 3]> = Vec::new();
    let mut indices = Vec::new();
    for (index, (scale, quick)) in laws.enumerate() {
        let ramp = quick.ramp[1].unwrap_or(f64::INFINITY);
        let own = [quick.jump[1] / scale, ramp / scale, quick.reading[0]];
        let beaten = kept.iter().any(|other| other.iter().zip(own).all(|(o, own)| *o <= own));
        if !beaten {
            kept.push(own);
            indices.push(index);
        }
    }
    indices
}

/// An error this much smaller than the last one's is worth a point of its own.
const WORTH: f64 = 0.98;

/// Keeps, of points ascending in noise, those with a smaller error than all before, and the chosen one.
pub(crate) fn front(points: Vec<TradeOff>) -> Vec<TradeOff> {
    let mut least = f64::INFINITY;
    let mut kept: Vec<TradeOff> = Vec::new();
    for point in points {
        if point.error_share < WORTH * least {
            least = point.error_share;
            kept.push(point);
        } else if point.chosen {
            kept.push(point);
        }
    }
    kept
}
