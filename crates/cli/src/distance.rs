//! `isochore distance`: the signed distance of a mesh as a NumPy array.

use isochore_mesh::{DistanceField, DistanceFieldError, DistanceFieldOptions, Padding};
use npyz::WriterBuilder;
use serde::Serialize;

use crate::{
    arguments::DistanceArguments, command_error::CommandError, console::Console, mesh_file::read_mesh,
    outcome::Outcome, staging::Staging,
};

/// Contents of the JSON file beside the array.
#[derive(Debug, Clone, Serialize)]
struct Metadata {
    /// Position of the sample with index [0, 0, 0], model units.
    origin: [f64; 3],
    /// Distance between neighboring samples, model units.
    cell: f64,
    /// Number of samples along x, y and z.
    dims: [usize; 3],
    /// Upper bound of the error of a sample, model units.
    error_bound: f64,
}

pub(crate) fn distance(arguments: &DistanceArguments, console: &Console) -> Result<Outcome, CommandError> {
    if arguments.output.extension().is_none_or(|extension| extension != "npy") {
        return Err(CommandError::file(&arguments.output, "the output must end in .npy"));
    }
    let mut staging = Staging::new(console.interrupt());
    let array_draft = staging.add_file(&arguments.output)?;
    let metadata_draft = staging.add_file(&arguments.output.with_extension("json"))?;

    let mesh = read_mesh(&arguments.mesh, console)?;
    let options = DistanceFieldOptions {
        resolution: arguments.resolution as usize,
        padding: arguments.padding.map_or(Padding::Cells(2), Padding::Length),
        ..DistanceFieldOptions::default()
    };
    let field = DistanceField::new(&mesh, &options, console).map_err(|error| match error {
        DistanceFieldError::Cancelled(cancelled) => cancelled.into(),
        error => CommandError::file(&arguments.mesh, error),
    })?;
    if !field.is_closed() {
        let mesh = arguments.mesh.display();
        let text = "the mesh is open; points with a winding number above 1/2 count as inside";
        console.warn("warning", format_args!("{mesh}: {text}"));
    }
    let grid = field.grid();
    staging.write(&array_draft, &npy(field.samples(), grid.dims))?;
    let metadata = Metadata {
        origin: grid.origin.to_array(),
        cell: grid.cell,
        dims: grid.dims,
        error_bound: field.sample_error(),
    };
    staging.write(&metadata_draft, format!("{}\n", crate::console::to_json(&metadata)).as_bytes())?;
    staging.commit()?;
    console.finish();
    if console.is_json() {
        console.print_json(&metadata);
    } else {
        let [x, y, z] = grid.dims;
        let name = arguments.output.display();
        console.say(format_args!(
            "{name}: {x} × {y} × {z} samples, spacing {:.3e}, error at most {:.1e}",
            metadata.cell, metadata.error_bound
        ));
    }
    Ok(Outcome::Done)
}

/// Encodes samples, with x varying fastest, as an array with index [z, y, x].
fn npy(samples: &[f32], dims: [usize; 3]) -> Vec<u8> {
    let [x, y, z] = dims.map(|count| count as u64);
    let mut bytes = Vec::with_capacity(size_of_val(samples) + 128);
    let mut write = || {
        let mut writer = npyz::WriteOptions::new().default_dtype().shape(&[z, y, x]).writer(&mut bytes).begin_nd()?;
        writer.extend(samples.iter().copied())?;
        writer.finish()
    };
    write().expect("the shape matches the number of samples, and writing to memory does not fail");
    bytes
}
