//! A page of Markdown as HTML: formulas as MathML, figures inside, headings with places that links lead to.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use base64::prelude::{BASE64_STANDARD, Engine};
use pulldown_cmark::{
    CodeBlockKind, CowStr, Event, HeadingLevel, Options, Parser, Tag, TagEnd, TextMergeStream, html,
};
use pulldown_latex::config::{DisplayMode, RenderConfig};
use pulldown_latex::{Parser as Formula, Storage, push_mathml};

use super::code::Block;
use crate::{FMUS, Fmu};

/// What the table of variables of an FMU takes the place of.
pub fn variables_here(fmu: &Fmu) -> String {
    format!("<!-- variables of {} -->", fmu.identifier)
}

/// What the place of a block of code looks like until all of them are coloured at once.
pub fn code_here(number: usize) -> String {
    format!("<!-- code {number} -->")
}

/// A page, rendered.
pub struct Page {
    /// Name of the file without extension, and of its place in the guide.
    pub name: String,
    pub title: String,
    pub html: String,
    /// The places that a link may lead to.
    pub places: BTreeSet<String>,
    /// The FMUs whose variables it shows.
    pub fmus: Vec<&'static str>,
    /// Where its links inside the guide lead.
    pub links: Vec<String>,
    /// Its blocks of code, whose places are marked by [`code_here`].
    pub code: Vec<Block>,
}

/// Reads and renders a page.
pub fn page(file: &Path) -> Result<Page> {
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
        fmus: Vec::new(),
        links: Vec::new(),
        code: Vec::new(),
        html: String::new(),
        name,
    };
    name_headings(&mut events, &mut page);
    take_code(&mut events, &mut page);
    for event in &mut events {
        match event {
            Event::InlineMath(formula) => *event = mathml(formula, DisplayMode::Inline)?,
            Event::DisplayMath(formula) => *event = mathml(formula, DisplayMode::Block)?,
            Event::Text(text) if text.contains("$$") => bail!(
                "a formula is not closed, or a line of it begins like a list: {}",
                text.trim()
            ),
            Event::Html(html) if html.starts_with("<!-- variables") => {
                let fmu = FMUS
                    .iter()
                    .find(|fmu| html.trim() == variables_here(fmu))
                    .with_context(|| format!("there is no FMU for {}", html.trim()))?;
                page.fmus.push(fmu.identifier);
                *event = Event::Html((fmu.variables)().into());
            }
            Event::Text(text) if unbroken(text).is_some() => {
                *event = Event::InlineHtml(unbroken(text).unwrap_or_default().into());
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
    // A table that is wider than the screen scrolls by itself.
    page.html = page
        .html
        .replace("<table>", "<div class=\"wide\" tabindex=\"0\"><table>")
        .replace("</table>\n", "</table></div>\n")
        .replace("</table></div></div>", "</table></div>");
    Ok(page)
}

pub fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
}

/// Takes the blocks of code out and marks their places.
fn take_code(events: &mut Vec<Event>, page: &mut Page) {
    let mut language = None;
    for event in events.iter_mut() {
        match event {
            Event::Start(Tag::CodeBlock(kind)) => {
                language = Some(match kind {
                    CodeBlockKind::Fenced(name) if !name.is_empty() => name.to_string(),
                    _ => "text".to_owned(),
                });
                *event = Event::Html(CowStr::Borrowed(""));
            }
            Event::End(TagEnd::CodeBlock) => {
                language = None;
                *event = Event::Html(CowStr::Borrowed(""));
            }
            Event::Text(text) => {
                if let Some(language) = &language {
                    let block = Block {
                        language: language.clone(),
                        code: text.to_string(),
                    };
                    let place = code_here(page.code.len());
                    page.code.push(block);
                    *event = Event::Html(place.into());
                }
            }
            _ => {}
        }
    }
}

/// A text as HTML in which no line ends inside a number such as 2.9e-15; nothing if it has none.
fn unbroken(text: &str) -> Option<String> {
    let breaks = |word: &str| word.contains('-') && word.contains(|one: char| one.is_ascii_digit());
    if !text.split(' ').any(breaks) {
        return None;
    }
    let words: Vec<String> = text
        .split(' ')
        .map(|word| {
            let html = escaped(word);
            if breaks(word) {
                format!("<span class=\"number\">{html}</span>")
            } else {
                html
            }
        })
        .collect();
    Some(words.join(" "))
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
pub fn embedded(path: &Path) -> Result<String> {
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

#[cfg(test)]
pub mod tests {
    use super::*;

    /// A page with this text, rendered.
    pub fn rendered(text: &str) -> Result<Page> {
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
    fn numbers_stay_whole_and_tables_scroll() -> Result<()> {
        let page = rendered(
            "# T\n\n| a < b |\n|---|\n| at 2.9e-15, or `1e-3` & more |\n\n<!-- variables of DielectricElastomerActuator -->\n",
        )?;
        assert!(
            page.html.contains(
                "at <span class=\"number\">2.9e-15,</span> or <code>1e-3</code> &amp; more"
            ),
            "{}",
            page.html
        );
        assert!(page.html.contains("a &lt; b"));
        assert_eq!(page.html.matches("<div class=\"wide\"").count(), 2);
        assert_eq!(page.html.matches("</div>").count(), 2);
        Ok(())
    }

    #[test]
    fn a_missing_figure_is_named() {
        let refused = rendered("![curve](figures/none.png)")
            .err()
            .expect("it is missing");
        assert!(format!("{refused:#}").contains("figures/none.png"));
    }
}
