//! SCXML: statecharts as the W3C writes them, read, written and run.
//!
//! [`read`] makes a [`Document`] of a text: a [`Statechart`](crate::Statechart), and beside it what a chart alone cannot say, such as variables and
//! invocations. [`write()`] makes a text of a chart, and [`Document::write`] one of a document; both read back as they were. A [`Session`] runs a
//! document on a clock that the caller holds, together with the sessions that the document invokes.
//!
//! ```
//! use yase::scxml::{Event, NoPlatform, Session, read};
//! use yase::{Moment, Source};
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
//! session.start(Moment::ZERO)?;
//! session.send(Event::new("open.slowly"))?;
//! assert_eq!(session.configuration(), ["open"]);
//! session.advance_to(Moment::from_millis(5000))?;
//! assert_eq!(session.configuration(), ["closed"]);
//! assert_eq!(session.value("opened").map(|opened| opened.to_string()).as_deref(), Some("1"));
//! # Ok::<(), yase::scxml::SessionError>(())
//! ```
//!
//! # What is understood
//!
//! All elements of the recommendation, with the data models `null` and `ecmascript`. Of ECMAScript there is the subset that charts need: values of all
//! types but symbols, dates and the like; operators; `In()`; `String()`; arrays with `length`, `concat`, `join`, `push` and `slice`, texts with `length`,
//! `concat` and `slice`; functions that do not lie in functions; and in scripts `var`, assignments, `if` and `return`. What ECMAScript has beyond that is refused
//! when the document is read (E0610), and what is not ECMAScript at all is an `error.execution` when its turn comes, as the recommendation has it.
//! Events go to sessions by the SCXML event processor, and to other kinds of targets through the [`Platform`].
//!
//! A chart whose conditions are made of `In()` and whose contents only raise events needs no session: its
//! [`statechart`](Document::statechart) compiles by itself, under any [`Semantics`](crate::Semantics).
//!
//! # Limits
//!
//! A document that somebody else wrote can neither hang a program nor fill its memory. Micro-steps are bounded by
//! [`Semantics::limit`](crate::Semantics::limit), expressions and contents by two million steps in a macrostep, data by 64 MiB for each session,
//! texts by 1 MiB, arrays that are written beyond their end by 262,144 items, events on their way by 65,536, sessions by 16 inside one another and 1,000
//! at once. A delay is at least a millisecond. What goes beyond is an error of the document where it can be told, or else ends the session with a
//! [`SessionError`].
//!
//! # Diagnostics
//!
//! | code | what is wrong |
//! |---|---|
//! | E0601 | the text is not XML |
//! | E0602 | an element is not known |
//! | E0603 | an attribute is not known |
//! | E0604 | something is missing |
//! | E0605 | a name is taken |
//! | E0606 | a target does not exist or lies elsewhere |
//! | E0607 | targets cannot be entered together |
//! | E0608 | two things exclude each other |
//! | E0609 | a value is none of those that are possible |
//! | E0610 | ECMAScript that is outside the subset |
//! | E0611 | not ECMAScript (a warning) |
//! | E0612 | the data model is not supported |
//! | E0613 | data in a document of the null data model |
//! | E0614 | elements nest too deeply |
//! | E0615 | something stands where it cannot |
//! | E0616 | the root is not `scxml` |
//! | E0617 | a name is not one |
//! | E0618 | an element of another namespace is left out (a warning) |
//! | E0619 | a `parallel` has no regions (a warning) |
//! | E0620 | a chart says what SCXML cannot |
//! | E0621 | a script cannot be had |

mod code;
mod content;
mod document;
mod guard;
mod language;
mod read;
mod session;
mod time;
mod words;
mod write;
mod xml;

pub use document::{Binding, DataModel, Document};
pub use language::Data;
pub use read::read;
pub use session::{Event, EventKind, NoPlatform, Platform, Session, SessionError};
pub use write::write;
