//! The figures: recipes run by the command, examples run as programs, and one page that shows them all.

mod page;

use std::{
    collections::BTreeSet,
    fs,
    path::{Path, PathBuf},
};

use crate::shell::{TaskResult, cargo, run, target, workspace};

/// A figure of Zheng's thesis, and the recipes and pictures that reproduce it.
struct Figure {
    /// Its number in the thesis, or the section that describes it without one.
    number: &'static str,
    /// Caption.
    shows: &'static str,
    /// Recipes of the folder `data/recipes` that deform for it.
    recipes: &'static [&'static str],
    /// Pictures that examples draw for it.
    drawings: &'static [&'static str],
}

/// The chapters on deformation.
const DEFORMATIONS: [Figure; 18] = [
    Figure {
        number: "9.1",
        shows: "A ball moves through a surface, which closes behind it",
        recipes: &["region"],
        drawings: &[],
    },
    Figure {
        number: "11.2",
        shows: "Field of a ball on a section: red inside, blue outside, green for the ball's motion",
        recipes: &["sphere"],
        drawings: &["field_sphere"],
    },
    Figure {
        number: "11.3",
        shows: "Field along a strip on a section, and the horn that it draws out of a planet",
        recipes: &["strip_along"],
        drawings: &["field_strip_along"],
    },
    Figure {
        number: "11.4",
        shows: "Field across a strip on a section, the wire that it pushes into a slab, and a spine that changes its shape",
        recipes: &["strip_across", "slither"],
        drawings: &["field_strip_across"],
    },
    Figure {
        number: "11.5",
        shows: "Field of a ring on a section, and the ring pressed into a slab",
        recipes: &["ring"],
        drawings: &["field_ring"],
    },
    Figure {
        number: "11.6",
        shows: "Bodies deformed by a ball, a strip and a shape of free form",
        recipes: &["sphere", "strip_along", "free_form"],
        drawings: &[],
    },
    Figure {
        number: "11.7",
        shows: "A shape, the support of its field, and an offset surface between them, cut open",
        recipes: &["knight"],
        drawings: &["shells_knight"],
    },
    Figure {
        number: "11.8",
        shows: "A foot and a coin are stamped, with all their relief",
        recipes: &["foot", "coin"],
        drawings: &[],
    },
    Figure { number: "11.2.6", shows: "A jointed hand closes on clay", recipes: &["grip"], drawings: &[] },
    Figure {
        number: "12.1",
        shows: "Field of a shape of free form on a section, colored by speed",
        recipes: &["knight"],
        drawings: &["field_knight"],
    },
    Figure {
        number: "12.2",
        shows: "Support of a field that depends on a radius, and of one that depends on the shape",
        recipes: &["knight"],
        drawings: &["shells_reach"],
    },
    Figure {
        number: "12.4",
        shows: "A hare, a chess piece and a rocker arm are pressed into a planet",
        recipes: &["hare", "chess", "rocker_arm"],
        drawings: &[],
    },
    Figure {
        number: "12.6",
        shows: "Field of a rod that turns, and the groove that it turns into a cube",
        recipes: &["rod"],
        drawings: &["field_rod"],
    },
    Figure { number: "12.8", shows: "A bar of square section is twisted", recipes: &["bar"], drawings: &[] },
    Figure { number: "12.9", shows: "A standing figure turns at the waist", recipes: &["waist"], drawings: &[] },
    Figure { number: "12.10", shows: "A cube is bent to a swirl", recipes: &["cube"], drawings: &[] },
    Figure {
        number: "12.11",
        shows: "A disc of two colors becomes a Tai Chi sign",
        recipes: &["taichi"],
        drawings: &[],
    },
    Figure {
        number: "12.12",
        shows: "A hand leaves its print on a planet: by its field, and stamped",
        recipes: &["hand", "handprint"],
        drawings: &[],
    },
];

/// The chapters on frames; the numbers of the figures that they follow are in the programs.
const FRAMES: [(&str, &str); 11] = [
    ("snake", "A snake along its spine, by rotation-minimizing and by Frenet frames"),
    ("deforming_spine", "The same while its spine deforms"),
    ("frame_errors", "A torus knot colored by the error of four methods"),
    ("closed_frames_arc", "Closed frames with 0, 1 and 2 turns, proportional to arc length"),
    ("closed_frames_turning", "The same, proportional to turning"),
    ("cinquefoil", "The cinquefoil knot"),
    ("trefoil", "The trefoil knot"),
    ("dragon", "A dragon's body"),
    ("glass_table", "A table of glass with constraints along its rim"),
    ("moulding", "Ruled and moulding surfaces"),
    ("moebius", "A rational curve with rational frames"),
];

/// Runs all recipes and programs, and writes meshes, pictures, reports and the page `gallery.md` into the folder `gallery`.
pub(crate) fn draw_all() -> TaskResult {
    let folder = workspace().join("gallery");
    fs::create_dir_all(&folder)?;
    let packages = ["--package", "isochore-cli", "--package", "isochore-examples"];
    run(cargo(&["build", "--release", "--locked"]).args(packages))?;
    for program in programs()? {
        run(std::process::Command::new(target().join("release").join(program)).arg(&folder))?;
    }
    let recipes: BTreeSet<&str> = DEFORMATIONS.iter().flat_map(|figure| figure.recipes).copied().collect();
    for recipe in recipes {
        deform(recipe, &folder)?;
    }
    fs::write(folder.join("gallery.md"), page::write(&folder)?)?;
    Ok(())
}

fn programs() -> TaskResult<Vec<String>> {
    let entries = fs::read_dir(workspace().join("examples/src/bin"))?;
    let mut names: Vec<String> =
        entries.filter_map(|entry| Some(entry.ok()?.path().file_stem()?.to_str()?.to_owned())).collect();
    names.sort();
    Ok(names)
}

/// Runs a recipe with all its outputs in `folder`, where they are named after it.
fn deform(recipe: &str, folder: &Path) -> TaskResult {
    let output = |extension: &str| folder.join(recipe).with_extension(extension);
    let preview = format!("output.preview={:?}", output("png").display().to_string());
    let mut command = std::process::Command::new(target().join("release/isochore"));
    command.arg("run").arg(recipe_file(recipe)).args(["--quiet", "--set", &preview]);
    run(command.arg("--output").arg(output("ply")).arg("--report").arg(output("json")))
}

fn recipe_file(recipe: &str) -> PathBuf {
    workspace().join("data/recipes").join(recipe).with_extension("toml")
}

#[test]
fn every_figure_has_its_recipes() {
    for figure in &DEFORMATIONS {
        assert!(!figure.recipes.is_empty(), "{}", figure.number);
        for recipe in figure.recipes {
            assert!(recipe_file(recipe).is_file(), "{recipe}");
            // Both write a picture of that name into the same folder.
            assert!(FRAMES.iter().all(|(name, _)| name != recipe) && !figure.drawings.contains(recipe), "{recipe}");
        }
    }
}
