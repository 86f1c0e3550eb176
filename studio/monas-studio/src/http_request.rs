//! Heads of HTTP requests.

use std::io::{self, Read};
use std::net::TcpStream;
use std::time::Duration;

use crate::access::RequestOrigin;

/// The longest head of a request, in bytes.
const HEAD_LIMIT: usize = 16 << 10;

/// The most headers of a request.
const MAX_HEADERS: usize = 64;

/// The time limit for a part of the head, and the largest number of parts.
const TIMEOUT: Duration = Duration::from_secs(2);
const MAX_PARTS: usize = 64;

/// A request without its body: only GET is answered.
#[derive(Clone, PartialEq, Eq, Default, Debug)]
pub(crate) struct HttpRequest {
    pub(crate) method: String,
    /// The path without the query.
    pub(crate) path: String,
    query: String,
    headers: Vec<(String, String)>,
}

impl HttpRequest {
    /// Reads the head of a request; `None` if the peer closes, is too slow, or sends something
    /// else.
    pub(crate) fn read(stream: &mut TcpStream) -> io::Result<Option<HttpRequest>> {
        stream.set_read_timeout(Some(TIMEOUT))?;
        let mut head = Vec::new();
        let mut buffer = [0; 2048];
        for _ in 0..MAX_PARTS {
            let count = stream.read(&mut buffer)?;
            head.extend(&buffer[..count]);
            if let Some(request) = HttpRequest::parse(&head) {
                return Ok(request);
            }
            if count == 0 || head.len() > HEAD_LIMIT {
                break;
            }
        }
        Ok(None)
    }

    /// Parses a head: `None` while it is incomplete, `Some(None)` if it is wrong.
    fn parse(head: &[u8]) -> Option<Option<HttpRequest>> {
        let mut headers = [httparse::EMPTY_HEADER; MAX_HEADERS];
        let mut request = httparse::Request::new(&mut headers);
        match request.parse(head) {
            Ok(httparse::Status::Partial) => return None,
            Err(_) => return Some(None),
            Ok(httparse::Status::Complete(_)) => {}
        }
        let target = request.path.unwrap_or_default();
        let (path, query) = target.split_once('?').unwrap_or((target, ""));
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        let headers = request.headers.iter();
        Some(Some(HttpRequest {
            method: request.method.unwrap_or_default().to_owned(),
            path: path.to_owned(),
            query: query.to_owned(),
            headers: headers.map(|header| (header.name.to_lowercase(), text(header.value))).collect(),
        }))
    }

    /// The value of a header, by its name in lower case.
    pub(crate) fn header(&self, name: &str) -> Option<&str> {
        self.headers.iter().find(|(known, _)| known == name).map(|(_, value)| value.as_str())
    }

    /// Whether a header with a list of words has a word.
    pub(crate) fn has_word(&self, name: &str, word: &str) -> bool {
        let words = self.header(name).into_iter().flat_map(|value| value.split([',', ';']));
        words.map(str::trim).any(|known| known.eq_ignore_ascii_case(word))
    }

    /// The headers that decide whether it is answered.
    pub(crate) fn origin(&self) -> RequestOrigin<'_> {
        let parameters = self.query.split('&').filter_map(|parameter| parameter.split_once('='));
        // With a second `Host` it would be ambiguous which one counts.
        let hosts = self.headers.iter().filter(|(name, _)| name == "host").count();
        RequestOrigin {
            host: self.header("host").filter(|_| hosts == 1),
            origin: self.header("origin"),
            cookie: self.header("cookie"),
            token: parameters.filter(|(name, _)| *name == "token").map(|(_, value)| value).next(),
        }
    }

    /// The key of a request to open a WebSocket.
    pub(crate) fn websocket_key(&self) -> Option<&str> {
        let is_upgrade = self.has_word("upgrade", "websocket") && self.has_word("connection", "upgrade");
        self.header("sec-websocket-key")
            .filter(|_| is_upgrade && self.has_word("sec-websocket-version", "13"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn heads_are_parsed_when_they_are_complete() {
        let head = "GET /a?token=x&y=z HTTP/1.1\r\nHost: h:1\r\nAccept-Encoding: br, gzip;q=1\r\n";
        assert_eq!(HttpRequest::parse(head.as_bytes()), None);
        let request = HttpRequest::parse(format!("{head}\r\n").as_bytes()).flatten().unwrap();
        assert_eq!((request.method.as_str(), request.path.as_str()), ("GET", "/a"));
        assert!(request.has_word("accept-encoding", "gzip") && !request.has_word("accept-encoding", "zip"));
        assert_eq!((request.origin().host, request.origin().token), (Some("h:1"), Some("x")));
        assert_eq!(request.websocket_key(), None);
        assert_eq!(HttpRequest::parse(b"\0\0\r\n\r\n"), Some(None));
    }

    #[test]
    fn two_hosts_are_none() {
        let request = HttpRequest::parse(b"GET / HTTP/1.1\r\nHost: a\r\nHost: b\r\n\r\n").flatten().unwrap();
        assert_eq!(request.origin().host, None);
    }
}
