//! The stages of a chain and what passes between them, in one table.
//!
//! ```text
//! radar-sim ──dwells──▶ plot-extractor ──plots──▶ tracker ──tracks──▶ recorder
//!     └──truth──────────────────────────────────────────────┬────────────▲
//!                                       other sites ──tracks─▶ fusion ───┘
//! video-source: dwells; plot-source, replay, a program of the user's: any of these topics ──┘
//! any of these topics but dwells ──▶ link-out ──another host──▶ link-in ──▶ the same topics
//! display: all topics, never waited for ──commands──▶ tracker ──actions, clutter-map──▶ recorder, display
//! outputs: tracks, and what they are made of, never waited for
//! ```
//!
//! A publisher waits for the consumers that the table requires. Every other subscriber is an observer: its full queue
//! discards messages, counted, and the chain goes on. Launcher, supervision, losses, books, status and metrics iterate over
//! the table; a new stage is an entry here.

use crate::config::{ChainConfig, Source};
use crate::topic::Topic;

/// A stage: one process, of its own program or of `radar-chain stage NAME`.
#[derive(Debug, PartialEq, Eq)]
pub struct Stage {
    /// Name of the process.
    pub name: &'static str,
    /// Its place in the flow.
    pub role: Role,
    /// What it reads; the first one is what its results are made from.
    pub inputs: &'static [Input],
    /// What it may publish; `messages_out` of its health counts the first one.
    pub outputs: &'static [Topic],
}

/// Place of a stage in the flow.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// Sets the pace: its end is the end of its site. One for each site.
    Source(Source),
    /// Makes results from messages. One for each site.
    Processor,
    /// Takes everything and reports. One for all sites.
    Recorder,
    /// Looks on: the run neither waits for it nor depends on it. One for all sites, where the configuration enables it.
    Observer(Observer),
}

/// An observer that the launcher starts with the chain.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Observer {
    /// `[display]`: the picture in a browser.
    Display,
    /// `[outputs]`: tracks and plots to other systems.
    Outputs,
}

impl Observer {
    /// Whether the chain has it.
    fn is_enabled(self, chain: &ChainConfig) -> bool {
        match self {
            Self::Display => chain.display.enabled,
            Self::Outputs => !chain.outputs.is_empty(),
        }
    }
}

/// A topic that a stage reads.
#[derive(Debug, PartialEq, Eq)]
pub struct Input {
    /// The topic.
    pub topic: Topic,
    /// Whether its publishers wait for the stage.
    pub required: Required,
}

/// When the publishers of a topic wait for a consumer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Required {
    /// Always.
    Always,
    /// Where `recorder.dwells` is set.
    IfDwellsAreRecorded,
    /// Where `link.send` names the topic.
    IfSent,
    /// Never.
    Never,
}

const fn if_sent(topic: Topic) -> Input {
    Input { topic, required: Required::IfSent }
}

const fn always(topic: Topic) -> Input {
    Input { topic, required: Required::Always }
}

const fn never(topic: Topic) -> Input {
    Input { topic, required: Required::Never }
}

/// All stages, upstream first.
pub const STAGES: [Stage; 12] = [
    Stage {
        name: "radar-sim",
        role: Role::Source(Source::RadarSim),
        inputs: &[],
        outputs: &[Topic::Dwells, Topic::Truth],
    },
    Stage {
        name: "plot-source",
        role: Role::Source(Source::PlotSource),
        inputs: &[],
        outputs: &[Topic::Plots, Topic::Truth],
    },
    Stage { name: "video-source", role: Role::Source(Source::VideoSource), inputs: &[], outputs: &[Topic::Dwells] },
    Stage {
        name: "replay",
        role: Role::Source(Source::Replay),
        inputs: &[],
        outputs: &[
            Topic::Dwells,
            Topic::Plots,
            Topic::Tracks,
            Topic::Truth,
            // What operators did: once more to a tracker, or as it was where none runs.
            Topic::Commands,
            Topic::Actions,
        ],
    },
    Stage {
        name: FUSION,
        role: Role::Source(Source::Fusion),
        // Of all other sites.
        inputs: &[always(Topic::Truth), always(Topic::Tracks)],
        outputs: &[Topic::Tracks, Topic::Truth, Topic::SystemTracks],
    },
    Stage {
        name: LINK_IN,
        role: Role::Source(Source::Link),
        inputs: &[],
        // Truth, whose messages do not count themselves, is the first: the others are counted where they were made.
        outputs: &[Topic::Truth, Topic::Plots, Topic::Tracks, Topic::SystemTracks],
    },
    Stage { name: "plot-extractor", role: Role::Processor, inputs: &[always(Topic::Dwells)], outputs: &[Topic::Plots] },
    Stage {
        name: TRACKER,
        role: Role::Processor,
        inputs: &[always(Topic::Plots), always(Topic::Commands)],
        outputs: &[Topic::Tracks, Topic::Actions, Topic::ClutterMap],
    },
    Stage {
        name: LINK_OUT,
        role: Role::Processor,
        inputs: &[if_sent(Topic::Tracks), if_sent(Topic::Truth), if_sent(Topic::Plots), if_sent(Topic::SystemTracks)],
        outputs: &[],
    },
    Stage {
        name: RECORDER,
        role: Role::Recorder,
        // Causes before effects: the order in which the recorder takes what waits.
        inputs: &[
            always(Topic::Truth),
            Input { topic: Topic::Dwells, required: Required::IfDwellsAreRecorded },
            always(Topic::Plots),
            always(Topic::Actions),
            always(Topic::Tracks),
            always(Topic::SystemTracks),
            always(Topic::ClutterMap),
            never(Topic::HealthReports),
        ],
        outputs: &[],
    },
    Stage {
        name: DISPLAY,
        role: Role::Observer(Observer::Display),
        inputs: &[
            never(Topic::Truth),
            never(Topic::Dwells),
            never(Topic::Plots),
            never(Topic::Tracks),
            never(Topic::SystemTracks),
            never(Topic::Actions),
            never(Topic::ClutterMap),
            never(Topic::HealthReports),
        ],
        outputs: &[Topic::Commands],
    },
    Stage {
        name: OUTPUTS,
        role: Role::Observer(Observer::Outputs),
        inputs: &[never(Topic::Tracks), never(Topic::Plots), never(Topic::SystemTracks), never(Topic::Actions)],
        outputs: &[],
    },
];

/// Name of the stage that makes tracks from plots.
pub const TRACKER: &str = "tracker";
/// Name of the stage that makes the tracks of one site from those of all others.
pub const FUSION: &str = "fusion";
/// Name of the stage that sends what a site says to another host.
pub const LINK_OUT: &str = "link-out";
/// Name of the stage that gets it there.
pub const LINK_IN: &str = "link-in";
/// Name of the recorder.
pub const RECORDER: &str = "recorder";
/// Name of the picture in a browser.
pub const DISPLAY: &str = "display";
/// Name of the outputs to other systems.
pub const OUTPUTS: &str = "outputs";

impl Stage {
    /// The stage of this name.
    pub fn from_name(name: &str) -> Option<&'static Self> {
        STAGES.iter().find(|stage| stage.name == name)
    }

    /// Whether it sets the pace of its site.
    pub fn is_source(&self) -> bool {
        matches!(self.role, Role::Source(_))
    }

    /// Whether there is one for all sites.
    pub fn is_of_chain(&self) -> bool {
        self.role == Role::Recorder || self.is_observer()
    }

    /// Whether the run neither waits for it nor depends on it.
    pub fn is_observer(&self) -> bool {
        matches!(self.role, Role::Observer(_))
    }

    /// Whether what it reads comes from other sites than its own.
    pub fn reads_other_sites(&self) -> bool {
        self.name == FUSION
    }

    /// Whether publishers of `topic` wait for it in a chain with this configuration.
    pub fn requires(&self, topic: Topic, chain: &ChainConfig) -> bool {
        self.inputs.iter().any(|input| input.topic == topic && input.required.holds(topic, chain))
    }

    /// Its bit in a set of stages, and the event by which it tells publishers that it has found them.
    pub(crate) fn number(&self) -> usize {
        STAGES.iter().position(|stage| stage.name == self.name).unwrap_or(STAGES.len())
    }
}

impl Required {
    fn holds(self, topic: Topic, chain: &ChainConfig) -> bool {
        match self {
            Self::Always => true,
            Self::IfDwellsAreRecorded => chain.recorder.dwells,
            Self::IfSent => chain.link.send.contains(&topic),
            Self::Never => false,
        }
    }
}

/// The stages of a site with this configuration, upstream first; those that serve all sites are the last: the recorder, and
/// after it the observers.
pub fn stages(chain: &ChainConfig) -> Vec<&'static Stage> {
    let source = chain.run.source;
    let mut stages: Vec<&Stage> = STAGES.iter().filter(|stage| stage.role == Role::Source(source)).collect();
    let sends = !chain.link.send.is_empty();
    stages.extend(reached(&STAGES, driving(chain)).into_iter().filter(|stage| sends || stage.name != LINK_OUT));
    stages.extend(STAGES.iter().filter(|stage| stage.role == Role::Recorder));
    stages.extend(STAGES.iter().filter(|stage| match stage.role {
        Role::Observer(observer) => observer.is_enabled(chain),
        _ => false,
    }));
    stages
}

/// Whether a process of this name is an observer of the table: what it loses and its restarts are none of the chain.
pub fn is_observer(name: &str) -> bool {
    Stage::from_name(name).is_some_and(Stage::is_observer)
}

/// The processors that a topic sets to work, itself or by the results of others of them.
fn reached(table: &'static [Stage], from: Topic) -> Vec<&'static Stage> {
    let (mut reached, mut available) = (Vec::new(), vec![from]);
    for stage in table.iter().filter(|stage| stage.role == Role::Processor) {
        if stage.inputs.first().is_some_and(|input| available.contains(&input.topic)) {
            reached.push(stage);
            available.extend(stage.outputs);
        }
    }
    reached
}

/// Whether a stage of this name runs at a site with this configuration.
pub fn runs(chain: &ChainConfig, name: &str) -> bool {
    stages(chain).iter().any(|stage| stage.name == name)
}

/// Name of a process for people and in reports: `SITE/PROCESS`, or the process alone.
pub fn label(site: Option<&str>, process: &str) -> String {
    site.map_or_else(|| process.to_string(), |site| format!("{site}/{process}"))
}

/// The topic that drives a site: what its source publishes, and the stages after it wait for.
pub fn driving(chain: &ChainConfig) -> Topic {
    match chain.run.source {
        Source::RadarSim | Source::VideoSource => Topic::Dwells,
        Source::PlotSource | Source::External => Topic::Plots,
        Source::Fusion => Topic::Tracks,
        Source::Link => last_in_processing(&chain.link.receive),
        Source::Replay => last_in_processing(&chain.replay.topics),
    }
}

/// The last of several topics in the order of processing.
pub fn last_in_processing(topics: &[Topic]) -> Topic {
    let processors = STAGES.iter().rev().filter(|stage| stage.role == Role::Processor);
    let mut backwards = processors.flat_map(|stage| stage.outputs.iter().copied().chain([stage.inputs[0].topic]));
    backwards.find(|topic| topics.contains(topic)).unwrap_or(Topic::Plots)
}

/// The stage whose results, each from messages of its input, travel on `topic`, and the topic that it makes them from.
pub fn maker(topic: Topic) -> Option<(&'static Stage, Topic)> {
    let mut processors = STAGES.iter().filter(|stage| stage.role == Role::Processor);
    processors.find(|stage| stage.outputs.first() == Some(&topic)).map(|stage| (stage, stage.inputs[0].topic))
}

/// The stages of a site that publishers of `topic` wait for, one bit each.
pub(crate) fn required_consumers(topic: Topic, chain: &ChainConfig) -> u32 {
    let own = stages(chain).into_iter().filter(|stage| !stage.reads_other_sites());
    let fusion = chain.run.fused.then(|| Stage::from_name(FUSION)).flatten();
    let consumers = own.chain(fusion).filter(|stage| stage.requires(topic, chain));
    consumers.fold(0, |bits, stage| bits | 1 << stage.number())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(change: impl FnOnce(&mut ChainConfig)) -> Vec<&'static str> {
        let mut chain = ChainConfig::default();
        chain.display.enabled = false;
        change(&mut chain);
        stages(&chain).into_iter().map(|stage| stage.name).collect()
    }

    #[test]
    fn a_chain_has_the_stages_after_its_source() {
        assert_eq!(names(|_| {}), ["radar-sim", "plot-extractor", "tracker", "recorder"]);
        assert_eq!(names(|chain| chain.run.source = Source::PlotSource), ["plot-source", "tracker", "recorder"]);
        let video = |chain: &mut ChainConfig| chain.run.source = Source::VideoSource;
        assert_eq!(names(video), ["video-source", "plot-extractor", "tracker", "recorder"]);
        assert_eq!(names(|chain| chain.run.source = Source::External), ["tracker", "recorder"]);
        assert_eq!(names(|chain| chain.run.source = Source::Fusion), ["fusion", "recorder"]);
        assert_eq!(names(|chain| chain.run.source = Source::Link), ["link-in", "recorder"]);
        let plots_from_afar =
            |chain: &mut ChainConfig| (chain.run.source, chain.link.receive) = (Source::Link, vec![Topic::Plots]);
        assert_eq!(names(plots_from_afar), ["link-in", "tracker", "recorder"]);
        let sent = |chain: &mut ChainConfig| chain.link.send = vec![Topic::Tracks];
        assert_eq!(names(sent), ["radar-sim", "plot-extractor", "tracker", "link-out", "recorder"]);
        let replay = |topics: &[Topic]| {
            names(|chain| (chain.run.source, chain.replay.topics) = (Source::Replay, topics.to_vec()))
        };
        assert_eq!(replay(&[Topic::Dwells, Topic::Truth]), ["replay", "plot-extractor", "tracker", "recorder"]);
        assert_eq!(replay(&[Topic::Plots, Topic::Truth]), ["replay", "tracker", "recorder"]);
        assert_eq!(replay(&[Topic::Dwells, Topic::Plots]), ["replay", "tracker", "recorder"]);
        assert_eq!(replay(&[Topic::Truth, Topic::Tracks]), ["replay", "recorder"]);
    }

    #[test]
    fn a_topic_may_have_several_consumers_and_a_consumer_no_results() {
        static TABLE: [Stage; 3] = [
            Stage { name: "a", role: Role::Processor, inputs: &[always(Topic::Plots)], outputs: &[Topic::Tracks] },
            Stage { name: "b", role: Role::Processor, inputs: &[always(Topic::Plots)], outputs: &[] },
            Stage { name: "c", role: Role::Processor, inputs: &[always(Topic::Tracks)], outputs: &[] },
        ];
        let names = |from| reached(&TABLE, from).iter().map(|stage| stage.name).collect::<String>();
        assert_eq!([Topic::Plots, Topic::Tracks, Topic::Dwells].map(names), ["abc", "c", ""]);
    }

    #[test]
    fn publishers_wait_for_those_that_the_table_names_and_for_nobody_else() {
        let mut chain = ChainConfig::default();
        let bits = |names: &[&str]| {
            names.iter().fold(0, |bits, name| bits | 1 << Stage::from_name(name).expect("a stage").number())
        };
        assert_eq!(required_consumers(Topic::Dwells, &chain), bits(&["plot-extractor"]));
        assert_eq!(required_consumers(Topic::Plots, &chain), bits(&["tracker", "recorder"]));
        assert_eq!(required_consumers(Topic::HealthReports, &chain), 0);
        chain.run.fused = true;
        assert_eq!(required_consumers(Topic::Tracks, &chain), bits(&["fusion", "recorder"]));
        (chain.run.fused, chain.run.source) = (false, Source::Fusion);
        assert_eq!(required_consumers(Topic::Tracks, &chain), bits(&["recorder"]));
        chain.run.source = Source::RadarSim;
        chain.link.send = vec![Topic::Truth];
        assert_eq!(required_consumers(Topic::Truth, &chain), bits(&["link-out", "recorder"]));
        assert_eq!(required_consumers(Topic::Tracks, &chain), bits(&["recorder"]));
        chain.recorder.dwells = true;
        assert_eq!(required_consumers(Topic::Dwells, &chain), bits(&["plot-extractor", "recorder"]));
    }

    #[test]
    fn observers_come_and_go_with_the_configuration_and_nobody_waits_for_them() {
        let chain = ChainConfig::default();
        let with_display = names(|chain| chain.display.enabled = true);
        assert_eq!(with_display, ["radar-sim", "plot-extractor", "tracker", "recorder", "display"]);
        for stage in STAGES.iter().filter(|stage| stage.is_observer()) {
            assert!(stage.is_of_chain() && is_observer(stage.name));
            assert!(Topic::ALL.iter().all(|&topic| !stage.requires(topic, &chain)), "{}", stage.name);
        }
    }

    #[test]
    fn results_are_made_from_the_topic_before() {
        assert_eq!(maker(Topic::Tracks).map(|(stage, from)| (stage.name, from)), Some(("tracker", Topic::Plots)));
        assert_eq!(maker(Topic::Truth), None);
    }
}
