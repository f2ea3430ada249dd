//! `isochore man`: manual pages in roff.

use std::path::Path;

use clap::CommandFactory;
use clap_mangen::Man;

use crate::{
    arguments::{Arguments, ManArguments},
    command_error::CommandError,
    console::Console,
    outcome::Outcome,
    staging::Staging,
};

pub(crate) fn man(arguments: &ManArguments, console: &Console) -> Result<Outcome, CommandError> {
    let mut command = Arguments::command().disable_help_subcommand(true);
    // Gives the subcommands their full names, such as `isochore-run`.
    command.build();
    match &arguments.output {
        Some(folder) => write_pages(&command, folder, console)?,
        None => console.print(String::from_utf8_lossy(&render(&Man::new(command))).trim_end()),
    }
    Ok(Outcome::Done)
}

/// Writes `isochore.1` and a page such as `isochore-run.1` for each subcommand.
fn write_pages(command: &clap::Command, folder: &Path, console: &Console) -> Result<(), CommandError> {
    let mut staging = Staging::new(console.interrupt());
    staging.add_folder(folder)?;
    let mut count = 0;
    for page in std::iter::once(command).chain(command.get_subcommands()) {
        let page = Man::new(page.clone());
        let draft = staging.add_file(&folder.join(page.get_filename()))?;
        staging.write(&draft, &render(&page))?;
        count += 1;
    }
    staging.commit()?;
    console.say(format_args!("{}: {count} manual pages", folder.display()));
    Ok(())
}

fn render(page: &Man) -> Vec<u8> {
    let mut text = Vec::new();
    page.render(&mut text).expect("writing to memory does not fail");
    text
}
