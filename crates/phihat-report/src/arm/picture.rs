//! The arm on paper: a still picture, and one that moves.

use std::fmt::Write as _;

use super::DrawnArm;
use super::camera::{Camera, HEIGHT, WIDTH};
use super::kinematics::{LinkPose, add, apply, norm};
use crate::drawing::Drawing;
use crate::kit::number::stated;
use crate::kit::text::line;
use crate::signal::sources;

/// Pictures of a motion at most; between them everything goes straight.
const FRAMES: usize = 90;
/// Points of a curve below it at most.
const POINTS: usize = 400;
/// Factors on the error, and how large a magnified one may be \[rad\].
const FACTORS: [f64; 7] = [1000.0, 300.0, 100.0, 30.0, 10.0, 3.0, 1.0];
const SEEN_RAD: f64 = 0.35;
/// Seconds that a motion is shown for at most.
const SHOWN_S: f64 = 20.0;
/// Height of the strip with the errors \[px\].
const STRIP: f64 = 150.0;

/// Motion that a picture shows: the joints at some instants.
struct PictureMotion<'a> {
    arm: &'a DrawnArm,
    camera: Camera,
    t: Vec<f64>,
    /// Desired, and desired plus the magnified error, per instant.
    desired: Vec<Vec<f64>>,
    drawn: Vec<Vec<f64>>,
    /// Times and values of the strip, finer than the frames.
    fine: Vec<f64>,
    errors: Vec<Vec<f64>>,
    factor: f64,
    tip: Vec<[f64; 3]>,
}

impl<'a> PictureMotion<'a> {
    fn of(drawing: &'a Drawing) -> Option<Self> {
        let arm = drawing.arm.as_ref()?;
        let column = |label: &str| -> Option<Vec<Vec<f64>>> {
            let at = sources().iter().position(|(curve, _)| curve.label == label)?;
            drawing.signals.iter().map(|own| own.get(at).map(|s| filled(s.values()))).collect()
        };
        let (wanted, errors) = (column("q_d")?, column("e")?);
        let count = wanted.iter().map(Vec::len).min().filter(|count| *count > 0)?;
        let most = errors.iter().flatten().fold(0.0, |most: f64, e| most.max(e.abs()));
        let factor = FACTORS.into_iter().find(|f| f * most * 1e-3 <= SEEN_RAD).unwrap_or(1.0);
        let evenly = |most: usize| -> Vec<usize> {
            let points = most.min(count);
            (0..points).map(|f| f * (count - 1) / (points - 1).max(1)).collect()
        };
        let (at, fine) = (evenly(FRAMES), evenly(POINTS));
        let row = |k: &usize, by: f64| -> Vec<f64> {
            wanted.iter().zip(&errors).map(|(q, e)| q[*k] + by * 1e-3 * e[*k]).collect()
        };
        let desired: Vec<_> = at.iter().map(|k| row(k, 0.0)).collect();
        let origins: Vec<_> = desired.iter().map(|q| arm.origins(q)).collect();
        let tip: Vec<_> = origins.iter().filter_map(|all| all.get(arm.tip).copied()).collect();
        let whole = drawing.end_s / (count - 1).max(1) as f64;
        Some(Self {
            arm,
            camera: Camera::of(arm, &tip, &origins.concat()),
            t: at.iter().map(|k| *k as f64 * whole).collect(),
            drawn: at.iter().map(|k| row(k, factor)).collect(),
            errors: errors.into_iter().map(|e| fine.iter().map(|k| e[*k]).collect()).collect(),
            fine: fine.iter().map(|k| *k as f64 * whole).collect(),
            desired,
            factor,
            tip,
        })
    }

    fn duration(&self) -> f64 {
        self.t.last().copied().unwrap_or(0.0).clamp(0.1, SHOWN_S)
    }
}

/// Gaps as the value before them.
fn filled(mut values: Vec<f64>) -> Vec<f64> {
    let mut before = 0.0;
    for value in &mut values {
        before = if value.is_finite() { *value } else { before };
        *value = before;
    }
    values
}

/// The arm in the middle of its run, as SVG; `None`: no arm is recorded, or no sample.
pub(crate) fn poster(drawing: &Drawing) -> Option<String> {
    let motion = PictureMotion::of(drawing)?;
    let at = motion.t.len() / 2;
    let mut svg =
        head(HEIGHT, &format!("The arm at {} s, beside its desired pose", stated(motion.t[at])));
    motion.paint(&mut svg, at..at + 1);
    // What the page's own kinematics is held against.
    let [x, y, z] = motion.tip.get(at)?;
    let told = format!("<svg data-time=\"{}\" data-tip=\"{x:.6} {y:.6} {z:.6}\"", motion.t[at]);
    Some(svg.replacen("<svg", &told, 1) + "</svg>")
}

/// The whole run as a picture that moves, over the errors of its joints, as SVG.
///
/// `bound`: what every joint's error is allowed \[mrad\], and from when on \[s\].
pub(crate) fn animation(drawing: &Drawing, bound: Option<(f64, f64)>) -> Option<String> {
    let motion = PictureMotion::of(drawing)?;
    let mut svg = head(
        HEIGHT + STRIP,
        "The arm as it moves, beside its desired pose, over the errors of its joints",
    );
    motion.paint(&mut svg, 0..motion.t.len());
    motion.strip(&mut svg, bound);
    Some(svg + "</svg>")
}

fn head(height: f64, title: &str) -> String {
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" role=\"img\" aria-label=\"{title}\" viewBox=\"0 0 {WIDTH} \
         {height}\" font-family=\"sans-serif\" font-size=\"15\" stroke-linecap=\"round\" stroke-linejoin=\"round\" \
         fill=\"none\"><title>{title}</title><desc>Links in grey, the desired pose in orange, the path of the tip; a \
         payload in green.</desc><rect width=\"{WIDTH}\" height=\"{height}\" fill=\"#fff\"/>"
    )
}

/// A line of the picture: where it is in each frame.
struct Stroke {
    paths: Vec<String>,
    far: f64,
    inks: [(&'static str, f64); 2],
}

impl PictureMotion<'_> {
    fn paint(&self, svg: &mut String, frames: core::ops::Range<usize>) {
        self.ground(svg);
        let path: Vec<_> = self.tip.iter().map(|p| self.camera.see(*p).0).collect();
        let _ = write!(
            svg,
            "<path d=\"{}\" stroke=\"#e06806\" stroke-width=\"2\" opacity=\"0.6\"/>",
            way(&path)
        );
        let places: Vec<_> =
            self.drawn[frames.clone()].iter().map(|q| self.arm.places(q)).collect();
        let ghosts: Vec<_> = self.desired[frames].iter().map(|q| self.arm.places(q)).collect();
        svg.push_str("<g opacity=\"0.55\">");
        for stroke in self.strokes(&ghosts) {
            self.line(svg, &stroke.paths, "#f08a1c", stroke.inks[0].1);
        }
        svg.push_str("</g>");
        let mut strokes = self.strokes(&places);
        strokes.sort_by(|a, b| b.far.total_cmp(&a.far));
        for stroke in &strokes {
            for (ink, width) in stroke.inks {
                self.line(svg, &stroke.paths, ink, width);
            }
        }
        self.words(svg);
    }

    /// A path that goes from one frame to the next, and begins anew.
    fn line(&self, svg: &mut String, paths: &[String], ink: &str, width: f64) {
        let Some(first) = paths.first() else { return };
        let _ = write!(svg, "<path d=\"{first}\" stroke=\"{ink}\" stroke-width=\"{width:.1}\">");
        if paths.len() > 1 {
            let (values, s) = (paths.join(";"), self.duration());
            let _ = write!(
                svg,
                "<animate attributeName=\"d\" dur=\"{s:.2}s\" repeatCount=\"indefinite\" values=\"{values}\"/>"
            );
        }
        svg.push_str("</path>");
    }

    /// Links and joints, each with its two inks.
    fn strokes(&self, frames: &[Vec<LinkPose>]) -> Vec<Stroke> {
        let (arm, reach) = (self.arm, self.arm.reach());
        let thick = arm.thickness();
        let mut strokes = Vec::new();
        for (i, link) in arm.links.iter().enumerate() {
            if let Some(parent) = link.parent
                && frames.iter().any(|at| {
                    norm(core::array::from_fn(|k| at[i].p[k] - at[parent].p[k])) > 1e-3 * reach
                })
            {
                let ends = |at: &Vec<LinkPose>| (at[parent].p, at[i].p);
                let width = 0.8 * (thick[parent] + thick[i]);
                strokes.push(self.stroke(frames, ends, width, ["#8d98a5", "#e4e8ed"]));
            }
            if link.joint.is_some() {
                let ends = |at: &Vec<LinkPose>| {
                    let half = apply(&at[i].r, link.axis.map(|x| 0.55 * thick[i] * x));
                    (add(at[i].p, half.map(|x| -x)), add(at[i].p, half))
                };
                strokes.push(self.stroke(frames, ends, 1.75 * thick[i], ["#232b34", "#46525f"]));
            }
        }
        for load in arm.payloads.iter().filter(|load| load.start <= 0.0 && load.mass > 0.0) {
            let centre = |at: &Vec<LinkPose>| {
                let p = add(at[load.link].p, apply(&at[load.link].r, load.com));
                (p, add(p, [0.0, 0.0, 1e-4 * reach]))
            };
            strokes.push(self.stroke(frames, centre, 0.09 * reach, ["#0a6b4e", "#16a37c"]));
        }
        strokes
    }

    fn stroke(
        &self,
        frames: &[Vec<LinkPose>],
        ends: impl Fn(&Vec<LinkPose>) -> ([f64; 3], [f64; 3]),
        width: f64,
        [edge, face]: [&'static str; 2],
    ) -> Stroke {
        let count = frames.len().max(1) as f64;
        let mut far = 0.0;
        let mut path = |at: &Vec<LinkPose>| {
            let (a, b) = ends(at);
            let ((a, near), (b, away)) = (self.camera.see(a), self.camera.see(b));
            far += 0.5 * (near + away) / count;
            way(&[a, b])
        };
        let paths = frames.iter().map(&mut path).collect();
        let wide = self.camera.size(width, far);
        Stroke { paths, far, inks: [(edge, wide), (face, (wide - 3.0).max(0.6 * wide))] }
    }

    /// A grid on the floor.
    fn ground(&self, svg: &mut String) {
        let reach = self.arm.reach();
        let lowest = self.tip.iter().fold(0.0, |low: f64, p| low.min(p[2] - 0.03 * reach));
        let at = |x: f64, y: f64| self.camera.see([x, y, lowest]).0;
        for k in -5..=5 {
            let (own, far) = (0.16 * reach * f64::from(k), 0.8 * reach);
            let lines = [[at(own, -far), at(own, far)], [at(-far, own), at(far, own)]];
            for line in lines {
                let _ = write!(svg, "<path d=\"{}\" stroke=\"#dfe4e9\"/>", way(&line));
            }
        }
    }

    fn words(&self, svg: &mut String) {
        let loads = self.arm.payloads.iter().filter(|load| load.start <= 0.0 && load.mass > 0.0);
        let mut carried = String::new();
        for load in loads {
            let _ = write!(carried, " · payload {} kg", stated(load.mass));
        }
        let by = if self.factor > 1.0 {
            format!("arm, its error × {}", stated(self.factor))
        } else {
            "arm".to_owned()
        };
        let y = HEIGHT - 18.0;
        let _ = write!(
            svg,
            "<g fill=\"#57606a\"><circle cx=\"26\" cy=\"{cy}\" r=\"6\" fill=\"#46525f\"/><text x=\"40\" \
             y=\"{y}\">{by}{carried}</text><circle cx=\"560\" cy=\"{cy}\" r=\"6\" fill=\"#f08a1c\" \
             opacity=\"0.6\"/><text x=\"574\" y=\"{y}\">desired pose</text><path d=\"M700 {cy}H724\" \
             stroke=\"#e06806\" stroke-width=\"3\"/><text x=\"732\" y=\"{y}\">path of the tip</text></g>",
            cy = y - 5.0,
        );
    }

    /// The unit of the errors: mm of joints that slide.
    fn unit(&self) -> &'static str {
        let joints = || self.arm.links.iter().filter(|link| link.joint.is_some());
        match (joints().all(|link| link.slides), joints().any(|link| link.slides)) {
            (true, true) => "mm",
            (false, true) => "mrad, mm",
            (_, false) => "mrad",
        }
    }

    /// The errors of all joints, and where in them the picture is.
    fn strip(&self, svg: &mut String, bound: Option<(f64, f64)>) {
        let (bound, from) = (bound.map(|bound| bound.0), bound.map_or(0.0, |bound| bound.1));
        let (left, right) = (64.0, WIDTH - 20.0);
        let (top, bottom) = (HEIGHT + 12.0, HEIGHT + STRIP - 34.0);
        let most = self.errors.iter().flatten().fold(0.0, |most: f64, e| most.max(e.abs()));
        // What starts far away leaves the strip: the bound is to be seen.
        let most = bound.map_or(1.1 * most, |bound| (1.1 * most).clamp(1.3 * bound, 2.6 * bound));
        let most = most.max(1e-9);
        let _ = write!(
            svg,
            "<rect y=\"{HEIGHT}\" width=\"{WIDTH}\" height=\"{STRIP}\" fill=\"#fff\"/><clipPath id=\"strip\"><path \
                d=\"M{left} {top}H{right}V{bottom}H{left}Z\"/></clipPath><g clip-path=\"url(#strip)\">"
        );
        let end = self.t.last().copied().unwrap_or(1.0).max(1e-9);
        let y = |e: f64| 0.5 * (top + bottom) - 0.5 * (bottom - top) * e / most;
        let x = |t: f64| left + (right - left) * t / end;
        for level in bound.into_iter().flat_map(|bound| [bound, -bound]) {
            let _ = write!(
                svg,
                "<path d=\"M{from:.1} {l:.1}H{right}\" stroke=\"#5a5a5b\" stroke-dasharray=\"6 6\"/>",
                from = x(from),
                l = y(level)
            );
        }
        let _ = write!(svg, "<path d=\"M{left} {z:.1}H{right}\" stroke=\"#d0d7de\"/>", z = y(0.0));
        for errors in &self.errors {
            let points: Vec<_> =
                self.fine.iter().zip(errors).map(|(t, e)| [x(*t), y(*e)]).collect();
            let _ = write!(
                svg,
                "<path d=\"{}\" stroke=\"#0072b2\" stroke-width=\"1.6\" opacity=\"0.75\"/>",
                way(&points)
            );
        }
        svg.push_str("</g>");
        let _ = write!(
            svg,
            "<path d=\"M0 {top}V{bottom}\" stroke=\"#d55e00\" stroke-width=\"2\"><animateTransform \
             attributeName=\"transform\" type=\"translate\" from=\"{left} 0\" to=\"{right} 0\" dur=\"{s:.2}s\" \
             repeatCount=\"indefinite\"/></path><g fill=\"#57606a\"><text x=\"{left}\" y=\"{words}\">0 s</text><text \
             x=\"{right}\" y=\"{words}\" text-anchor=\"end\">{end} s</text><text x=\"{middle}\" y=\"{words}\" \
             text-anchor=\"middle\">error e of every joint [{unit}]{dashed}</text>",
            s = self.duration(),
            words = bottom + 22.0,
            unit = self.unit(),
            end = line(&stated(end)),
            middle = 0.5 * (left + right),
            dashed = if bound.is_some() { ", dashed: what is allowed" } else { "" },
        );
        for level in [bound.unwrap_or(0.9 * most), -bound.unwrap_or(0.9 * most)] {
            let _ = write!(
                svg,
                "<text x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>",
                left - 8.0,
                y(level) + 5.0,
                crate::kit::number::tick(level, most)
            );
        }
        svg.push_str("</g>");
    }
}

/// Points as a path.
fn way(points: &[[f64; 2]]) -> String {
    let mut text = String::new();
    for (k, [x, y]) in points.iter().enumerate() {
        let _ = write!(text, "{}{x:.1} {y:.1}", if k == 0 { "M" } else { "L" });
    }
    text
}
