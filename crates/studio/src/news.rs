//! News for whoever looks at the page: each is sent to all of them as a server-sent event
//! (<https://html.spec.whatwg.org/multipage/server-sent-events.html>). They are numbered, so that whoever misses one notices.

use std::io::Write;
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, SystemTime, UNIX_EPOCH};

/// News that wait for one reader. Whoever falls behind this far is left alone, and comes back by himself.
const WAITING: usize = 512;
/// A sign of life is sent where there have been no news for so long, so that a reader who has gone is noticed.
const QUIET: Duration = Duration::from_secs(10);

/// Where news are brought to, for all who listen.
#[derive(Debug, Clone)]
pub struct News(Arc<Mutex<Readers>>);

#[derive(Debug)]
struct Readers {
    all: Vec<SyncSender<Arc<str>>>,
    /// Number of the last news.
    last: u64,
    /// Numbers of another server mean other news: when this one began, µs.
    since: u128,
}

impl Default for News {
    fn default() -> News {
        let since = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_micros());
        News(Arc::new(Mutex::new(Readers { all: Vec::new(), last: 0, since })))
    }
}

impl News {
    fn readers(&self) -> MutexGuard<'_, Readers> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Tells everybody; `data` is text without line breaks, such as JSON.
    pub fn tell(&self, name: &str, data: &str) {
        let mut readers = self.readers();
        readers.last += 1;
        let text: Arc<str> = format!("id: {}\nevent: {name}\ndata: {data}\n\n", readers.last).into();
        readers.all.retain(|reader| reader.try_send(Arc::clone(&text)).is_ok());
    }

    /// Number of the last news, 0 before the first.
    pub fn last(&self) -> u64 {
        self.readers().last
    }

    /// Lets everybody go.
    pub(crate) fn end(&self) {
        self.readers().all.clear();
    }

    /// News from now on; before them, which number the last ones had.
    pub(crate) fn listen(&self) -> Receiver<Arc<str>> {
        let (sender, receiver) = sync_channel(WAITING);
        let mut readers = self.readers();
        let here =
            format!("id: {}\nevent: here\ndata: {{\"since\":\"{}\"}}\n\n", readers.last, readers.since);
        // There is room for it.
        let _ = sender.try_send(here.into());
        readers.all.push(sender);
        receiver
    }
}

/// Brings news to one reader until there is nobody at the other end.
pub(crate) fn bring(news: &Receiver<Arc<str>>, out: &mut dyn Write) {
    let head = "HTTP/1.1 200 OK\r\nContent-Type: text/event-stream\r\nCache-Control: no-store\r\nX-Content-Type-Options: nosniff\r\n\
                Connection: close\r\n\r\nretry: 500\n\n";
    let mut text: Arc<str> = head.into();
    while out.write_all(text.as_bytes()).and_then(|()| out.flush()).is_ok() {
        text = match news.recv_timeout(QUIET) {
            Ok(text) => text,
            Err(RecvTimeoutError::Timeout) => ":\n\n".into(),
            Err(RecvTimeoutError::Disconnected) => return,
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_who_listen_are_told_and_who_falls_behind_is_left() {
        let news = News::default();
        let (first, second) = (news.listen(), news.listen());
        for reader in [&first, &second] {
            assert!(reader.recv().unwrap().starts_with("id: 0\nevent: here\ndata: {\"since\":\""));
        }
        news.tell("model", "{}");
        assert_eq!(&*first.recv().unwrap(), "id: 1\nevent: model\ndata: {}\n\n");
        assert_eq!(&*second.recv().unwrap(), "id: 1\nevent: model\ndata: {}\n\n");
        drop(second);
        for _ in 0..WAITING {
            news.tell("rows", "1");
        }
        assert_eq!(news.readers().all.len(), 1);
        news.tell("rows", "1");
        assert_eq!(news.readers().all.len(), 0);
        let mut out = Vec::new();
        bring(&first, &mut out);
        assert_eq!(String::from_utf8(out).unwrap().matches("event: rows").count(), WAITING);
        // What was missed is seen by the number.
        assert_eq!(news.last(), WAITING as u64 + 2);
        assert!(news.listen().recv().unwrap().starts_with(&format!("id: {}\n", news.last())));
    }
}
