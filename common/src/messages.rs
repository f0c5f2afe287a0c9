//! Messages of any topic: what all of them can do, and code that is the same for each.
//!
//! Code that treats all topics alike implements [`ForTopic`] or [`ForMessage`] once.

use iceoryx2::prelude::ZeroCopySend;
use schemars::JsonSchema;
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::clutter_map::{ClutterCell, ClutterMapHeader, MAX_CLUTTER_CELLS};
use crate::commands::{Command, CommandsHeader, MAX_COMMANDS};
use crate::dwell::{DwellHeader, MAX_CELLS};
use crate::health::{Health, HealthHeader};
use crate::message::{Header, Lineage, Place};
use crate::plots::{MAX_PLOTS, Plot, PlotsHeader};
use crate::recording::row::Row;
use crate::system_tracks::{MAX_SYSTEM_TRACKS, SystemTrack, SystemTracksHeader};
use crate::topic::{Topic, with_topics};
use crate::tracks::{MAX_TRACKS, Track, TracksHeader};
use crate::truth::{MAX_TARGETS, TruthHeader, TruthTarget};

/// What travels on a topic, and how much room it gets.
pub trait Message: 'static {
    /// Which topic.
    const TOPIC: Topic;
    /// Version of header and element, stored as an attribute of the service.
    const SCHEMA: &'static str;
    /// Elements of the longest message.
    const MOST: usize;
    /// Unread messages that a subscriber may have waiting.
    const QUEUE: usize;
    /// Consumers and observers at most.
    const SUBSCRIBERS: usize;
    /// Publishers at most: one more than live ones, so that a restart never waits for a clean-up.
    const PUBLISHERS: usize;
    /// Messages kept for a late subscriber.
    const HISTORY: usize;
    /// The Rust source that defines header and element, with its units: the schema in recordings.
    const SOURCE: &'static str;
    /// Header of the message.
    type Header: Header + Content;
    /// Element of the payload slice.
    type Element: Content + Row<Self::Header>;

    /// A message of this topic.
    fn recorded(header: Self::Header, elements: Vec<Self::Element>) -> Recorded;

    /// The same, borrowed.
    fn borrowed<'a>(header: &'a Self::Header, elements: &'a [Self::Element]) -> RecordedRef<'a>;
}

/// What headers and elements can do: travel through shared memory, be recorded, be described to other programs.
pub trait Content:
    ZeroCopySend + Default + Clone + Copy + PartialEq + std::fmt::Debug + Serialize + DeserializeOwned + JsonSchema
{
}

impl<T> Content for T where
    T: ZeroCopySend + Default + Clone + Copy + PartialEq + std::fmt::Debug + Serialize + DeserializeOwned + JsonSchema
{
}

/// Something to do for a topic, whichever it is.
pub trait ForTopic {
    /// What it gives.
    type Out;

    /// Does it for the messages `M`.
    fn call<M: Message>(self) -> Self::Out;
}

/// Something to do with a message, whatever its topic.
pub trait ForMessage {
    /// What it gives.
    type Out;

    /// Does it with a message.
    fn call<M: Message>(self, header: &M::Header, elements: &[M::Element]) -> Self::Out;
}

macro_rules! declare_messages {
    ($(#[$doc:meta] $name:ident($text:literal, $schema:literal) $header:path, [$element:path; $most:expr]
        { $($key:ident: $value:literal),+ } from $($source:literal)+;)+) => {
        /// A message with its elements.
        #[derive(Debug, Clone, PartialEq)]
        pub enum Recorded {
            $(#[$doc] $name($header, Vec<$element>),)+
        }

        /// A message whose elements lie elsewhere, in shared memory for example.
        #[derive(Debug, Clone, Copy, PartialEq)]
        pub enum RecordedRef<'a> {
            $(#[$doc] $name(&'a $header, &'a [$element]),)+
        }

        impl Topic {
            /// Does `what` for this topic.
            pub fn apply<F: ForTopic>(self, what: F) -> F::Out {
                match self {
                    $(Self::$name => what.call::<$name>()),+
                }
            }
        }

        impl Recorded {
            /// The same message, borrowed.
            pub fn by_ref(&self) -> RecordedRef<'_> {
                match self {
                    $(Self::$name(header, elements) => RecordedRef::$name(header, elements),)+
                }
            }

            /// Its header.
            pub fn header_mut(&mut self) -> &mut dyn Header {
                match self {
                    $(Self::$name(header, _) => header,)+
                }
            }
        }

        impl<'a> RecordedRef<'a> {
            /// Does `what` with the message.
            pub fn apply<F: ForMessage>(&self, what: F) -> F::Out {
                match self {
                    $(Self::$name(header, elements) => what.call::<$name>(header, elements),)+
                }
            }

            /// The topic it travelled on.
            pub fn topic(&self) -> Topic {
                match self {
                    $(Self::$name(..) => Topic::$name,)+
                }
            }

            /// Its header.
            pub fn header(&self) -> &'a dyn Header {
                match *self {
                    $(Self::$name(header, _) => header,)+
                }
            }

            /// Elements in the payload.
            pub fn len(&self) -> usize {
                match self {
                    $(Self::$name(_, elements) => elements.len(),)+
                }
            }
        }

        $(
            #[$doc]
            #[derive(Debug)]
            pub struct $name;

            impl Message for $name {
                const TOPIC: Topic = Topic::$name;
                const SCHEMA: &'static str = $schema;
                const MOST: usize = $most;
                $(const $key: usize = $value;)+
                const SOURCE: &'static str = concat!($(include_str!($source)),+);
                type Header = $header;
                type Element = $element;

                fn recorded(header: $header, elements: Vec<$element>) -> Recorded {
                    Recorded::$name(header, elements)
                }

                fn borrowed<'a>(header: &'a $header, elements: &'a [$element]) -> RecordedRef<'a> {
                    RecordedRef::$name(header, elements)
                }
            }
        )+
    };
}

with_topics!(declare_messages);

impl RecordedRef<'_> {
    /// Where it stands in its stream.
    pub fn place(&self) -> Place {
        self.header().place()
    }

    /// The upstream messages that went into it.
    pub fn lineage(&self) -> Option<Lineage> {
        self.header().lineage().copied()
    }

    /// Session of its publisher.
    pub fn session(&self) -> u64 {
        self.place().session
    }

    /// Position in its stream.
    pub fn seq(&self) -> u64 {
        self.place().seq
    }

    /// Measurement time, ns UTC; 0 for health, which has none.
    pub fn time_ns(&self) -> u64 {
        self.place().time_ns
    }

    /// Whether the payload is empty.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}
