//! The stages as this one program runs them: `radar-chain stage NAME`.

use std::os::unix::process::CommandExt;
use std::process::{Command, ExitCode};

use anyhow::Context;
use clap::builder::PossibleValuesParser;
use common::process::{BadInput, StageArgs};
use common::topology::{LINK_IN, LINK_OUT, STAGES};

use crate::keeper;
use crate::stages::name::KEEPER;

/// Names of the stages, as `radar-chain stage` takes them.
pub(crate) fn names() -> PossibleValuesParser {
    PossibleValuesParser::new(STAGES.iter().map(|stage| stage.name).chain([KEEPER]))
}

/// Runs the stage `name` in this process.
pub(crate) fn run_stage(name: &str, args: &StageArgs) -> anyhow::Result<ExitCode> {
    match name {
        radar_sim::process::NAME => radar_sim::process::run(args),
        plot_source::process::NAME => plot_source::process::run(args),
        video_source::process::NAME => video_source::process::run(args),
        recorder::replay_process::NAME => recorder::replay_process::run(args),
        plot_extractor::process::NAME => plot_extractor::process::run(args),
        tracker::process::NAME => tracker::process::run(args),
        fusion::process::NAME => fusion::process::run(args),
        recorder::process::NAME => recorder::process::run(args),
        LINK_IN | LINK_OUT => become_the_program("radar-link", "link", args),
        display::process::NAME => display::process::run(args),
        outputs::process::NAME => outputs::process::run(args),
        KEEPER => keeper::keep(args),
        other => anyhow::bail!("stage `{other}` is in the table of stages, but this program does not have it"),
    }
}

/// Goes on as another program, which `package` makes, has the stage and stands beside this one, with the same arguments.
fn become_the_program(name: &str, package: &str, args: &StageArgs) -> anyhow::Result<ExitCode> {
    args.load()?;
    let program = std::env::current_exe().context("finding this program")?.with_file_name(name);
    if !program.is_file() {
        let missing = format!(
            "expected the program {name} as {}: cargo build --release -p {package} makes it",
            program.display()
        );
        return Err(BadInput(missing).into());
    }
    let mut words = std::env::args_os();
    let own_name = words.next().unwrap_or_default();
    let error = Command::new(&program).arg0(own_name).args(words).exec();
    Err(error).with_context(|| format!("starting {}", program.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_stage_of_the_table_is_in_this_program() {
        let args = StageArgs { config: Some("/no such file".into()), ..StageArgs::default() };
        for stage in &STAGES {
            let error = run_stage(stage.name, &args).expect_err("there is no such file").to_string();
            assert!(error.contains("cannot read configuration file"), "{}: {error}", stage.name);
        }
    }
}
