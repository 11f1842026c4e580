//! The user's guide: every page of `docs/guide` as one HTML file that needs no other, with the tables of variables
//! from the variables themselves. In the guide of an FMU the page with its variables comes first, then the others in
//! the order of the file names.

mod code;
mod markdown;
pub mod variables;

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use anyhow::{Context, Result, ensure};
use base64::prelude::{BASE64_STANDARD, Engine};

use crate::{Fmu, icon, page};
use code::Block;
use markdown::{Page, code_here, embedded, variables_here};

/// Where the pages are, relative to the workspace.
pub const PAGES: &str = "docs/guide";

const STYLE: &str = include_str!("guide.css");

/// The picture on top, relative to the workspace.
const PICTURE: &str = "docs/figures/snap.png";

/// The guide of an FMU as HTML, opened by a link to the live page where there is one beside it.
///
/// # Errors
/// If no page shows the variables of the FMU, or a page has a formula, link or figure that cannot be
/// followed: the page and the culprit are named.
pub fn html(workspace: &Path, fmu: &Fmu, with_page: bool) -> Result<String> {
    let folder = workspace.join(PAGES);
    let mut files = Vec::new();
    for entry in
        fs::read_dir(&folder).with_context(|| format!("cannot list {}", folder.display()))?
    {
        let path = entry?.path();
        if path.extension().is_some_and(|extension| extension == "md") {
            files.push(path);
        }
    }
    files.sort();
    let mut pages: Vec<Page> = files
        .iter()
        .map(|file| markdown::page(file).with_context(|| format!("in the page {}", file.display())))
        .collect::<Result<_>>()?;
    let places: BTreeSet<&String> = pages.iter().flat_map(|page| &page.places).collect();
    for page in &pages {
        for link in &page.links {
            ensure!(
                places.contains(link),
                "{}.md links to #{link}, which is nowhere",
                page.name
            );
        }
    }
    colour(&mut pages)?;
    let own = pages
        .iter()
        .position(|page| page.fmus.contains(&fmu.identifier))
        .with_context(|| format!("no page has the line {}", variables_here(fmu)))?;
    pages[..=own].rotate_right(1);
    let picture = embedded(&workspace.join(PICTURE))?;
    document(&pages, fmu, &picture, with_page)
}

/// Puts all blocks of code, coloured, in their places.
fn colour(pages: &mut [Page]) -> Result<()> {
    let blocks: Vec<Block> = pages
        .iter()
        .flat_map(|page| page.code.iter().cloned())
        .collect();
    let mut coloured = code::coloured(&blocks)?.into_iter();
    for page in pages {
        for number in 0..page.code.len() {
            let piece = coloured.next().context("a block of code is lost")?;
            let block = format!("<pre tabindex=\"0\"><code>{piece}</code></pre>\n");
            page.html = page.html.replacen(&code_here(number), &block, 1);
        }
    }
    Ok(())
}

/// What the FMU is, with a picture, then the pages below one another, with links to each before them.
fn document(pages: &[Page], fmu: &Fmu, picture: &str, with_page: bool) -> Result<String> {
    let live = if with_page {
        format!(
            "<p class=\"live\"><a href=\"{}\">See it move in your browser</a></p>\n",
            page::NAME
        )
    } else {
        String::new()
    };
    let entries: String = pages
        .iter()
        .map(|page| format!("<a href=\"#{}\">{}</a>\n", page.name, page.title))
        .collect();
    let sections: String = pages
        .iter()
        .map(|page| format!("<section>\n{}</section>\n", page.html))
        .collect();
    Ok(format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <meta name=\"color-scheme\" content=\"light dark\">\n\
         <title>Dielectric elastomer actuator {version}</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n\
         <header>\n<img class=\"icon\" alt=\"\" src=\"data:image/png;base64,{icon}\">\n\
         <h1>Dielectric elastomer actuator</h1>\n<p class=\"version\">FMI 2.0 unit <code>{identifier}</code>, \
         version {version}</p>\n\
         <p>A soft capacitor: a voltage squeezes the membrane between two electrodes, and it spreads. {about} \
         Its accuracy is that of the tolerance, at any communication step.</p>\n\
         <img alt=\"A film at rest, swinging at 715 V and snapping at 716 V: membranes from the side, and \
         their width over time\" src=\"{picture}\">\n{live}</header>\n\
         <nav>\n{entries}</nav>\n<main>\n{sections}</main>\n</body>\n</html>\n",
        identifier = fmu.identifier,
        about = fmu.about,
        version = env!("CARGO_PKG_VERSION"),
        icon = BASE64_STANDARD.encode(icon::png()?),
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::FMUS;
    use markdown::tests::rendered;

    #[test]
    fn blocks_of_code_are_coloured_in_their_places() -> Result<()> {
        let mut pages = [rendered(
            "# T\n\n```python\nif True:\n    a = 1e-3 < 2\n```\n\nb\n",
        )?];
        colour(&mut pages)?;
        let html = &pages[0].html;
        assert!(html.contains("<code><span class=\"k\">if</span>"), "{html}");
        assert!(html.contains("</code></pre>") && !html.contains("<!-- code"));
        Ok(())
    }

    #[test]
    fn the_guide_of_each_fmu_stands_alone_and_begins_with_it() -> Result<()> {
        for fmu in FMUS {
            let guide = html(&Path::new(env!("CARGO_MANIFEST_DIR")).join(".."), fmu, true)?;
            assert!(guide.contains("<math") && guide.contains("src=\"data:image/"));
            assert!(
                !guide.contains("src=\"http")
                    && !guide.contains("<link")
                    && !guide.contains("<script")
            );
            let first = guide.split("</section>").next().unwrap_or_default();
            assert!(first.contains(&(fmu.variables)()), "{}", fmu.identifier);
        }
        assert!(rendered("# T\n\n<!-- variables of Nothing -->\n").is_err());
        Ok(())
    }
}
