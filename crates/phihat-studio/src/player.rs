//! The thread on which a run goes on, in real time; orders act between two samples.

use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, TrySendError, sync_channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use phihat_study::Study;
use serde::Serialize;
use serde_json::{Value, json};
use tokio::sync::{oneshot, watch};

use crate::begin::Begin;
use crate::beside::AlongsideLaw;
use crate::error::StudioError;
use crate::offer::Offer;
use crate::sampled::Sampled;
use crate::stage::Stage;

/// From one look at the orders to the next.
const TICK: Duration = Duration::from_millis(4);
/// From one picture to the next: 40 per second.
const FRAME: Duration = Duration::from_millis(25);
/// A run that is so far behind real time gives up catching up.
const BEHIND: f64 = 0.2;
/// Orders that may wait.
const ORDERS_MAX: usize = 64;

/// Order to a run.
pub(crate) enum PlayerOrder {
    /// An offer acts on a joint with a size, or ends.
    Meet(&'static Offer, Option<usize>, Option<f64>),
    /// So many times real time; 0 waits.
    Speed(f64),
    /// A safe stop of the supervisor.
    Stop,
    /// From the start again, with the supervisor of this study around the law, and what acts.
    Supervise(Box<Study>),
    /// From the start again, with these gains and nothing that came.
    Again,
    /// These gains from the next sample on.
    Gains(Box<Begin>),
    /// Another study, from its start.
    Other(Box<Begin>),
    /// Another law beside this one, or none.
    Beside(Option<AlongsideLaw>),
    /// Measurements come so many samples late.
    Late(u32),
    /// A record goes to a time \[s\].
    Seek(f64),
    /// Report of the sections that came, for a study of this run.
    Tell,
}

/// An order with who waits for what came of it.
struct PendingOrder {
    order: PlayerOrder,
    answer: oneshot::Sender<Result<Value, StudioError>>,
}

/// Sender of orders to the thread.
#[derive(Debug, Clone)]
pub(crate) struct Player {
    orders: SyncSender<PendingOrder>,
    pub(crate) frames: watch::Receiver<Arc<str>>,
}

/// Least and largest since the last picture.
#[derive(Debug, Clone, Copy, Serialize)]
struct PictureRange(f64, f64);

impl PictureRange {
    const NONE: Self = Self(f64::INFINITY, f64::NEG_INFINITY);

    fn take(&mut self, x: f64) {
        *self = Self(if x < self.0 { x } else { self.0 }, if x > self.1 { x } else { self.1 });
    }
}

/// Values of one joint in a picture.
#[derive(Debug, Clone, Copy, Serialize)]
struct JointPicture {
    q: f64,
    qd: f64,
    e: PictureRange,
    tau: PictureRange,
    phi: f64,
}

/// One picture, as a page gets it.
#[derive(Debug, Serialize)]
struct PlayerFrame<'a> {
    /// Its number.
    n: u64,
    t: f64,
    joints: &'a [JointPicture],
    /// The same of the arm under the other law, while that goes on.
    other: Option<&'a [JointPicture]>,
    other_over: Option<&'a str>,
    acting: Vec<(&'static str, Option<usize>, f64)>,
    /// Mode of the supervisor; absent: there is none.
    mode: Option<&'static str>,
    /// So many times real time: asked for, and reached.
    speed: (f64, f64),
    over: Option<String>,
}

impl Player {
    /// Begins the thread.
    pub(crate) fn begin(stage: Stage) -> Result<(Self, JoinHandle<()>), StudioError> {
        let (orders, asked) = sync_channel(ORDERS_MAX);
        let (told, frames) = watch::channel(Arc::from("{}"));
        let mut run = StageRun::new(stage, told);
        let thread = std::thread::Builder::new().name("phihat-run".to_owned());
        let thread = thread.spawn(move || run.go_on(&asked));
        let thread = thread.map_err(|why| StudioError::refused(why.to_string()))?;
        Ok((Self { orders, frames }, thread))
    }

    /// Gives an order, and waits for what comes of it.
    pub(crate) async fn ask(&self, order: PlayerOrder) -> Result<Value, StudioError> {
        let (answer, answered) = oneshot::channel();
        match self.orders.try_send(PendingOrder { order, answer }) {
            Ok(()) => {}
            Err(TrySendError::Full(_)) => {
                return Err(StudioError::refused("too many orders wait: slower, please"));
            }
            Err(TrySendError::Disconnected(_)) => {
                return Err(StudioError::refused("the run is gone"));
            }
        }
        answered.await.unwrap_or_else(|_| Err(StudioError::refused("the run is gone")))
    }

    /// Gives an order from a thread that may wait; whether it was obeyed at once.
    pub(crate) fn order(&self, order: PlayerOrder) -> bool {
        let (answer, answered) = oneshot::channel();
        let given = self.orders.try_send(PendingOrder { order, answer }).is_ok();
        let done = if given { answered.blocking_recv().ok() } else { None };
        done.is_some_and(|done| done.is_ok_and(|value| value["now"] == true))
    }
}

/// Stage and its clock.
struct StageRun {
    stage: Stage,
    told: watch::Sender<Arc<str>>,
    shown: Vec<JointPicture>,
    /// Of the other law; whether there was a sample of it since the last picture.
    beside: (Vec<JointPicture>, bool),
    n: u64,
    speed: f64,
    over: Option<String>,
    /// Real time, and the run's, from which both are counted.
    anchor: (Instant, f64),
    /// The same at the last picture.
    pictured: (Instant, f64),
    reached: f64,
}

#[expect(clippy::disallowed_methods, reason = "real time is its subject")]
fn now() -> Instant {
    Instant::now()
}

impl StageRun {
    fn new(stage: Stage, told: watch::Sender<Arc<str>>) -> Self {
        let start = (now(), 0.0);
        let shown = vec![JointPicture::NONE; stage.joints()];
        Self {
            beside: (shown.clone(), false),
            shown,
            stage,
            told,
            n: 0,
            speed: 1.0,
            over: None,
            anchor: start,
            pictured: start,
            reached: 0.0,
        }
    }

    /// Until nobody gives orders any more.
    fn go_on(&mut self, orders: &Receiver<PendingOrder>) {
        loop {
            match orders.recv_timeout(TICK) {
                Ok(PendingOrder { order, answer }) => {
                    // Whoever asked may be gone.
                    let _ = answer.send(self.obey(order));
                }
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => return,
            }
            self.catch_up();
            if self.pictured.0.elapsed() >= FRAME {
                self.picture();
            }
        }
    }

    fn anchor_now(&mut self) {
        self.anchor = (now(), self.stage.time());
    }

    /// Its time is another than it would be: it goes on from there.
    fn jumped(&mut self) {
        self.over = None;
        self.anchor_now();
        self.pictured.1 = self.stage.time();
    }

    fn obey(&mut self, order: PlayerOrder) -> Result<Value, StudioError> {
        match order {
            PlayerOrder::Meet(offer, joint, size) => self.stage.pair()?.meet(offer, joint, size),
            PlayerOrder::Speed(speed) => {
                self.speed = speed;
                self.anchor_now();
                Ok(json!({ "speed": speed }))
            }
            PlayerOrder::Gains(begin) => {
                let runs = self.over.is_none();
                self.stage.pair()?.gains(*begin, runs)
            }
            PlayerOrder::Stop => self.stage.pair()?.stop(),
            PlayerOrder::Supervise(study) => {
                let done = self.stage.pair()?.supervise(&study)?;
                self.jumped();
                Ok(done)
            }
            PlayerOrder::Tell => Ok(self.stage.pair()?.tell()),
            PlayerOrder::Again => {
                self.stage.again()?;
                self.jumped();
                Ok(json!({ "t": 0.0 }))
            }
            PlayerOrder::Beside(law) => {
                let done = self.stage.pair()?.beside(law)?;
                self.jumped();
                Ok(done)
            }
            PlayerOrder::Late(samples) => {
                let done = self.stage.pair()?.late(samples)?;
                self.jumped();
                Ok(done)
            }
            PlayerOrder::Seek(t) => {
                self.stage.seek(t)?;
                self.jumped();
                // It is seen where it stands still, too, and what was before is not.
                for shown in &mut self.shown {
                    (shown.e, shown.tau) = (PictureRange::NONE, PictureRange::NONE);
                }
                if let Some((rows, _)) = self.stage.step() {
                    self.shown.iter_mut().zip(rows).for_each(|(shown, row)| shown.take(row));
                }
                Ok(json!({ "t": self.stage.time() }))
            }
            PlayerOrder::Other(begin) => {
                self.stage.pair()?;
                let next = Self::new(Stage::live(*begin)?, self.told.clone());
                *self = Self { n: self.n, ..next };
                Ok(json!({ "t": 0.0 }))
            }
        }
    }

    /// Goes on to where real time is.
    fn catch_up(&mut self) {
        if self.over.is_some() || self.speed <= 0.0 {
            return;
        }
        let due = self.anchor.1 + self.speed * self.anchor.0.elapsed().as_secs_f64();
        let began = now();
        loop {
            if self.stage.time() > due {
                break;
            }
            let Some((rows, beside)) = self.stage.step() else {
                match self.stage.round() {
                    Ok(()) => self.jumped(),
                    Err(why) => self.over = Some(why.to_string()),
                }
                return;
            };
            self.shown.iter_mut().zip(rows).for_each(|(shown, row)| shown.take(row));
            if let Some(rows) = beside {
                self.beside.0.iter_mut().zip(rows).for_each(|(shown, row)| shown.take(row));
                self.beside.1 = true;
            }
            if began.elapsed() > TICK * 4 {
                break;
            }
        }
        if due - self.stage.time() > BEHIND * self.speed {
            self.anchor_now();
        }
    }

    fn picture(&mut self) {
        let (since, from) = self.pictured;
        let elapsed = since.elapsed().as_secs_f64();
        let rate = (self.stage.time() - from) / elapsed.max(1e-6);
        self.reached += 0.1 * (rate - self.reached);
        self.pictured = (now(), self.stage.time());
        self.n += 1;
        let frame = PlayerFrame {
            n: self.n,
            t: self.stage.time(),
            joints: &self.shown,
            other: self.beside.1.then_some(self.beside.0.as_slice()),
            other_over: self.stage.other_is_over(),
            acting: self.stage.acting(),
            mode: self.stage.mode(),
            speed: (self.speed, self.reached),
            over: self.over.clone(),
        };
        let text = serde_json::to_string(&frame).unwrap_or_default();
        self.told.send_replace(Arc::from(text));
        for shown in self.shown.iter_mut().chain(&mut self.beside.0) {
            (shown.e, shown.tau) = (PictureRange::NONE, PictureRange::NONE);
        }
        self.beside.1 = false;
    }
}

impl JointPicture {
    const NONE: Self =
        Self { q: 0.0, qd: 0.0, e: PictureRange::NONE, tau: PictureRange::NONE, phi: 0.0 };

    fn take(&mut self, at: &Sampled) {
        (self.q, self.qd, self.phi) = (at.q, at.q_d, at.phi_hat);
        self.e.take(at.e);
        self.tau.take(at.tau);
    }
}
