//! SCXML, the statecharts of the W3C: reading, writing and execution.
//!
//! [`read`] makes a [`Document`] from text: a [`Statechart`](yase::Statechart), and everything that
//! a chart cannot express, such as variables and invocations. [`write()`] writes a chart as text,
//! and [`Document::write`] a document; both read back unchanged. A [`Session`] runs a document,
//! together with the sessions that it invokes; the caller supplies the time.
//!
//! ```
//! use yase_scxml::{ScxmlEvent, NoPlatform, Session, read};
//! use yase::{Timestamp, Source};
//!
//! let source = Source::new("door.scxml", r#"
//!     <scxml xmlns="http://www.w3.org/2005/07/scxml" version="1.0" initial="closed">
//!       <datamodel><data id="opened" expr="0"/></datamodel>
//!       <state id="closed"><transition event="open" target="open"/></state>
//!       <state id="open">
//!         <onentry>
//!           <assign location="opened" expr="opened + 1"/>
//!           <send event="shut" delay="5s"/>
//!         </onentry>
//!         <transition event="shut" target="closed"/>
//!       </state>
//!     </scxml>"#);
//! let (document, found) = read(&source);
//! assert!(found.is_empty());
//!
//! let mut session = Session::new(&document.expect("it is a document"), NoPlatform).expect("its chart is in order");
//! session.start(Timestamp::ZERO)?;
//! session.send(ScxmlEvent::new("open.slowly"))?;
//! assert_eq!(session.configuration(), ["open"]);
//! session.advance_to(Timestamp::from_millis(5000))?;
//! assert_eq!(session.configuration(), ["closed"]);
//! assert_eq!(session.value("opened").map(|opened| opened.to_string()).as_deref(), Some("1"));
//! # Ok::<(), yase_scxml::SessionError>(())
//! ```
//!
//! # Supported features
//!
//! All elements of the recommendation are supported, with the data models `null` and `ecmascript`.
//! A subset of ECMAScript for charts is supported: values of all types except symbols, dates and
//! similar ones; operators; `In()`; `String()`; arrays with `length`, `concat`, `join`, `push` and
//! `slice`, texts with `length`, `concat` and `slice`; functions that are not nested; and in
//! scripts `var`, assignments, `if` and `return`. Other ECMAScript is refused when the document is
//! read (E0610); text that is not ECMAScript raises `error.execution` when it is executed, as the
//! recommendation requires. Events reach sessions through the SCXML event processor, and other
//! targets through the [`Platform`].
//!
//! A chart whose conditions are made of `In()` and whose contents only raise events needs no
//! session: its [`statechart`](Document::statechart) compiles by itself, under any
//! [`Semantics`](yase::Semantics).
//!
//! # Limits
//!
//! An untrusted document can neither hang a program nor exhaust its memory. Micro-steps are bounded
//! by [`Semantics::limit`](yase::Semantics::limit), expressions and contents by two million steps
//! in a macrostep, data by 64 MiB per session, texts by 1 MiB, arrays written beyond their end by
//! 262,144 items, undelivered events by 65,536, sessions by a nesting of 16 and a total of 1,000. A
//! delay is at least one millisecond. Exceeding a limit is an error of the document where it can be
//! reported, and otherwise ends the session with a [`SessionError`].
//!
//! # Diagnostics
//!
//! | code | what is wrong |
//! |---|---|
//! | E0601 | the text is not XML |
//! | E0602 | an element is not known |
//! | E0603 | an attribute is not known |
//! | E0604 | an attribute or element is missing |
//! | E0605 | a name is taken |
//! | E0606 | a target does not exist or lies elsewhere |
//! | E0607 | targets cannot be entered together |
//! | E0608 | two attributes exclude each other |
//! | E0609 | a value is not one of the permitted ones |
//! | E0610 | ECMAScript that is outside the subset |
//! | E0611 | not ECMAScript (a warning) |
//! | E0612 | the data model is not supported |
//! | E0613 | data in a document of the null data model |
//! | E0614 | elements nest too deeply |
//! | E0615 | an element or text stands where it is not permitted |
//! | E0616 | the root is not `scxml` |
//! | E0617 | an id or the name of a variable is invalid |
//! | E0618 | an element of another namespace is left out (a warning) |
//! | E0619 | a `parallel` has no regions (a warning) |
//! | E0620 | SCXML cannot express a part of the chart |
//! | E0621 | a script cannot be loaded |

mod compiled_text;
mod content;
mod document;
mod grammar;
mod guard;
mod language;
mod lexical;
mod read;
mod session;
mod time;
mod write;
mod xml;

pub use document::{DataBinding, DataModel, Document};
pub use language::DataValue;
pub use read::read;
pub use session::{NoPlatform, Platform, ScxmlEvent, ScxmlEventKind, Session, SessionError};
pub use write::write;
pub use xml::escape;
