//! Access control: by Host, Origin, key and rate, before anything is read.

use std::sync::Mutex;

use axum::http::{HeaderMap, Method, StatusCode, Uri, header};
use tokio::time::Instant;

/// Requests per second that are answered, and how many more at once.
const RATE: f64 = 100.0;
const BURST: f64 = 200.0;

/// Conditions that a request must satisfy.
#[derive(Debug)]
pub(crate) struct PageGate {
    hosts: [String; 3],
    key: String,
    left: Mutex<(f64, Instant)>,
}

/// Why a request is not answered.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct No(pub(crate) StatusCode, pub(crate) &'static str);

impl PageGate {
    /// For a port of this machine, and a key that only its user is told.
    pub(crate) fn new(port: u16, key: String) -> Self {
        let hosts = ["127.0.0.1", "localhost", "[::1]"].map(|host| format!("{host}:{port}"));
        Self { hosts, key, left: Mutex::new((BURST, Instant::now())) }
    }

    /// Checks that a request may go on.
    pub(crate) fn lets(&self, method: &Method, uri: &Uri, headers: &HeaderMap) -> Result<(), No> {
        self.host(uri, headers)?;
        // After it: a page of another origin does not use up what ours may ask.
        if !self.in_time() {
            return Err(No(StatusCode::TOO_MANY_REQUESTS, "too many requests"));
        }
        let path = uri.path();
        match *method {
            Method::GET
                if matches!(
                    path,
                    "/studio.js"
                        | "/visit.js"
                        | "/film.js"
                        | "/studio.css"
                        | "/arm.js"
                        | "/plot.js"
                        | "/favicon.ico"
                ) =>
            {
                return Ok(());
            }
            Method::GET => {}
            Method::POST => {
                let kind = single(headers, header::CONTENT_TYPE.as_str());
                let json = |kind: &str| {
                    kind.split(';').next().is_some_and(|kind| kind.trim() == "application/json")
                };
                if !kind.is_some_and(json) {
                    return Err(No(StatusCode::UNSUPPORTED_MEDIA_TYPE, "JSON is taken"));
                }
            }
            _ => return Err(No(StatusCode::METHOD_NOT_ALLOWED, "GET and POST are answered")),
        }
        if self.has_key(uri, headers) {
            Ok(())
        } else {
            Err(No(StatusCode::FORBIDDEN, "open the address that phihat printed: it has the key"))
        }
    }

    /// One Host, ours; and no page of another origin behind it.
    fn host(&self, uri: &Uri, headers: &HeaderMap) -> Result<(), No> {
        let ours = |host: &str| self.hosts.iter().any(|own| own == host);
        let host = single(headers, header::HOST.as_str());
        let told = uri.authority().is_none_or(|authority| ours(authority.as_str()));
        if !host.is_some_and(ours) || !told {
            return Err(No(StatusCode::MISDIRECTED_REQUEST, "this host is not served"));
        }
        if headers.contains_key(header::ORIGIN) {
            let origin = single(headers, header::ORIGIN.as_str());
            if !origin.and_then(|origin| origin.strip_prefix("http://")).is_some_and(ours) {
                return Err(No(StatusCode::FORBIDDEN, "another origin"));
            }
        }
        if headers.contains_key("sec-fetch-site") {
            let site = single(headers, "sec-fetch-site");
            if !matches!(site, Some("same-origin" | "none")) {
                return Err(No(StatusCode::FORBIDDEN, "another site"));
            }
        }
        Ok(())
    }

    /// Compared to its end, wherever it differs.
    fn has_key(&self, uri: &Uri, headers: &HeaderMap) -> bool {
        let mut words = uri.query().unwrap_or("").split('&');
        let asked = words.find_map(|word| word.strip_prefix("key="));
        let given = single(headers, "x-phihat-key").or(asked).unwrap_or("").as_bytes();
        let own = self.key.as_bytes();
        given.len() == own.len() && given.iter().zip(own).fold(0, |all, (a, b)| all | (a ^ b)) == 0
    }

    fn in_time(&self) -> bool {
        let Ok(mut left) = self.left.lock() else { return false };
        let now = Instant::now();
        let more = RATE * now.duration_since(left.1).as_secs_f64();
        *left = ((left.0 + more).min(BURST), now);
        let enough = left.0 >= 1.0;
        if enough {
            left.0 -= 1.0;
        }
        enough
    }
}

/// The value of a header that is there once.
fn single<'a>(headers: &'a HeaderMap, name: &str) -> Option<&'a str> {
    let mut all = headers.get_all(name).iter();
    let first = all.next()?;
    if all.next().is_some() { None } else { first.to_str().ok() }
}
