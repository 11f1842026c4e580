//! The user's guide: every page of `docs/guide`, in the order of the file names, as one HTML file that
//! needs no other: formulas as MathML, figures inside, the table of variables from the variables themselves.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail, ensure};
use base64::prelude::{BASE64_STANDARD, Engine};
use dielectric_elastomer_actuator::nondimensional::{Nondimensional, VARIABLES};
use dielectric_elastomer_actuator::variables::{Causality, Kind, Variability, Variable};
use pulldown_cmark::{
    CowStr, Event, HeadingLevel, Options, Parser, Tag, TagEnd, TextMergeStream, html,
};
use pulldown_latex::config::{DisplayMode, RenderConfig};
use pulldown_latex::{Parser as Formula, Storage, push_mathml};

use crate::page;

/// Where the pages are, relative to the workspace.
pub const PAGES: &str = "docs/guide";

/// What the table of variables takes the place of.
const VARIABLES_HERE: &str = "<!-- variables -->";

const STYLE: &str = include_str!("guide.css");

/// A page, rendered.
struct Page {
    /// Name of the file without extension, and of its place in the guide.
    name: String,
    title: String,
    html: String,
    /// The places that a link may lead to.
    places: BTreeSet<String>,
    /// Where its links inside the guide lead.
    links: Vec<String>,
}

/// The guide as HTML, opened by a link to the live page where there is one beside it.
///
/// # Errors
/// If there is no page, or a page has a formula, link or figure that cannot be followed: the page and
/// the culprit are named.
pub fn html(workspace: &Path, with_page: bool) -> Result<String> {
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
    ensure!(
        !files.is_empty(),
        "there is no page in {}",
        folder.display()
    );
    let pages: Vec<Page> = files
        .iter()
        .map(|file| page(file).with_context(|| format!("in the page {}", file.display())))
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
    Ok(document(&pages, with_page))
}

/// The pages below one another, with links to each at the head.
fn document(pages: &[Page], with_page: bool) -> String {
    let live = if with_page {
        format!(
            "<p class=\"live\"><a href=\"{}\">See it move</a>: the actuator in your browser.</p>\n",
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
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width\">\n\
         <title>Dielectric elastomer actuator</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n\
         {live}<nav>\n{entries}</nav>\n<main>\n{sections}</main>\n</body>\n</html>\n"
    )
}

/// Reads and renders a page.
fn page(file: &Path) -> Result<Page> {
    let text = fs::read_to_string(file)?;
    let name = file
        .file_stem()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned();
    let options = Options::ENABLE_MATH | Options::ENABLE_TABLES;
    let mut events: Vec<Event> = TextMergeStream::new(Parser::new_ext(&text, options)).collect();
    let mut page = Page {
        title: name.clone(),
        places: BTreeSet::new(),
        links: Vec::new(),
        html: String::new(),
        name,
    };
    name_headings(&mut events, &mut page);
    for event in &mut events {
        match event {
            Event::InlineMath(formula) => *event = mathml(formula, DisplayMode::Inline)?,
            Event::DisplayMath(formula) => *event = mathml(formula, DisplayMode::Block)?,
            Event::Text(text) if text.contains("$$") => bail!(
                "a formula is not closed, or a line of it begins like a list: {}",
                text.trim()
            ),
            Event::Html(html) if html.trim() == VARIABLES_HERE => {
                *event = Event::Html(variables().into());
            }
            Event::Start(Tag::Link { dest_url, .. }) if !is_address(dest_url) => {
                let place = place(&page.name, dest_url)?;
                *dest_url = format!("#{place}").into();
                page.links.push(place);
            }
            Event::Start(Tag::Image { dest_url, .. }) => {
                let path: PathBuf = file.with_file_name(&**dest_url);
                *dest_url = embedded(&path)?.into();
            }
            _ => {}
        }
    }
    html::push_html(&mut page.html, events.into_iter());
    Ok(page)
}

/// Gives each heading a name to link to, as `page` for the first and `page-heading` for the others.
fn name_headings(events: &mut [Event], page: &mut Page) {
    let mut at = 0;
    while at < events.len() {
        if let Event::Start(Tag::Heading { .. }) = &events[at] {
            let title: String = events[at..]
                .iter()
                .take_while(|event| !matches!(event, Event::End(TagEnd::Heading(_))))
                .filter_map(|event| match event {
                    Event::Text(text) | Event::Code(text) => Some(&**text),
                    _ => None,
                })
                .collect();
            if let Event::Start(Tag::Heading { level, id, .. }) = &mut events[at] {
                let place = if *level == HeadingLevel::H1 {
                    page.title.clone_from(&title);
                    page.name.clone()
                } else {
                    format!("{}-{}", page.name, slug(&title))
                };
                *id = Some(place.clone().into());
                page.places.insert(place);
            }
        }
        at += 1;
    }
}

/// The name that Markdown viewers give a heading: lower case, hyphens for blanks, no signs.
fn slug(title: &str) -> String {
    title
        .to_lowercase()
        .chars()
        .filter_map(|letter| match letter {
            ' ' => Some('-'),
            '-' | '_' => Some(letter),
            _ => letter.is_alphanumeric().then_some(letter),
        })
        .collect()
}

/// Whether a link leads out of the guide.
fn is_address(link: &str) -> bool {
    link.starts_with("https://")
}

/// The place in the guide that a link of a page leads to: `other.md`, `other.md#heading` or `#heading`.
fn place(page: &str, link: &str) -> Result<String> {
    let (file, heading) = link.split_once('#').unwrap_or((link, ""));
    let target = match file.strip_suffix(".md") {
        Some(name) if !name.contains('/') => name,
        None if file.is_empty() => page,
        _ => bail!("the link {link} leads neither to a page of the guide nor to an https address"),
    };
    Ok(if heading.is_empty() {
        target.to_owned()
    } else {
        format!("{target}-{heading}")
    })
}

/// A formula in LaTeX as MathML.
fn mathml(formula: &CowStr, display_mode: DisplayMode) -> Result<Event<'static>> {
    let storage = Storage::new();
    let mut parts = Vec::new();
    for part in Formula::new(formula, &storage) {
        parts.push(Ok::<_, std::convert::Infallible>(part.map_err(
            |error| anyhow::anyhow!("the formula {formula}: {error}"),
        )?));
    }
    let config = RenderConfig {
        display_mode,
        ..RenderConfig::default()
    };
    let mut text = String::new();
    push_mathml(&mut text, parts.into_iter(), config)?;
    // `pulldown_latex` writes the micro sign for \mu; browsers slant the Greek letter only.
    Ok(Event::InlineHtml(text.replace('\u{b5}', "\u{3bc}").into()))
}

/// A figure as an address that holds it.
fn embedded(path: &Path) -> Result<String> {
    let kind = match path.extension().and_then(|extension| extension.to_str()) {
        Some("png") => "png",
        Some("svg") => "svg+xml",
        _ => bail!("the figure {} is neither png nor svg", path.display()),
    };
    let bytes =
        fs::read(path).with_context(|| format!("cannot read the figure {}", path.display()))?;
    Ok(format!(
        "data:image/{kind};base64,{}",
        BASE64_STANDARD.encode(bytes)
    ))
}

/// The table of variables.
fn variables() -> String {
    let rows: String = VARIABLES.iter().map(row).collect();
    format!(
        "<table class=\"variables\">\n<thead><tr><th>Name</th><th>Kind</th><th>Start</th><th>Limits</th>\
         <th>Meaning</th></tr></thead>\n<tbody>\n{rows}</tbody>\n</table>\n"
    )
}

fn row(variable: &Variable<Nondimensional>) -> String {
    let kind = match (variable.causality, variable.variability) {
        (Causality::Parameter, Variability::Tunable) => "tunable parameter",
        (Causality::Parameter, _) => "parameter",
        (Causality::Input, _) => "input",
        (Causality::Output, _) => "output",
        (Causality::Local, _) => "local",
    };
    let limits = match variable.kind {
        Kind::Real { min, max, .. } if min == f64::MIN && max == f64::MAX => String::new(),
        Kind::Real { min, max, .. } if max == f64::MAX => format!("from {min}"),
        Kind::Real { min, max, .. } => format!("{} to {}", number(min), number(max)),
        _ => String::new(),
    };
    format!(
        "<tr><td><code>{}</code></td><td>{kind}</td><td>{}</td><td>{limits}</td><td>{}</td></tr>\n",
        variable.name,
        variable.start.map_or_else(String::new, number),
        escaped(variable.description)
    )
}

/// A number as people write it: powers of ten where it is long.
fn number(value: f64) -> String {
    let plain = value.to_string();
    if plain.len() <= 6 {
        plain
    } else {
        format!("{value:e}")
    }
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rendered(text: &str) -> Result<Page> {
        static COUNT: std::sync::atomic::AtomicUsize = std::sync::atomic::AtomicUsize::new(0);
        let number = COUNT.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
        let folder = std::env::temp_dir().join(format!("guide-{}-{number}", std::process::id()));
        fs::create_dir_all(&folder)?;
        let file = folder.join("page.md");
        fs::write(&file, text)?;
        let page = page(&file);
        fs::remove_dir_all(&folder)?;
        page
    }

    #[test]
    fn formulas_become_mathml() -> Result<()> {
        let page = rendered("# T\n\nThe stretch $\\lambda^2$:\n\n$$\\frac{a}{b}$$\n")?;
        assert!(page.html.contains("<msup>"), "{}", page.html);
        assert!(page.html.contains("<mfrac>") && page.html.contains("display=\"block\""));
        let refused = rendered("$\\nosuchcommand$")
            .err()
            .context("a bad formula passed")?;
        assert!(format!("{refused:#}").contains("nosuchcommand"));
        assert!(rendered("$$\na\n+ b\n$$\n").is_err());
        Ok(())
    }

    #[test]
    fn headings_can_be_linked_to() -> Result<()> {
        let page = rendered("# The page\n\n## Limits of `S`\n\n[a](#limits-of-s), [b](page.md)\n")?;
        assert_eq!(page.title, "The page");
        assert!(
            page.html.contains("<h2 id=\"page-limits-of-s\">"),
            "{}",
            page.html
        );
        assert_eq!(page.links, ["page-limits-of-s", "page"]);
        assert!(page.links.iter().all(|link| page.places.contains(link)));
        assert!(rendered("[out](../README.md)").is_err());
        Ok(())
    }

    #[test]
    fn every_variable_is_in_the_table() -> Result<()> {
        let page = rendered("# T\n\n<!-- variables -->\n")?;
        for variable in &VARIABLES {
            assert!(
                page.html
                    .contains(&format!("<code>{}</code>", variable.name))
            );
        }
        Ok(())
    }

    #[test]
    fn a_missing_figure_is_named() {
        let refused = rendered("![curve](figures/none.png)")
            .err()
            .expect("it is missing");
        assert!(format!("{refused:#}").contains("figures/none.png"));
    }

    #[test]
    fn the_guide_of_the_workspace_stands_alone() -> Result<()> {
        let guide = html(&Path::new(env!("CARGO_MANIFEST_DIR")).join(".."), true)?;
        assert!(guide.contains("<math") && guide.contains("src=\"data:image/"));
        assert!(
            !guide.contains("src=\"http") && !guide.contains("<link") && !guide.contains("<script")
        );
        Ok(())
    }
}
