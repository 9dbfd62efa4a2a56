//! Numbers that vary from run to run, and the distributions of their values.

use phihat_session::share;
use phihat_study::{NumericKey, Study};
use toml::Table;

use super::error::SweepError;

/// Origin of a key in messages: the option of the command line.
const ORIGIN: &str = "--vary";

/// Draws of a normal distribution until one is a number that the study may have.
const TRIES: u32 = 1000;

/// A number of a study and how it varies: `KEY=HOW`.
///
/// | how | drawn |
/// |---|---|
/// | `0..2` | evenly between both; of a key of integers, evenly among them, both included |
/// | `log:0.1..10` | evenly on a logarithmic scale |
/// | `normal:1.5,0.2` | normal: mean, standard deviation; again where the study may not have the number |
/// | `0.5,1,2` | one of these |
/// | `times:HOW` | what the study says there, times a number drawn so |
#[derive(Debug, Clone)]
pub struct Vary {
    key: NumericKey,
    how: How,
    times: bool,
    text: String,
}

#[derive(Debug, Clone, PartialEq)]
enum How {
    Even(f64, f64),
    Log(f64, f64),
    Normal(f64, f64),
    OneOf(Vec<f64>),
}

impl Vary {
    /// Reads `KEY=HOW` for a study.
    ///
    /// # Errors
    ///
    /// [`SweepError`]: the study has no such number, or it cannot vary so.
    pub fn read(study: &Study, text: &str) -> Result<Self, SweepError> {
        let wrong = |why: String| SweepError::Vary { text: text.to_owned(), why };
        let Some((path, rest)) = text.split_once('=') else {
            return Err(wrong("write KEY=RANGE, as in world.payload.mass_kg=0..2".to_owned()));
        };
        let key = NumericKey::find(study, path.trim(), ORIGIN)?;
        let fixed = match key.section() {
            "design" => Some(
                "gains are made once, before the sweep: what they are designed for does not vary",
            ),
            "" if key.path() == "seed" => {
                Some("every run has a seed of its own; --seed decides all of them")
            }
            _ => None,
        };
        if let Some(why) = fixed {
            return Err(wrong(why.to_owned()));
        }
        let rest = rest.trim();
        let (times, words) = match rest.strip_prefix("times:") {
            Some(words) => (true, words),
            None => (false, rest),
        };
        let how = how(words).ok_or_else(|| {
            wrong(format!(
                "`{words}` is no range; write 0..2, log:0.1..10, normal:MEAN,SD or a list such as 0.5,1,2"
            ))
        })?;
        let vary = Self { key, how, times, text: format!("{}={rest}", path.trim()) };
        match vary.misfit(study) {
            Some(why) => Err(wrong(why)),
            None => Ok(vary),
        }
    }

    /// Why it cannot vary so, if it cannot.
    fn misfit(&self, study: &Study) -> Option<String> {
        let Self { key, how, times, .. } = self;
        let why = match how {
            How::Even(low, high) | How::Log(low, high) if low >= high => {
                format!("the range goes from {low} up to {high}: the smaller end comes first")
            }
            How::Log(low, _) if *low <= 0.0 => "a logarithmic range begins above 0".to_owned(),
            How::Normal(_, deviation) if *deviation <= 0.0 => {
                format!("the standard deviation is {deviation}; it is above 0")
            }
            How::Log(..) | How::Normal(..) if key.is_integer() => {
                "an integer: write a range such as 0..3, or a list".to_owned()
            }
            _ if *times && key.is_integer() => {
                "an integer is not multiplied: write its values".to_owned()
            }
            _ if *times => {
                let table: Table = study.table().unwrap_or_default();
                let nothing = "the study has no number there to multiply";
                return key.numbers(&table).is_empty().then(|| nothing.to_owned());
            }
            _ => {
                let end = self.ends().into_iter().find(|end| !key.admits(*end))?;
                let unit = if key.unit().is_empty() { "" } else { " " };
                format!("{end}{unit}{} is not possible there: {}", key.unit(), key.range())
            }
        };
        Some(why)
    }

    /// The key.
    pub fn key(&self) -> &NumericKey {
        &self.key
    }

    /// As it was written.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The unit of what is drawn; a factor has none.
    pub fn unit(&self) -> &'static str {
        if self.times { "" } else { self.key.unit() }
    }

    /// Name in tables: the key, or `times` and the key.
    pub fn name(&self) -> String {
        if self.times { format!("times {}", self.key.path()) } else { self.key.path().to_owned() }
    }

    /// The values that every run lies between, or all that there are; of a normal distribution its mean.
    pub(crate) fn ends(&self) -> Vec<f64> {
        match &self.how {
            How::Even(low, high) if !self.times && self.key.begins_above(*low) => vec![*high],
            How::Even(low, high) | How::Log(low, high) => vec![*low, *high],
            How::Normal(mean, _) => vec![*mean],
            How::OneOf(all) => all.clone(),
        }
    }

    /// The value of a run: of the sweep's seed, the run's place and the key alone.
    pub(crate) fn draw(&self, seed: u64, run: u64) -> f64 {
        let name = format!("{seed}/{run}");
        let share = |word: &str| share(&name, &format!("{}{word}", self.key.path()));
        match &self.how {
            How::Even(low, high) if self.key.is_integer() => {
                (low + (share("") * (high - low + 1.0)).floor()).min(*high)
            }
            // Above the lower end, which the study may not have.
            How::Even(low, high) => high - (high - low) * share(""),
            How::Log(low, high) => {
                (low * libm::exp(share("") * libm::log(high / low))).clamp(*low, *high)
            }
            How::OneOf(all) => {
                let (drawn, count) = (share(""), all.len() as f64);
                let place = (1..all.len()).find(|place| drawn < *place as f64 / count);
                let place = place.unwrap_or(all.len()).saturating_sub(1);
                all.get(place).copied().unwrap_or(f64::NAN)
            }
            How::Normal(mean, deviation) => {
                let fits = |x: &f64| self.times || self.key.admits(*x);
                let mut draws = (0..TRIES).map(|k| {
                    // Box and Muller; the logarithm of zero is not taken.
                    let (u, v) = (1.0 - share(&format!("/{k}/u")), share(&format!("/{k}/v")));
                    let angle = core::f64::consts::TAU * v;
                    mean + deviation * libm::sqrt(-2.0 * libm::log(u)) * libm::cos(angle)
                });
                draws.find(fits).unwrap_or(*mean)
            }
        }
    }

    /// Puts a value into the table of a study.
    pub(crate) fn put(&self, table: &mut Table, value: f64) {
        if self.times {
            self.key.scale(table, value);
        } else {
            self.key.put(table, value);
        }
    }
}

fn how(words: &str) -> Option<How> {
    let pair = |words: &str, between: &str| {
        let (a, b) = words.split_once(between)?;
        Some((number(a)?, number(b)?))
    };
    if let Some(words) = words.strip_prefix("log:") {
        return pair(words, "..").map(|(low, high)| How::Log(low, high));
    }
    if let Some(words) = words.strip_prefix("normal:") {
        return pair(words, ",").map(|(mean, deviation)| How::Normal(mean, deviation));
    }
    if words.contains("..") {
        return pair(words, "..").map(|(low, high)| How::Even(low, high));
    }
    words.split(',').map(number).collect::<Option<Vec<_>>>().map(How::OneOf)
}

fn number(text: &str) -> Option<f64> {
    text.trim().parse().ok().filter(|x: &f64| x.is_finite())
}
