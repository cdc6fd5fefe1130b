//! The server: requests in, answers out.

use std::io;
use std::net::{Ipv4Addr, Shutdown, SocketAddr, TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::thread::JoinHandle;

use serde_json::{Value, json};

use crate::door::{Caller, Verdict, cookie, verdict};
use crate::http::{Answer, Bad, Request};
use crate::{Desk, News, Reply, Token, assets, news, page};

/// Connections at a time, those that news go over included.
const CONNECTIONS: usize = 128;
/// Ports that are tried behind the first one.
const PORTS: u16 = 100;

/// What a page of the studio may load and reach: itself.
const POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:; \
                      connect-src 'self'; frame-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";
/// A page of a run is of another origin, for a run may be a stranger's: its scripts reach nothing of the studio.
const APART: &str = "sandbox allow-scripts allow-downloads allow-modals; frame-ancestors 'self'";

/// A server that is ready but does not answer yet.
#[derive(Debug)]
pub struct Server {
    listener: TcpListener,
    port: u16,
    token: Token,
    news: News,
}

/// A server that answers until it is dropped.
#[derive(Debug)]
pub struct Started {
    port: u16,
    ended: Arc<AtomicBool>,
    news: News,
    door: Option<JoinHandle<()>>,
}

impl Server {
    /// Takes a port of 127.0.0.1: the one asked for, else `usual` or the next that is free.
    ///
    /// # Errors
    /// If the port, or none of them, can be had.
    pub fn open(asked: Option<u16>, usual: u16, token: Token, news: News) -> io::Result<Server> {
        let ports = match asked {
            Some(port) => port..=port,
            None => usual..=usual.saturating_add(PORTS),
        };
        let mut last = io::Error::from(io::ErrorKind::AddrInUse);
        for port in ports {
            match TcpListener::bind((Ipv4Addr::LOCALHOST, port)) {
                Ok(listener) => {
                    let port = listener.local_addr()?.port();
                    return Ok(Server { listener, port, token, news });
                }
                Err(error) => last = error,
            }
        }
        Err(last)
    }

    /// Its port.
    pub fn port(&self) -> u16 {
        self.port
    }

    /// The address to open in a browser.
    pub fn address(&self) -> String {
        address(self.port, &self.token)
    }

    /// Answers from now on; `title` is the name of the project.
    pub fn start(self, desk: Arc<dyn Desk>, title: &str) -> Started {
        let Server { listener, port, token, news } = self;
        let ended = Arc::new(AtomicBool::new(false));
        let counter = Arc::new(Counter { desk, news: news.clone(), token, port, page: page::page(title) });
        let is_ended = Arc::clone(&ended);
        let door = std::thread::spawn(move || {
            let connections = Arc::new(AtomicUsize::new(0));
            for stream in listener.incoming() {
                if is_ended.load(Ordering::Relaxed) {
                    return;
                }
                let Ok(stream) = stream else { continue };
                if connections.fetch_add(1, Ordering::Relaxed) >= CONNECTIONS {
                    connections.fetch_sub(1, Ordering::Relaxed);
                    let _ = Answer::plain(503, "too many at a time").send(&stream, true);
                    continue;
                }
                let (counter, connections) = (Arc::clone(&counter), Arc::clone(&connections));
                std::thread::spawn(move || {
                    let _leaves = Leaves(connections);
                    counter.serve(&stream);
                    // Who has not been read to the end would not read the answer either.
                    let _ = stream.shutdown(Shutdown::Write);
                });
            }
        });
        Started { port, ended, news, door: Some(door) }
    }
}

/// Counts a connection down, however it ends.
struct Leaves(Arc<AtomicUsize>);

impl Drop for Leaves {
    fn drop(&mut self) {
        self.0.fetch_sub(1, Ordering::Relaxed);
    }
}

/// The address that opens the page of a server.
pub fn address(port: u16, token: &Token) -> String {
    format!("http://127.0.0.1:{port}/?token={}", token.text())
}

impl Drop for Started {
    fn drop(&mut self) {
        self.ended.store(true, Ordering::Relaxed);
        self.news.end();
        // Whoever waits at the door is let go by one more who comes.
        let _ = TcpStream::connect(SocketAddr::from((Ipv4Addr::LOCALHOST, self.port)));
        if let Some(door) = self.door.take() {
            let _ = door.join();
        }
    }
}

/// What is needed to answer a request.
struct Counter {
    desk: Arc<dyn Desk>,
    news: News,
    token: Token,
    port: u16,
    page: String,
}

impl Counter {
    /// Reads a request and answers it. Whoever asked may have gone.
    fn serve(&self, stream: &TcpStream) {
        let request = match Request::read(stream) {
            Ok(request) => request,
            Err(Bad::Gone) => return,
            Err(Bad::Damaged) => return drop(Answer::plain(400, "this is not a request").send(stream, true)),
            Err(Bad::Long) => return drop(Answer::plain(413, "the request is too long").send(stream, true)),
        };
        let acts = request.method == "POST";
        let (path, query) = request.target.split_once('?').unwrap_or((&request.target, ""));
        let caller = Caller {
            host: request.header("host"),
            // Several of them are not to be taken for none.
            origin: request.header("origin").or(request.has("origin").then_some("several")),
            site: request.header("sec-fetch-site").or(request.has("sec-fetch-site").then_some("several")),
            cookie: request.header("cookie"),
            own: request.header("x-blocksim"),
            token: query.split('&').find_map(|pair| pair.strip_prefix("token=")),
        };
        let looks = request.method == "GET" || request.method == "HEAD";
        let answer = match verdict(&caller, &self.token, self.port, acts) {
            Verdict::Refused(reason) => Answer::plain(403, reason),
            // The token does not stay in the address.
            Verdict::First => Answer::plain(303, "")
                .with("Set-Cookie", cookie(&self.token, self.port))
                .with("Location", "/"),
            Verdict::Welcome if looks && path == "/api/news" => {
                let news = self.news.listen();
                let mut out = stream;
                return news::bring(&news, &mut out);
            }
            Verdict::Welcome if looks => self.looked(path),
            Verdict::Welcome if acts => match body(&request.body) {
                Ok(body) => self.acted(path, &body),
                Err(reason) => Answer::plain(400, reason),
            },
            Verdict::Welcome => Answer::plain(405, "GET and POST are answered"),
        };
        let _ = answer.send(stream, request.method != "HEAD");
    }

    fn looked(&self, path: &str) -> Answer {
        if path == "/" {
            let page = Answer::new(200, "text/html; charset=utf-8", self.page.as_bytes());
            return page.with("Content-Security-Policy", POLICY);
        }
        if let Some((kind, text)) = path.strip_prefix("/assets/").and_then(assets::find) {
            return Answer::new(200, kind, text.as_bytes());
        }
        let Some(decoded) = decoded(path) else { return Answer::plain(400, "the address is no text") };
        told(match (decoded.strip_prefix("/api/"), decoded.strip_prefix("/runs/")) {
            (Some(asked), _) => self.desk.look(asked),
            (_, Some(name)) => self.desk.run_page(name),
            _ => Reply::Missing,
        })
    }

    fn acted(&self, path: &str, body: &Value) -> Answer {
        told(path.strip_prefix("/api/").map_or(Reply::Missing, |asked| self.desk.act(asked, body)))
    }
}

/// The body of a request: JSON, or nothing.
fn body(bytes: &[u8]) -> Result<Value, &'static str> {
    if bytes.is_empty() {
        Ok(Value::Null)
    } else {
        serde_json::from_slice(bytes).map_err(|_| "the request is no JSON")
    }
}

fn told(reply: Reply) -> Answer {
    let json = "application/json";
    match reply {
        Reply::Data(data) => Answer::new(200, json, data.to_string()),
        Reply::Text(text) => Answer::new(200, json, text.as_bytes()),
        Reply::Page(page) => {
            Answer::new(200, "text/html; charset=utf-8", page).with("Content-Security-Policy", APART)
        }
        Reply::Refused(reason) => Answer::new(409, json, json!({ "refused": reason }).to_string()),
        Reply::Missing => Answer::plain(404, "there is nothing here"),
    }
}

/// A path with its `%20` as signs; `None` where they make no text.
fn decoded(path: &str) -> Option<String> {
    let mut bytes = Vec::with_capacity(path.len());
    let mut rest = path.bytes();
    while let Some(byte) = rest.next() {
        bytes.push(match byte {
            b'%' => {
                let digit = |byte: u8| char::from(byte).to_digit(16);
                (digit(rest.next()?)? * 16 + digit(rest.next()?)?) as u8
            }
            other => other,
        });
    }
    String::from_utf8(bytes).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_are_decoded_or_refused() {
        assert_eq!(decoded("/runs/a%20b%C3%A4").as_deref(), Some("/runs/a bä"));
        assert_eq!([decoded("/%"), decoded("/%zz"), decoded("/%ff")], [None, None, None]);
    }
}
