//! Blocks of code in colours, by Pygments.

use std::io::Write;
use std::process::{Command, Stdio};

use anyhow::{Context, Result, ensure};

use crate::toolchain::tool;
use crate::zig::said;

const PROGRAM: &str = include_str!("colours.py");

/// A block of code.
#[derive(Clone, Debug, PartialEq)]
pub struct Block {
    /// Its language, as it stands in Markdown.
    pub language: String,
    /// The code.
    pub code: String,
}

/// Each block as HTML, its words in spans of the classes of Pygments.
///
/// # Errors
/// If the Python of the project cannot be started, or Pygments does not know a language.
pub fn coloured(blocks: &[Block]) -> Result<Vec<String>> {
    let python = tool("PROJECT_PYTHON")?;
    let mut child = Command::new(&python)
        .args(["-c", PROGRAM])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .with_context(|| format!("cannot start {}", python.display()))?;
    let pairs: Vec<[&str; 2]> = blocks
        .iter()
        .map(|block| [&*block.language, &*block.code])
        .collect();
    let question = serde_json::to_vec(&pairs)?;
    // It answers once it has read everything.
    child
        .stdin
        .take()
        .context("Python has no input")?
        .write_all(&question)?;
    let answer = child.wait_with_output().context("Python was lost")?;
    ensure!(
        answer.status.success(),
        "Pygments could not colour the code:\n{}",
        said(&answer)
    );
    let pieces: Vec<String> = serde_json::from_slice(&answer.stdout)?;
    ensure!(
        pieces.len() == blocks.len(),
        "Pygments answered {} blocks of {}",
        pieces.len(),
        blocks.len()
    );
    Ok(pieces)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn code_is_coloured_and_escaped() -> Result<()> {
        let block = |language: &str, code: &str| Block {
            language: language.to_owned(),
            code: code.to_owned(),
        };
        let pieces = coloured(&[
            block("python", "if 1 < 2:\n    pass\n"),
            block("text", "a & b\n"),
        ])?;
        assert!(pieces[0].contains("class=\"k\">if</span>") && pieces[0].contains("&lt;"));
        assert_eq!(pieces[1], "a &amp; b\n");
        assert!(coloured(&[block("no such language", "")]).is_err());
        Ok(())
    }
}
