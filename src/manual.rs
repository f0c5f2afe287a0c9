//! The manual that the command line gives of itself: shell completions, man pages.

use std::fs::File;
use std::io::Write;
use std::path::Path;
use std::process::ExitCode;

use anyhow::Context;
use clap::Command;
use clap_complete::Shell;

/// Prints the completions for `shell`.
pub(crate) fn print_completions(shell: Shell) -> anyhow::Result<ExitCode> {
    let mut commands = crate::command_line();
    let name = commands.get_name().to_string();
    let mut text = Vec::new();
    clap_complete::generate(shell, &mut commands, name, &mut text);
    std::io::stdout().write_all(&text).context("printing completions")?;
    Ok(ExitCode::SUCCESS)
}

/// Writes the man pages of the program and of its commands into `folder`.
pub(crate) fn write_man_pages(folder: &Path) -> anyhow::Result<ExitCode> {
    std::fs::create_dir_all(folder).with_context(|| format!("making {}", folder.display()))?;
    let mut program = crate::command_line();
    program.build(); // gives the commands their full names
    write_pages(&program, program.get_name(), folder)?;
    Ok(ExitCode::SUCCESS)
}

fn write_pages(command: &Command, name: &str, folder: &Path) -> anyhow::Result<()> {
    let path = folder.join(format!("{name}.1"));
    let page = clap_mangen::Man::new(command.clone()).title(name);
    let written = File::create(&path).and_then(|mut file| page.render(&mut file));
    written.with_context(|| format!("writing {}", path.display()))?;
    let shown = command.get_subcommands().filter(|command| !command.is_hide_set() && command.get_name() != "help");
    shown.into_iter().try_for_each(|command| write_pages(command, &format!("{name}-{}", command.get_name()), folder))
}
