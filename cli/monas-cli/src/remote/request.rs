//! Inquiries to a run.

use monas::records::{Inquiry, Reply};
use monas_terminal::CommandFailure;
use prost::Message;

use super::connection::{self, failure};
use super::run_selector::RunSelector;

/// The reply of the selected run to an inquiry.
pub(crate) fn request(inquiry: Inquiry, run: &RunSelector) -> Result<Reply, CommandFailure> {
    let host = run.host.clone().unwrap_or_default();
    let inquiry = Inquiry { host, ..inquiry }.encode_to_vec();
    let reply = connection::client(run)?.manage(inquiry).map_err(failure(run.format.value))?;
    Reply::decode(reply.as_slice()).map_err(|_| unexpected_reply(run))
}

/// The failure for a reply of the wrong kind.
pub(crate) fn unexpected_reply(run: &RunSelector) -> CommandFailure {
    let message = "unexpected reply; is the run another version of monas?";
    CommandFailure::Unreachable(run.format.value, message.into())
}
