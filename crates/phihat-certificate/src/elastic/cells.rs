//! Cells of frequency: one circle for all joints and springs in each, or where there is none.

use core::f64::consts::PI;

use super::disc::Disc;
use super::port::{Circle, Port, SpringBand};
use crate::check::complex::Complex;

/// Boxes of springs per joint and cell; where more are needed, the cell is halved.
const BOXES: u32 = 64;

/// Boxes after which a proof is given up.
const MOST: u64 = 4_000_000;

/// Cells narrower than this share of their frequency prove nothing more.
const NARROWEST: f64 = 1e-9;

/// Lowest end of a cell \[rad/sample\].
const LOWEST: f64 = 1e-9;

/// Rounds in which the deepest springs are added to those that choose a circle.
const ROUNDS: u32 = 3;

/// Frequency \[rad/sample\] at which the clause is not proved, and whether it is known to fail there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct OpenCell {
    pub(super) theta: f64,
    pub(super) fails: bool,
    /// Joints that no circle serves together.
    pub(super) joints: (usize, usize),
}

/// Covers all frequencies by cells, each with one circle through `−low` and `−high`.
pub(super) fn covered(ports: &[Port], range: (f64, f64)) -> Result<(), OpenCell> {
    let mut cells = vec![(0.0, PI)];
    let mut tried = 0_u64;
    while let Some((from, to)) = cells.pop() {
        let middle = 0.5 * (from + to);
        let bands: Vec<SpringBand> = ports.iter().map(|port| port.band(from, to)).collect();
        let kappa = circle(ports, &bands, range).map_err(|joints| OpenCell {
            theta: middle,
            fails: true,
            joints,
        })?;
        let circle = Circle::new(range, kappa);
        let open = ports.iter().zip(&bands).position(|(port, band)| {
            let (clear, boxes) = port.clear(band, &circle, BOXES);
            tried += u64::from(boxes);
            !clear
        });
        let Some(joint) = open else { continue };
        if to - from < NARROWEST * to || to < LOWEST || tried > MOST {
            return Err(OpenCell { theta: middle, fails: false, joints: (joint, joint) });
        }
        cells.extend([(middle, to), (from, middle)]);
    }
    Ok(())
}

/// `κ` in the middle of those that serve all joints in the middle of a band, by springs at the ends of their
/// intervals and those deepest inside; else the two joints that ask for the opposite.
fn circle(ports: &[Port], bands: &[SpringBand], range: (f64, f64)) -> Result<f64, (usize, usize)> {
    let scale = (range.0 * range.1).sqrt();
    let mut allowed = Allowed::new(scale);
    for (i, (port, band)) in ports.iter().zip(bands).enumerate() {
        let (low, high) = port.springs.compliance;
        for compliance in [low, high] {
            allowed.add((i, port, band), compliance, range);
        }
    }
    for _ in 0..ROUNDS {
        let circle = Circle::new(range, allowed.middle()?);
        for (i, (port, band)) in ports.iter().zip(bands).enumerate() {
            let (low, high) = port.springs.rotor;
            for rotor in [low, high] {
                allowed.add((i, port, band), port.deepest(band, &circle, rotor), range);
            }
        }
    }
    allowed.middle()
}

/// Interval of `κ`, with the joints that set its ends.
struct Allowed {
    scale: f64,
    low: (f64, usize),
    high: (f64, usize),
}

impl Allowed {
    fn new(scale: f64) -> Self {
        Self { scale, low: (f64::NEG_INFINITY, 0), high: (f64::INFINITY, 0) }
    }

    /// Intersects with the interval of a joint at one compliance, whatever damping and rotor.
    fn add(&mut self, (i, port, band): (usize, &Port, &SpringBand), s: f64, range: (f64, f64)) {
        let (rotor, damping) = (port.springs.rotor, port.springs.damping);
        for [c, b] in [damping.0, damping.1].into_iter().flat_map(|c| [[c, rotor.0], [c, rotor.1]])
        {
            let sides = port.sides(band, [s, c, b], range);
            let edge = -sides.f / sides.g;
            if sides.g > 0.0 && edge > self.low.0 {
                self.low = (edge, i);
            }
            if sides.g < 0.0 && edge < self.high.0 {
                self.high = (edge, i);
            }
            // Real, or no number: no circle moves it.
            if !(sides.g.abs() > 0.0 || sides.f > 0.0) {
                (self.low, self.high) = ((f64::INFINITY, i), (f64::NEG_INFINITY, i));
            }
        }
    }

    fn middle(&self) -> Result<f64, (usize, usize)> {
        if self.low.0 >= self.high.0 {
            return Err((self.low.1, self.high.1));
        }
        let angle = |kappa: f64| libm::atan(kappa / self.scale);
        Ok(self.scale * libm::tan(0.5 * (angle(self.low.0) + angle(self.high.0))))
    }
}

/// Angle \[rad\] by which a function of the frequency turns over the half circle, where cells keep it from 0.
pub(super) fn turned(at: impl Fn(f64, f64) -> Option<Disc>) -> Option<f64> {
    let (mut cells, mut sum, mut tried) = (vec![(0.0, PI)], 0.0, 0_u64);
    while let Some((from, to)) = cells.pop() {
        tried += 1;
        let middle = 0.5 * (from + to);
        if at(from, to).is_some_and(|disc| disc.least() > 0.0) {
            let [start, centre, end] = [from, middle, to].map(|theta| at(theta, theta));
            let (start, centre, end) = (start?.centre, centre?.centre, end?.centre);
            sum += angle(centre.over(start)) + angle(end.over(centre));
            continue;
        }
        if to - from < NARROWEST * to || tried > MOST {
            return None;
        }
        cells.extend([(middle, to), (from, middle)]);
    }
    Some(sum)
}

fn angle(z: Complex) -> f64 {
    libm::atan2(z.im, z.re)
}
