//! `plugin.toml`: how the C or C++ sources of a folder are built, where the defaults do not do.

use std::path::Path;

use super::text::text;

/// The file beside the sources.
pub const SETTINGS: &str = "plugin.toml";

/// What it says.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Settings {
    /// Name of the library; that of the folder without it.
    pub name: Option<String>,
    /// Files to compile, relative to the folder; without them all `.c`, `.cc`, `.cpp` and `.cxx` files in it.
    pub sources: Option<Vec<String>>,
    /// Folders with headers, relative to the folder.
    pub include: Vec<String>,
    /// More arguments for the compiler.
    pub flags: Vec<String>,
    /// Libraries to link, as `m`.
    pub libraries: Vec<String>,
}

/// Reads the settings of a folder; where there is no file they are the defaults.
///
/// # Errors
/// What is wrong, with file and line.
pub fn read(folder: &Path) -> Result<Settings, String> {
    match text(&folder.join(SETTINGS)) {
        Ok(text) => parse(&text),
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => Ok(Settings::default()),
        Err(e) => Err(format!("{SETTINGS} cannot be read: {e}")),
    }
}

/// The part of TOML that is needed: `key = "text"` and `key = ["text", "text"]`, a list also on several lines.
fn parse(text: &str) -> Result<Settings, String> {
    let mut settings = Settings::default();
    let mut seen: Vec<String> = Vec::new();
    let mut lines = text.lines().enumerate();
    while let Some((at, line)) = lines.next() {
        let wrong = |reason: String| format!("{SETTINGS}:{}: {reason}", at + 1);
        let line = without_comment(line).trim();
        if line.is_empty() {
            continue;
        }
        let (key, value) = line
            .split_once('=')
            .map(|(key, value)| (key.trim(), value.trim().to_owned()))
            .ok_or_else(|| wrong(format!("`{line}` is not of the form `key = \"text\"`")))?;
        let mut value = value;
        while value.starts_with('[') && !value.ends_with(']') {
            let (_, more) = lines.next().ok_or_else(|| wrong(format!("the list `{key}` has no `]`")))?;
            value.push_str(without_comment(more).trim());
        }
        // TOML allows a comma behind the last element.
        let value = match value.strip_suffix(']').map(str::trim_end).and_then(|list| list.strip_suffix(',')) {
            Some(list) => format!("{list}]"),
            None => value,
        };
        if seen.iter().any(|known| known == key) {
            return Err(wrong(format!("`{key}` is given twice")));
        }
        seen.push(key.to_owned());
        let one = || {
            serde_json::from_str::<String>(&value)
                .map_err(|_| wrong(format!("`{key}` must be a text in quotes, not {value}")))
        };
        let list = || {
            serde_json::from_str::<Vec<String>>(&value).map_err(|_| {
                wrong(format!("`{key}` must be a list of texts such as [\"a\", \"b\"], not {value}"))
            })
        };
        match key {
            "name" => settings.name = Some(one()?),
            "sources" => settings.sources = Some(list()?),
            "include" => settings.include = list()?,
            "flags" => settings.flags = list()?,
            "libraries" => settings.libraries = list()?,
            _ => {
                let all = "`name`, `sources`, `include`, `flags`, `libraries`";
                return Err(wrong(format!("`{key}` is not a setting; the settings are {all}")));
            }
        }
    }
    Ok(settings)
}

/// A line up to a `#` that does not stand in quotes.
fn without_comment(line: &str) -> &str {
    let mut is_quoted = false;
    let mut is_escaped = false;
    for (at, c) in line.char_indices() {
        match c {
            '#' if !is_quoted => return &line[..at],
            '"' if !is_escaped => is_quoted = !is_quoted,
            _ => {}
        }
        is_escaped = c == '\\' && !is_escaped;
    }
    line
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_that_is_too_long_or_none_is_refused() {
        let folder = std::env::temp_dir().join(format!("blocksim-settings-{}", std::process::id()));
        let _ = std::fs::remove_dir_all(&folder);
        std::fs::create_dir_all(&folder).unwrap();
        assert_eq!(read(&folder), Ok(Settings::default()));
        std::fs::write(folder.join(SETTINGS), "# x\n".repeat(1 << 18)).unwrap();
        assert_eq!(read(&folder), Ok(Settings::default()));
        std::fs::write(folder.join(SETTINGS), "# xx\n".repeat(1 << 18)).unwrap();
        assert!(read(&folder).unwrap_err().contains("more than 1 MiB"));
        std::fs::remove_file(folder.join(SETTINGS)).unwrap();
        std::fs::create_dir(folder.join(SETTINGS)).unwrap();
        assert!(read(&folder).unwrap_err().contains("not a regular file"));
        std::fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn settings_are_read() {
        let text = "# how it is built\nname = \"law\" # short\nsources = [\n  \"a.c\", # first\n  \"sub/b#.cpp\",\n]\n\
                    flags = []\nlibraries = [\"m\"]\n";
        let settings = parse(text).unwrap();
        let expected = Settings {
            name: Some("law".into()),
            sources: Some(vec!["a.c".into(), "sub/b#.cpp".into()]),
            libraries: vec!["m".into()],
            ..Settings::default()
        };
        assert_eq!(settings, expected);
        assert_eq!(parse("").unwrap(), Settings::default());
    }

    #[test]
    fn what_is_wrong_is_told_with_its_line() {
        for (text, expected) in [
            ("\nnmae = \"law\"", "plugin.toml:2: `nmae` is not a setting; the settings are "),
            ("name", "plugin.toml:1: `name` is not of the form `key = \"text\"`"),
            ("name = law", "plugin.toml:1: `name` must be a text in quotes, not law"),
            (
                "flags = \"-O3\"",
                "plugin.toml:1: `flags` must be a list of texts such as [\"a\", \"b\"], not \"-O3\"",
            ),
            ("flags = [\n\"-O3\"", "plugin.toml:1: the list `flags` has no `]`"),
            ("name = \"a\"\nname = \"b\"", "plugin.toml:2: `name` is given twice"),
        ] {
            let error = parse(text).unwrap_err();
            assert!(error.starts_with(expected), "{error}");
        }
    }
}
