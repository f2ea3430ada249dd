//! The page that shows the figures beside what was measured.

use std::{fmt::Write, fs, path::Path};

use serde_json::Value;

use super::{DEFORMATIONS, FRAMES};
use crate::shell::TaskResult;

/// The page in Markdown, from the pictures and reports in `folder`.
///
/// # Errors
/// A picture or report that should be there and is not.
pub(super) fn write(folder: &Path) -> TaskResult<String> {
    let mut page = String::from(
        "# Gallery\n\n\
         Figures of D. Zheng, *Studies on Motion and Deformation in Graphics*, 2008, made anew by `cargo xtask gallery`. The\n\
         models are this project's own, and so are the paths, which the thesis does not print. Changes of volume are relative;\n\
         bare is before the final lock.\n",
    );
    for figure in &DEFORMATIONS {
        write!(page, "\n## {} {}\n\n", figure.number, figure.shows)?;
        for name in figure.drawings.iter().chain(figure.recipes) {
            picture(&mut page, folder, name, figure.shows)?;
        }
        facts(&mut page, folder, figure.recipes)?;
    }
    page.push_str("\n## Table 13.1 Six cases\n\nLeft as measured here, right as the thesis prints them. A frame here is a step on one \
         core that passes over what the tool does not reach; the thesis' frames are also drawn.\n\n");
    page.push_str(&fs::read_to_string(folder.join("collision_table.md"))?);
    page.push_str("\n# Frames\n");
    for (name, shows) in FRAMES {
        write!(page, "\n## {shows}\n\n")?;
        picture(&mut page, folder, name, shows)?;
    }
    Ok(page)
}

fn picture(page: &mut String, folder: &Path, name: &str, shows: &str) -> TaskResult {
    if !folder.join(name).with_extension("png").is_file() {
        return Err(format!("no program and no recipe has drawn {name}.png").into());
    }
    Ok(write!(page, "![{shows}]({name}.png)\n\n")?)
}

/// A table with a row for each recipe.
fn facts(page: &mut String, folder: &Path, recipes: &[&str]) -> TaskResult {
    page.push_str("| recipe | triangles | refined to | bare | written | crossing |\n|---|---:|---:|---:|---:|---:|\n");
    for recipe in recipes {
        let report: Value = serde_json::from_slice(&fs::read(folder.join(recipe).with_extension("json"))?)?;
        let change = |key: &str| report[key].as_f64().map_or_else(|| "–".to_owned(), |change| format!("{change:+.1e}"));
        writeln!(
            page,
            "| [`{recipe}`]({recipe}.json) | {} | {} | {} | {} | {} |",
            report["before"]["triangles"],
            report["after"]["triangles"],
            change("volume_change_before_lock"),
            change("volume_change"),
            report["after"]["self_intersecting_triangles"],
        )?;
    }
    Ok(())
}
