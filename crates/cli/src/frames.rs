//! `isochore frames`: rotation-minimizing frames of a sampled curve.

use crate::{
    arguments::{FramesArguments, Twist},
    command_error::CommandError,
    console::Console,
    outcome::Outcome,
    spine_file::SpineFile,
    spine_options::SpineOptions,
    staging::Staging,
};

const HEADER: [&str; 12] = ["x", "y", "z", "rx", "ry", "rz", "sx", "sy", "sz", "tx", "ty", "tz"];

pub(crate) fn frames(arguments: &FramesArguments, console: &Console) -> Result<Outcome, CommandError> {
    let options = SpineOptions::new(&arguments.spine, Twist::None)?;
    let mut staging = Staging::new(console.interrupt());
    let draft = staging.add_file(&arguments.output)?;
    let result = SpineFile::read(&options)?.stations(&options)?;
    // One row per sample. The file of a closed curve does not repeat its first point.
    let count = result.stations.len() - usize::from(result.is_closed);
    let mut writer = csv::Writer::from_writer(Vec::new());
    let mut write = || {
        writer.write_record(HEADER)?;
        for (point, frame) in &result.stations[..count] {
            let numbers = [*point, frame.r, frame.s, frame.t].into_iter().flat_map(|vector| vector.to_array());
            // One digit before the decimal point and sixteen after it.
            writer.write_record(numbers.map(|number| format!("{number:.16e}")))?;
        }
        writer.flush().map_err(csv::Error::from)
    };
    write().map_err(|error| CommandError::file(&arguments.output, error))?;
    let bytes = writer.into_inner().map_err(|error| CommandError::file(&arguments.output, error))?;
    staging.write(&draft, &bytes)?;
    staging.commit()?;
    console.finish();
    if console.is_json() {
        console.print_json(&result.facts);
    } else {
        console.say(format_args!("{}: {count} frames", arguments.output.display()));
    }
    Ok(Outcome::Done)
}
