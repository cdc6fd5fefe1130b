//! News for whoever looks at the page: each is sent to all of them as a server-sent event
//! (<https://html.spec.whatwg.org/multipage/server-sent-events.html>).

use std::io::Write;
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// News that wait for one reader. Whoever falls behind this far is left alone, and comes back by himself.
const WAITING: usize = 512;
/// A sign of life is sent where there have been no news for so long, so that a reader who has gone is noticed.
const QUIET: Duration = Duration::from_secs(10);

/// Where news are brought to, for all who listen.
#[derive(Debug, Clone, Default)]
pub struct News(Arc<Mutex<Vec<SyncSender<Arc<str>>>>>);

impl News {
    /// Tells everybody; `data` is text without line breaks, such as JSON.
    pub fn tell(&self, name: &str, data: &str) {
        let text: Arc<str> = format!("event: {name}\ndata: {data}\n\n").into();
        let mut readers = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        readers.retain(|reader| reader.try_send(Arc::clone(&text)).is_ok());
    }

    /// How many listen.
    pub fn readers(&self) -> usize {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).len()
    }

    /// Lets everybody go.
    pub(crate) fn end(&self) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).clear();
    }

    /// News from now on.
    pub(crate) fn listen(&self) -> Receiver<Arc<str>> {
        let (sender, receiver) = sync_channel(WAITING);
        self.0.lock().unwrap_or_else(PoisonError::into_inner).push(sender);
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
        news.tell("model", "{}");
        assert_eq!(&*first.recv().unwrap(), "event: model\ndata: {}\n\n");
        assert_eq!(&*second.recv().unwrap(), "event: model\ndata: {}\n\n");
        drop(second);
        for _ in 0..WAITING {
            news.tell("rows", "1");
        }
        assert_eq!(news.readers(), 1);
        news.tell("rows", "1");
        assert_eq!(news.readers(), 0);
        let mut out = Vec::new();
        bring(&first, &mut out);
        assert_eq!(String::from_utf8(out).unwrap().matches("event: rows").count(), WAITING);
    }
}
