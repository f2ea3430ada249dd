//! Links between the documents of the repository.

use std::{collections::BTreeSet, fs, path::Path};

use crate::shell::{TaskResult, project_files, workspace};

/// Fails on a link or image in a Markdown file whose target, or the heading within it, does not exist.
///
/// Addresses of other sites are not opened.
pub(super) fn check() -> TaskResult {
    let mut broken = Vec::new();
    for path in project_files(&["*.md"])? {
        broken.extend(broken_links(&workspace().join(path))?);
    }
    if broken.is_empty() { Ok(()) } else { Err(broken.join("\n").into()) }
}

fn broken_links(path: &Path) -> TaskResult<Vec<String>> {
    let text = fs::read_to_string(path)?;
    let folder = path.parent().ok_or("a document lies in a folder")?;
    let mut broken = Vec::new();
    for (line, link) in links(&text) {
        let (file, anchor) = link.split_once('#').unwrap_or((&link, ""));
        let target = if file.is_empty() { path.to_owned() } else { folder.join(file) };
        let place = || format!("{}:{line}: ", path.strip_prefix(workspace()).unwrap_or(path).display());
        if !target.exists() {
            broken.push(format!("{}`{file}` does not exist", place()));
        } else if !anchor.is_empty() && !anchors(&fs::read_to_string(&target)?).contains(anchor) {
            broken.push(format!("{}no heading of `{}` has the anchor `{anchor}`", place(), target.display()));
        }
    }
    Ok(broken)
}

/// Relative links with the number of their line, those inside code left out.
fn links(text: &str) -> Vec<(usize, String)> {
    let mut links = Vec::new();
    let mut is_code = false;
    for (index, line) in text.lines().enumerate() {
        is_code ^= line.trim_start().starts_with("```");
        if is_code {
            continue;
        }
        let prose: String = line.split('`').step_by(2).collect::<Vec<_>>().join("`");
        for rest in prose.split("](").skip(1) {
            let link = rest.split([')', ' ']).next().unwrap_or_default();
            if !link.contains("://") && !link.starts_with("mailto:") {
                links.push((index + 1, link.to_owned()));
            }
        }
    }
    links
}

/// The anchors of the headings, as mdBook and code hosts derive them.
fn anchors(text: &str) -> BTreeSet<String> {
    let mut is_code = false;
    let mut anchors = BTreeSet::new();
    for line in text.lines() {
        is_code ^= line.trim_start().starts_with("```");
        if !is_code && line.starts_with('#') {
            let heading = line.trim_start_matches('#').trim().to_lowercase();
            let kept = heading.chars().filter(|letter| letter.is_alphanumeric() || " -_".contains(*letter));
            anchors.insert(kept.map(|letter| if letter == ' ' { '-' } else { letter }).collect());
        }
    }
    anchors
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn relative_links_are_found_outside_code() {
        let text = "See [a](b.md#c) and `[no](x)`.\n```\n[no](y)\n```\n![p](i.png) [s](https://s.org)\n";
        assert_eq!(links(text), [(1, "b.md#c".to_owned()), (5, "i.png".to_owned())]);
    }

    #[test]
    fn anchors_follow_the_headings() {
        let anchors = anchors("# Two Words\n```\n# not this\n```\n## `key` and more\n");
        assert_eq!(anchors.into_iter().collect::<Vec<_>>(), ["key-and-more", "two-words"]);
    }
}
