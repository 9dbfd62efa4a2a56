//! Requests that a page can make.

use std::convert::Infallible;
use std::future::Future;
use std::path::PathBuf;
use std::pin::Pin;
use std::sync::{Arc, Mutex, PoisonError};
use std::task::{Context, Poll};
use std::time::Duration;

use axum::Router;
use axum::body::{Body, to_bytes};
use axum::extract::{Request, State};
use axum::http::{HeaderValue, StatusCode, header};
use axum::middleware::{Next, from_fn_with_state};
use axum::response::{IntoResponse, Response};
use axum::routing::{get, post};
use hyper::body::{Body as _, Bytes, Frame};
use phihat_model::NamedTexts;
use phihat_report::parts;
use phihat_session::{Session, check_text, drawn_arm};
use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_json::{Value, json};
use tokio::sync::{OwnedSemaphorePermit, Semaphore, watch};

use crate::beside::Wanted;
use crate::error::StudioError;
use crate::folder::Folder;
use crate::gate::{No, PageGate};
use crate::offer::offered;
use crate::open::Open;
use crate::player::{Player, PlayerOrder};
use crate::proof::{Proof, Wish};
use crate::state::state;
use crate::text;

/// Bytes of a request's body.
const BODY_MAX: usize = 256 * 1024;
/// Time limit for a body.
const BODY: Duration = Duration::from_secs(5);
/// Pages that look on at a time.
const LIVE_MAX: usize = 8;
/// Studies that are looked at, at a time.
const CHECKS_MAX: usize = 2;

/// State that all requests share.
pub(crate) struct Shared {
    pub(crate) gate: PageGate,
    pub(crate) player: Player,
    /// `None`: a record is played, which has no gains that could be changed.
    pub(crate) proof: Option<Arc<Proof>>,
    pub(crate) folder: Folder,
    pub(crate) open: Mutex<Open>,
    live: Arc<Semaphore>,
    checks: Arc<Semaphore>,
}

fn only_looked_at() -> StudioError {
    StudioError::refused("what was recorded can only be looked at")
}

type Of = State<Arc<Shared>>;

impl Shared {
    pub(crate) fn new(
        gate: PageGate,
        player: Player,
        proof: Option<Arc<Proof>>,
        folder: Folder,
        open: Open,
    ) -> Arc<Self> {
        let (live, checks) = (Semaphore::new(LIVE_MAX), Semaphore::new(CHECKS_MAX));
        let open = Mutex::new(open);
        Arc::new(Self {
            gate,
            player,
            proof,
            folder,
            open,
            live: live.into(),
            checks: checks.into(),
        })
    }

    fn opened(&self) -> Open {
        self.open.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
}

/// All that is answered.
pub(crate) fn router(shared: Arc<Shared>) -> Router {
    let asset =
        |kind: &'static str, text: &'static str| get(move || async move { typed(kind, text) });
    let script = "text/javascript; charset=utf-8";
    let style = style();
    Router::new()
        .route(
            "/",
            get(|| async {
                typed("text/html; charset=utf-8", include_str!("../assets/studio.html"))
            }),
        )
        .route("/studio.js", asset(script, include_str!("../assets/studio.js")))
        .route("/visit.js", asset(script, include_str!("../assets/visit.js")))
        .route("/film.js", asset(script, include_str!("../assets/film.js")))
        .route("/arm.js", asset(script, parts::ARM_SCRIPT))
        .route("/plot.js", asset(script, parts::PLOT_SCRIPT))
        .route("/studio.css", asset("text/css; charset=utf-8", style))
        .route("/favicon.ico", get(|| async { StatusCode::NO_CONTENT }))
        .route("/state", get(tell_state))
        .route("/live", get(look_on))
        .route("/proof", get(tell_proof))
        .route("/schema", get(|| async { typed("application/json", schema()) }))
        .route("/meet", post(meet))
        .route("/run", post(run))
        .route("/gains", post(gains))
        .route("/beside", post(beside))
        .route("/late", post(late))
        .route("/seek", post(seek))
        .route("/check", post(check))
        .route("/open", post(open))
        .route("/save", post(save))
        .fallback(|| async { refuse(StatusCode::NOT_FOUND, "nothing is here") })
        .layer(from_fn_with_state(Arc::clone(&shared), gated))
        .with_state(shared)
}

/// The styles of all pages.
fn style() -> &'static str {
    static STYLE: std::sync::OnceLock<String> = std::sync::OnceLock::new();
    STYLE.get_or_init(parts::style)
}

fn typed(kind: &'static str, text: &'static str) -> Response {
    ([(header::CONTENT_TYPE, kind)], text).into_response()
}

fn answer(value: &Value) -> Response {
    ([(header::CONTENT_TYPE, "application/json")], value.to_string()).into_response()
}

fn refuse(status: StatusCode, why: &str) -> Response {
    let mut response = answer(&json!({ "error": why }));
    *response.status_mut() = status;
    response
}

fn answered(done: Result<Value, StudioError>) -> Response {
    match done {
        Ok(value) => answer(&value),
        Err(why) => refuse(StatusCode::UNPROCESSABLE_ENTITY, &why.to_string()),
    }
}

/// Nothing is loaded from elsewhere, framed, kept, or told to others.
const SAFE: [(&str, &str); 6] = [
    (
        "content-security-policy",
        "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; base-uri 'none'; form-action \
            'none'; frame-ancestors 'none'",
    ),
    ("x-content-type-options", "nosniff"),
    ("referrer-policy", "no-referrer"),
    ("cross-origin-opener-policy", "same-origin"),
    ("cross-origin-resource-policy", "same-origin"),
    ("cache-control", "no-store"),
];

async fn gated(State(shared): Of, request: Request, next: Next) -> Response {
    let let_in = shared.gate.lets(request.method(), request.uri(), request.headers());
    let mut response = match let_in {
        Ok(()) => next.run(request).await,
        Err(No(status, why)) => refuse(status, why),
    };
    for (name, value) in SAFE {
        response.headers_mut().insert(name, HeaderValue::from_static(value));
    }
    response
}

/// The document of a request, where it is one of this shape and came in time.
async fn document<T: DeserializeOwned>(request: Request) -> Result<T, Response> {
    let most = u64::try_from(BODY_MAX).unwrap_or(u64::MAX);
    if request.body().size_hint().lower() > most {
        return Err(refuse(StatusCode::PAYLOAD_TOO_LARGE, "256 kB are taken"));
    }
    let read = tokio::time::timeout(BODY, to_bytes(request.into_body(), BODY_MAX)).await;
    let Ok(read) = read else {
        return Err(refuse(StatusCode::REQUEST_TIMEOUT, "the body takes too long"));
    };
    let Ok(bytes) = read else {
        return Err(refuse(StatusCode::PAYLOAD_TOO_LARGE, "256 kB are taken"));
    };
    serde_json::from_slice(&bytes).map_err(|why| refuse(StatusCode::BAD_REQUEST, &why.to_string()))
}

async fn tell_state(State(shared): Of) -> Response {
    answer(&state(&shared.opened()))
}

/// The schema of a study, from which an editor completes keys.
fn schema() -> &'static str {
    static SCHEMA: std::sync::OnceLock<String> = std::sync::OnceLock::new();
    SCHEMA.get_or_init(phihat_study::schema)
}

/// Reports the result for the gains that were requested last.
async fn tell_proof(State(shared): Of) -> Response {
    let text = shared.proof.as_ref().map_or_else(|| "{}".to_owned(), |proof| proof.told());
    ([(header::CONTENT_TYPE, "application/json")], text).into_response()
}

/// Fault on the arm: an offer, its joint, its size; no size: it ends.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Meet {
    what: String,
    joint: Option<usize>,
    size: Option<f64>,
}

async fn meet(State(shared): Of, request: Request) -> Response {
    let Meet { what, joint, size } = match document(request).await {
        Ok(asked) => asked,
        Err(no) => return no,
    };
    let Some(offer) = offered(&what) else {
        return refuse(StatusCode::UNPROCESSABLE_ENTITY, "nothing of this name is on offer");
    };
    answered(shared.player.ask(PlayerOrder::Meet(offer, joint, size)).await)
}

/// Speed over real time; or the run begins again, is stopped, or begins again under a supervisor.
#[derive(Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
enum RunRequest {
    Speed(f64),
    Again(bool),
    Stop(bool),
    Supervise(bool),
}

/// So many times real time at most.
const SPEED_MAX: f64 = 10.0;

async fn run(State(shared): Of, request: Request) -> Response {
    let order = match document(request).await {
        Ok(RunRequest::Again(true)) => PlayerOrder::Again,
        Ok(RunRequest::Stop(true)) => PlayerOrder::Stop,
        Ok(RunRequest::Supervise(true)) => return answered(supervised(&shared).await),
        Ok(RunRequest::Speed(speed)) if (0.0..=SPEED_MAX).contains(&speed) => {
            PlayerOrder::Speed(speed)
        }
        Ok(_) => return refuse(StatusCode::UNPROCESSABLE_ENTITY, "a speed is 0 to 10"),
        Err(no) => return no,
    };
    answered(shared.player.ask(order).await)
}

/// Puts a supervisor around the law of a study that has none, with every key at its default; the study's text says so
/// from then on.
async fn supervised(shared: &Shared) -> Result<Value, StudioError> {
    let mut open = shared.opened();
    if open.study.supervisor.is_some() {
        return Err(StudioError::refused("a supervisor is around the law already"));
    }
    let own = text::study(&text::with_supervisor(&open.study)?, &open.path)?;
    let study = &mut open.study;
    study.supervisor.clone_from(&own.supervisor);
    study.world.held.clone_from(&own.world.held);
    (study.text, study.sha256) = (own.text, own.sha256);
    let done = shared.player.ask(PlayerOrder::Supervise(study.clone())).await?;
    *shared.open.lock().unwrap_or_else(PoisonError::into_inner) = open;
    Ok(done)
}

async fn gains(State(shared): Of, request: Request) -> Response {
    let wish: Wish = match document(request).await {
        Ok(wish) => wish,
        Err(no) => return no,
    };
    let asked = shared.proof.as_ref().ok_or_else(only_looked_at).and_then(|proof| proof.ask(wish));
    answered(asked.map(|number| json!({ "ask": number })))
}

/// Another law beside phihat's, or none.
async fn beside(State(shared): Of, request: Request) -> Response {
    let wanted: Wanted = match document(request).await {
        Ok(wanted) => wanted,
        Err(no) => return no,
    };
    match wanted.beside() {
        Ok(law) => answered(shared.player.ask(PlayerOrder::Beside(law)).await),
        Err(why) => answered(Err(why)),
    }
}

/// By how many samples measurements come late.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Late {
    samples: u32,
}

async fn late(State(shared): Of, request: Request) -> Response {
    let Late { samples } = match document(request).await {
        Ok(late) => late,
        Err(no) => return no,
    };
    answered(shared.player.ask(PlayerOrder::Late(samples)).await)
}

/// A time of a record \[s\].
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Seek {
    t: f64,
}

async fn seek(State(shared): Of, request: Request) -> Response {
    let Seek { t } = match document(request).await {
        Ok(seek) => seek,
        Err(no) => return no,
    };
    answered(shared.player.ask(PlayerOrder::Seek(t)).await)
}

/// A study's text.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct PageText {
    text: String,
}

/// Something that takes long, where few do already.
async fn aside<T: Send + 'static>(
    shared: &Shared,
    work: impl FnOnce() -> T + Send + 'static,
) -> Result<T, Response> {
    let busy = || refuse(StatusCode::SERVICE_UNAVAILABLE, "other studies are being looked at");
    let Ok(held) = Arc::clone(&shared.checks).try_acquire_owned() else { return Err(busy()) };
    let done = tokio::task::spawn_blocking(move || {
        let done = work();
        drop(held);
        done
    });
    done.await.map_err(|_| refuse(StatusCode::INTERNAL_SERVER_ERROR, "phihat failed at it: a bug"))
}

async fn check(State(shared): Of, request: Request) -> Response {
    let PageText { text } = match document(request).await {
        Ok(asked) => asked,
        Err(no) => return no,
    };
    if let Err(why) = shared.folder.holds(&text) {
        return answered(Err(why));
    }
    let path = shared.opened().path;
    let looked = aside(&shared, move || check_text(&text, &path, &NamedTexts::DISK)).await;
    match looked {
        Ok(looked) => answer(&json!({ "errors": looked.errors, "warnings": looked.warnings })),
        Err(no) => no,
    }
}

async fn open(State(shared): Of, request: Request) -> Response {
    let PageText { text } = match document(request).await {
        Ok(asked) => asked,
        Err(no) => return no,
    };
    if let Err(why) = shared.folder.holds(&text) {
        return answered(Err(why));
    }
    let path = shared.opened().path;
    let within = shared.folder.clone();
    let opened = match aside(&shared, move || opened(&text, path, &within)).await {
        Ok(Ok(opened)) => opened,
        Ok(Err(why)) => return answered(Err(why)),
        Err(no) => return no,
    };
    let (Some(begin), Some(proof)) = (opened.begin(), &shared.proof) else {
        return answered(Err(only_looked_at()));
    };
    let begun = shared.player.ask(PlayerOrder::Other(Box::new(begin.clone()))).await;
    if begun.is_ok() {
        proof.turn_to(begin);
        *shared.open.lock().unwrap_or_else(PoisonError::into_inner) = opened;
    }
    answered(begun)
}

/// A study's text, ready to be run; its gains are designed where it leaves them to the design. The shapes of its
/// arm are read within the working folder alone.
fn opened(text: &str, path: PathBuf, within: &Folder) -> Result<Open, StudioError> {
    let study = text::study(text, &path)?;
    let session = Session::new(study, &path, None, false)?;
    let warnings = session.warnings().to_vec();
    let (study, gains) = session.into_parts();
    let arm = Box::new(drawn_arm(&study, Some(within.path())));
    Ok(Open { study, arm, gains: Some(gains), warnings, path, played: None })
}

/// A name for what came of a run.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Save {
    name: String,
    /// Another text than that of the run: what stands in the editor.
    text: Option<String>,
}

async fn save(State(shared): Of, request: Request) -> Response {
    let Save { name, text } = match document(request).await {
        Ok(asked) => asked,
        Err(no) => return no,
    };
    answered(saved(&shared, &name, text).await)
}

async fn saved(shared: &Shared, name: &str, text: Option<String>) -> Result<Value, StudioError> {
    let place = shared.folder.place(name)?;
    let mut all = Vec::new();
    let mut command = format!("phihat run {name}.toml");
    if let Some(text) = text {
        all.push((place, text));
    } else {
        let came = shared.player.ask(PlayerOrder::Tell).await?;
        let open = shared.opened();
        all.push((place.clone(), text::with_what_came(&open.study.text, &came)));
        let taken = shared.proof.as_ref().and_then(|proof| proof.taken());
        // A design would know of measurements that come late.
        let kept = open.gains.filter(|_| came["late"].is_u64());
        if let Some(gains) = taken.or(kept) {
            let gains = gains.to_json().map_err(|why| StudioError::refused(why.to_string()))?;
            all.push((place.with_extension("gains.json"), gains));
            command = format!("{command} --gains {name}.gains.json");
        }
    }
    shared.folder.write(&all)?;
    Ok(json!({ "saved": format!("{name}.toml"), "command": command }))
}

/// Pictures as they come.
async fn look_on(State(shared): Of) -> Response {
    let Ok(held) = Arc::clone(&shared.live).try_acquire_owned() else {
        return refuse(StatusCode::SERVICE_UNAVAILABLE, "eight pages look on already");
    };
    let events = EventStream { frames: shared.player.frames.clone(), _held: held };
    let body = Body::new(Stream { next: Box::pin(events.next()) });
    ([(header::CONTENT_TYPE, "text/event-stream")], body).into_response()
}

/// Stream of pictures to one page. Of pictures that it is too slow for, it gets the last one.
struct EventStream {
    frames: watch::Receiver<Arc<str>>,
    _held: OwnedSemaphorePermit,
}

impl EventStream {
    async fn next(mut self) -> (Option<Bytes>, Self) {
        let bytes = match self.frames.changed().await {
            Ok(()) => Some(Bytes::from(format!("data: {}\n\n", &*self.frames.borrow_and_update()))),
            Err(_) => None,
        };
        (bytes, self)
    }
}

type Following = Pin<Box<dyn Future<Output = (Option<Bytes>, EventStream)> + Send>>;

/// The body of a response that goes on.
struct Stream {
    next: Following,
}

impl hyper::body::Body for Stream {
    type Data = Bytes;
    type Error = Infallible;

    fn poll_frame(
        mut self: Pin<&mut Self>,
        cx: &mut Context<'_>,
    ) -> Poll<Option<Result<Frame<Bytes>, Infallible>>> {
        match self.next.as_mut().poll(cx) {
            Poll::Pending => Poll::Pending,
            Poll::Ready((None, _)) => Poll::Ready(None),
            Poll::Ready((Some(bytes), events)) => {
                self.next = Box::pin(events.next());
                Poll::Ready(Some(Ok(Frame::data(bytes))))
            }
        }
    }
}
