//! `<compiler>` and `<option>`: how the rest is read.

use super::attributes::{AutoSetting, exactly, finite, setting, wrong};
use crate::markup::MarkupElement;
use crate::model::GRAVITY;
use crate::whole::Result;

/// Unit of the angles of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum AngleUnit {
    /// Degrees, as they are where nothing else is stated.
    Unstated,
    Degree,
    Radian,
}

/// Settings of `<compiler>`, and gravity.
#[derive(Debug, Clone)]
pub(super) struct CompilerSettings {
    pub(super) unit: AngleUnit,
    /// Axes of Euler angles, x 0, y 1, z 2, and true for each that moves with the frame.
    pub(super) sequence: [(usize, bool); 3],
    /// True if a range counts by being there.
    pub(super) autolimits: bool,
    pub(super) inertia_from_geom: AutoSetting,
    /// First and last group of geoms that count.
    pub(super) groups: (f64, f64),
    pub(super) least_mass: f64,
    pub(super) least_inertia: f64,
    pub(super) balances: bool,
    /// Mass of all bodies \[kg\].
    pub(super) total_mass: Option<f64>,
    pub(super) gravity: [f64; 3],
    /// True if bodies move in a medium.
    pub(super) has_medium: bool,
}

impl Default for CompilerSettings {
    fn default() -> Self {
        Self {
            unit: AngleUnit::Unstated,
            sequence: [(0, true), (1, true), (2, true)],
            autolimits: true,
            inertia_from_geom: AutoSetting::Auto,
            groups: (0.0, 5.0),
            least_mass: 0.0,
            least_inertia: 0.0,
            balances: false,
            total_mass: None,
            gravity: GRAVITY,
            has_medium: false,
        }
    }
}

impl CompilerSettings {
    /// Settings of all sections of a file, later ones over earlier ones.
    pub(super) fn of(root: &MarkupElement) -> Result<Self> {
        let mut settings = Self::default();
        for section in root.elements() {
            match &*section.name {
                "compiler" => settings.compiler(section)?,
                "option" => settings.option(section)?,
                _ => {}
            }
        }
        Ok(settings)
    }

    fn compiler(&mut self, section: &MarkupElement) -> Result<()> {
        match section.attribute("coordinate") {
            None | Some("local") => {}
            Some(_) => {
                let why = "global coordinates are not read, nor are they by MuJoCo since 2.3.4, which converts such a \
                    file: load and save it in an older one";
                return Err(wrong(section, why));
            }
        }
        match section.attribute("angle") {
            None => {}
            Some("degree") => self.unit = AngleUnit::Degree,
            Some("radian") => self.unit = AngleUnit::Radian,
            Some(_) => return Err(wrong(section, "\"angle\" must be degree or radian")),
        }
        if let Some(text) = section.attribute("eulerseq") {
            self.sequence = sequence(text).ok_or_else(|| {
                wrong(section, "\"eulerseq\" must be three letters of x, y, z, X, Y, Z")
            })?;
        }
        let flag = |key: &str, old: bool| -> Result<bool> {
            Ok(setting(section, key)?.map_or(old, |setting| setting == AutoSetting::True))
        };
        self.autolimits = flag("autolimits", self.autolimits)?;
        self.balances = flag("balanceinertia", self.balances)?;
        let from_geom = setting(section, "inertiafromgeom")?;
        self.inertia_from_geom = from_geom.unwrap_or(self.inertia_from_geom);
        if let Some([first, last]) = exactly(section, "inertiagrouprange")? {
            self.groups = (first, last);
        }
        let number = |key: &str, old: f64| -> Result<f64> {
            Ok(finite::<1>(section, key)?.map_or(old, |[number]| number))
        };
        self.least_mass = number("boundmass", self.least_mass)?;
        self.least_inertia = number("boundinertia", self.least_inertia)?;
        let total = number("settotalmass", self.total_mass.unwrap_or(-1.0))?;
        self.total_mass = Some(total).filter(|total| *total > 0.0);
        Ok(())
    }

    fn option(&mut self, section: &MarkupElement) -> Result<()> {
        self.gravity = finite(section, "gravity")?.unwrap_or(self.gravity);
        for key in ["density", "viscosity"] {
            let [value] = finite(section, key)?.unwrap_or([0.0]);
            self.has_medium |= value != 0.0;
        }
        for flag in section.elements().filter(|element| element.name == "flag") {
            if flag.attribute("gravity") == Some("disable") {
                self.gravity = [0.0; 3];
            }
        }
        Ok(())
    }

    /// An angle of the file in rad.
    pub(super) fn angle(&self, stated: f64) -> f64 {
        if self.unit == AngleUnit::Radian { stated } else { stated.to_radians() }
    }
}

fn sequence(text: &str) -> Option<[(usize, bool); 3]> {
    let axis = |letter: char| {
        let at = ['x', 'y', 'z'].iter().position(|x| *x == letter.to_ascii_lowercase())?;
        Some((at, letter.is_ascii_lowercase()))
    };
    let axes: Option<Vec<_>> = text.chars().map(axis).collect();
    axes?.try_into().ok()
}
