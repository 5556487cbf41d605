//! Opening a place in the editor that `$VISUAL` or `$EDITOR` names.

use std::ffi::OsString;
use std::path::Path;
use std::process::{Command, Stdio};

use crate::files::LIBRARY;

/// Editors that need a terminal around them.
const IN_TERMINAL: &[&str] = &["vi", "vim", "nvim", "nano", "hx", "helix", "kak", "micro", "joe", "ne"];

/// Starts the editor at a line and column, both from 1. Waits for nothing.
///
/// # Errors
/// If no editor is named, or it cannot be started; the text says so.
pub fn open(path: &Path, line: u32, column: u32) -> Result<(), String> {
    if path.starts_with(LIBRARY) {
        let why = "is part of the program: copy it into your project's folder to change it";
        return Err(format!("`{}` {why}", path.display()));
    }
    let named = ["VISUAL", "EDITOR"].iter().filter_map(std::env::var_os).find(|text| !text.is_empty());
    let named = named.ok_or("no editor is named: set VISUAL, for instance `export VISUAL='code -g'`")?;
    let terminal = std::env::var_os("TERMINAL").filter(|text| !text.is_empty());
    let words = command(&named.to_string_lossy(), terminal, path, line, column);
    let (program, args) = words.split_first().ok_or("VISUAL is blank")?;
    Command::new(program)
        .args(args)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .map(|_| ())
        .map_err(|error| format!("`{}` cannot be started: {error}", program.to_string_lossy()))
}

/// The words of the command line.
fn command(editor: &str, terminal: Option<OsString>, path: &Path, line: u32, column: u32) -> Vec<OsString> {
    let mut words: Vec<OsString> = editor.split_whitespace().map(OsString::from).collect();
    let name = words.first().map(|w| Path::new(w).file_stem().unwrap_or_default().to_string_lossy().into_owned());
    let name = name.unwrap_or_default();
    let mut place = path.as_os_str().to_owned();
    place.push(format!(":{line}:{column}"));
    match name.as_str() {
        "code" | "codium" | "code-insiders" | "cursor" => {
            if !words.iter().any(|word| word == "-g" || word == "--goto") {
                words.push("-g".into());
            }
            words.push(place);
        }
        "subl" | "zed" | "hx" | "helix" | "lapce" | "micro" => words.push(place),
        "kate" => words.extend(["-l".into(), line.to_string().into(), path.into()]),
        "emacs" | "emacsclient" | "kak" => words.extend([format!("+{line}:{column}").into(), path.into()]),
        "vi" | "vim" | "nvim" | "gvim" | "nano" | "gedit" | "joe" | "ne" => {
            words.extend([format!("+{line}").into(), path.into()]);
        }
        _ => words.push(path.into()),
    }
    if IN_TERMINAL.contains(&name.as_str()) {
        let terminal = terminal.unwrap_or_else(|| "x-terminal-emulator".into());
        words.splice(0..0, [terminal, "-e".into()]);
    }
    words
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(editor: &str) -> String {
        let words = command(editor, None, Path::new("a b.wgsl"), 7, 3);
        words.iter().map(|w| w.to_string_lossy()).collect::<Vec<_>>().join("|")
    }

    #[test]
    fn each_editor_gets_the_place_in_its_own_way() {
        assert_eq!(line("code"), "code|-g|a b.wgsl:7:3");
        assert_eq!(line("code -n -g"), "code|-n|-g|a b.wgsl:7:3");
        assert_eq!(line("emacsclient -n"), "emacsclient|-n|+7:3|a b.wgsl");
        assert_eq!(line("/usr/bin/nvim"), "x-terminal-emulator|-e|/usr/bin/nvim|+7|a b.wgsl");
        assert_eq!(line("something --new"), "something|--new|a b.wgsl");
        assert_eq!(line("subl"), "subl|a b.wgsl:7:3");
    }

    #[test]
    fn what_the_program_carries_is_not_edited() {
        let inside = Path::new(LIBRARY).join("shaders/a.wgsl");
        assert!(open(&inside, 1, 1).is_err_and(|why| why.contains("copy it")));
    }
}
