//! `isochore frames`: rotation-minimizing frames of a sampled curve.

use crate::{
    Outcome,
    arguments::{FramesArguments, Twist},
    command_error::CommandError,
    console::Console,
    spine_file::SpineFile,
    staging::Staging,
};

const HEADER: [&str; 12] = ["x", "y", "z", "rx", "ry", "rz", "sx", "sy", "sz", "tx", "ty", "tz"];

pub(crate) fn frames(arguments: &FramesArguments, console: &Console) -> Result<Outcome, CommandError> {
    let mut staging = Staging::new(console.interrupt());
    let draft = staging.add_file(&arguments.output)?;
    let result = SpineFile::read(&arguments.spine)?.stations(&arguments.spine, Twist::None)?;
    // One row a sample: a closed curve does not repeat its first point, neither read nor written.
    let count = result.stations.len() - usize::from(result.is_closed);
    let mut writer = csv::Writer::from_writer(Vec::new());
    let mut write = || {
        writer.write_record(HEADER)?;
        for (point, frame) in &result.stations[..count] {
            let numbers = [*point, frame.r, frame.s, frame.t].into_iter().flat_map(|vector| vector.to_array());
            // One digit before the point and sixteen after it.
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
