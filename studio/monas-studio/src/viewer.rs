//! One page with its WebSocket.

use std::io;
use std::net::TcpStream;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use serde_json::{Value, json};
use tungstenite::protocol::frame::coding::CloseCode;
use tungstenite::protocol::{CloseFrame, Role, WebSocketConfig};
use tungstenite::{Message, WebSocket};

use crate::model_session::ModelSession;
use crate::source::Session;
use crate::time::now;
use crate::viewer_request::ViewerRequest;

/// The interval between two frames.
const FRAME_INTERVAL: Duration = Duration::from_nanos(1_000_000_000 / 30);

/// The time limit for a page to receive a frame; slower pages are disconnected.
const SEND_TIMEOUT: Duration = Duration::from_secs(5);

/// The wait for the page's reply to the end of the studio: a page on a busy computer may be slow,
/// and a frozen page must not delay the end of a run any longer.
const CLOSE_TIMEOUT: Duration = Duration::from_secs(2);

/// The longest request of a page, in bytes; of one that may change the run or edit models.
const REQUEST_LIMIT: usize = 16 << 10;
const CONTROL_LIMIT: usize = 1 << 20;

/// The most requests that are handled between two frames.
const MAX_REQUESTS: usize = 32;

/// The longest request of a page that may send texts, or not, in bytes.
pub(crate) fn request_limit(sends_texts: bool) -> usize {
    if sends_texts { CONTROL_LIMIT } else { REQUEST_LIMIT }
}

/// Serves a page until it disconnects, is too slow, sends a request of more than `limit` bytes, or
/// the studio ends.
pub(crate) fn serve(
    stream: TcpStream,
    mut session: Box<dyn Session>,
    models: Option<ModelSession>,
    limit: usize,
    is_over: &AtomicBool,
) {
    // A page that has left needs no report.
    let _ = exchange(stream, &mut *session, models, limit, is_over);
}

fn exchange(
    stream: TcpStream,
    session: &mut dyn Session,
    mut models: Option<ModelSession>,
    limit: usize,
    is_over: &AtomicBool,
) -> tungstenite::Result<()> {
    stream.set_nodelay(true)?;
    stream.set_write_timeout(Some(SEND_TIMEOUT))?;
    let limits = WebSocketConfig::default().max_message_size(Some(limit)).max_frame_size(Some(limit));
    let mut socket = WebSocket::from_raw_socket(stream, Role::Server, Some(limits));
    if let Some(models) = &models {
        send(&mut socket, &models.greeting())?;
    }
    let mut last = now();
    let mut due = last;
    while !is_over.load(Ordering::SeqCst) {
        for _ in 0..MAX_REQUESTS {
            let left = due.saturating_duration_since(now());
            let Some(request) = next_request(&mut socket, left)? else { break };
            let reply = match (ViewerRequest::parse(&request), &mut models) {
                (Some(ViewerRequest::Model(id, request)), Some(models)) => models.handle(id, request),
                (Some(ViewerRequest::Model(id, _)), None) => {
                    let reason = "the studio was started without --edit";
                    Some(json!({"type": "reply", "id": id, "done": false, "reason": reason}))
                }
                (Some(request), _) => session.handle(request),
                (None, _) => None,
            };
            if let Some(reply) = reply {
                send(&mut socket, &reply)?;
            }
        }
        let time = now();
        if time < due {
            continue;
        }
        if let Some(reply) = models.as_mut().and_then(ModelSession::checked) {
            send(&mut socket, &reply)?;
        }
        let frame = session.frame(time - last);
        (last, due) = (time, time + FRAME_INTERVAL);
        if let Some(frame) = frame {
            send(&mut socket, &frame)?;
        }
    }
    close(&mut socket, CloseCode::Away, "the studio has ended")
}

/// Closes a connection with the reason, which a browser would not pass to the page for a refused
/// handshake.
pub(crate) fn refuse(stream: TcpStream, reason: &str) {
    let refuse = || {
        stream.set_write_timeout(Some(SEND_TIMEOUT))?;
        let limits = WebSocketConfig::default()
            .max_message_size(Some(REQUEST_LIMIT))
            .max_frame_size(Some(REQUEST_LIMIT));
        close(&mut WebSocket::from_raw_socket(stream, Role::Server, Some(limits)), CloseCode::Again, reason)
    };
    // A page that has left needs no report.
    let _ = refuse();
}

/// Ends a connection with a reason, and waits for the page's reply.
fn close(socket: &mut WebSocket<TcpStream>, code: CloseCode, reason: &str) -> tungstenite::Result<()> {
    socket.close(Some(CloseFrame { code, reason: reason.into() }))?;
    socket.flush()?;
    // Read the remaining data of the page, or else the system resets the connection, and the page
    // may lose the reason. At its reply the socket reports that it is closed.
    let deadline = now() + CLOSE_TIMEOUT;
    while now() < deadline {
        next_request(socket, deadline.saturating_duration_since(now()))?;
    }
    Ok(())
}

fn send(socket: &mut WebSocket<TcpStream>, object: &Value) -> tungstenite::Result<()> {
    // A frame that cannot be written in time would be followed by others: the page reconnects.
    socket.send(Message::text(object.to_string()))
}

/// The next text of the page; `None` if there is none in time.
pub(crate) fn next_request(
    socket: &mut WebSocket<TcpStream>,
    timeout: Duration,
) -> tungstenite::Result<Option<String>> {
    // A timeout of zero would mean no timeout.
    socket.get_ref().set_read_timeout(Some(timeout.max(Duration::from_millis(1))))?;
    match socket.read() {
        Ok(Message::Text(text)) => Ok(Some(text.as_str().to_owned())),
        Ok(_) => Ok(None),
        Err(tungstenite::Error::Io(error)) if is_timeout(&error) => Ok(None),
        Err(error) => Err(error),
    }
}

fn is_timeout(error: &io::Error) -> bool {
    matches!(error.kind(), io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut | io::ErrorKind::Interrupted)
}
