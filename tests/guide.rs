//! `docs/guide.md` is followed as a newcomer would: its files are written, its edits made, its commands run.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// What the page asks for, in its order.
#[derive(Debug)]
enum Deed {
    /// A whole file.
    Write(String, String),
    /// In the file named last, this text for that.
    Replace { file: String, old: String, new: String },
}

/// A fenced block with the text between it and the block before.
struct Block<'a> {
    before: &'a str,
    language: &'a str,
    text: &'a str,
}

fn page() -> String {
    fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/guide.md")).unwrap()
}

fn blocks(page: &str) -> Vec<Block<'_>> {
    let pieces: Vec<&str> = page.split("```").collect();
    let block = |pair: &[&'_ str]| pair[1].find('\n').map(|end| (pair[1][..end].trim().len(), end));
    pieces
        .chunks_exact(2)
        .filter_map(|pair| {
            let (language, end) = block(pair)?;
            Some(Block { before: pair[0], language: &pair[1][..language], text: &pair[1][end + 1..] })
        })
        .collect()
}

fn deeds(page: &str) -> Vec<Deed> {
    let mut deeds = Vec::new();
    let mut file = String::new();
    let all = blocks(page);
    let mut at = 0;
    while at < all.len() {
        let block = &all[at];
        at += 1;
        if !matches!(block.language, "ron" | "wgsl") {
            continue;
        }
        // A file is named in bold code.
        if let Some(named) = block.before.rsplit("**`").next().and_then(|rest| rest.split_once("`**")) {
            named.0.clone_into(&mut file);
        }
        let next = all.get(at).filter(|next| next.before.trim() == "becomes");
        deeds.push(match next {
            Some(next) => {
                at += 1;
                Deed::Replace { file: file.clone(), old: block.text.to_owned(), new: next.text.to_owned() }
            }
            None => Deed::Write(file.clone(), block.text.to_owned()),
        });
    }
    deeds
}

struct Newcomer {
    folder: PathBuf,
}

impl Newcomer {
    fn new(name: &str) -> Self {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
        _ = fs::remove_dir_all(&folder);
        fs::create_dir_all(&folder).unwrap();
        let newcomer = Self { folder };
        let made = newcomer.run(&["new", "pond"]);
        assert!(made.status.success(), "{made:?}");
        newcomer
    }

    fn run(&self, args: &[&str]) -> Output {
        Command::new(env!("CARGO_BIN_EXE_meniscus")).args(args).current_dir(&self.folder).output().unwrap()
    }

    fn edit(&self, file: &str, old: &str, new: &str) {
        let path = self.folder.join(file);
        let text = fs::read_to_string(&path).unwrap();
        assert_eq!(text.matches(old).count(), 1, "{file} has not once\n{old}");
        fs::write(path, text.replace(old, new)).unwrap();
    }

    fn follow(&self, deeds: &[Deed]) {
        let repository = Path::new(env!("CARGO_MANIFEST_DIR"));
        fs::copy(repository.join("scenes/assets/dd40k_22.bgeo"), self.folder.join("scenes/assets/water.bgeo")).unwrap();
        for deed in deeds {
            match deed {
                Deed::Write(file, text) => {
                    let path = self.folder.join(file);
                    assert!(path.parent().unwrap().is_dir(), "{file}: no such folder");
                    fs::write(path, text).unwrap();
                }
                Deed::Replace { file, old, new } => self.edit(file, old, new),
            }
        }
    }
}

#[test]
fn every_file_and_edit_checks() {
    let page = page();
    let deeds = deeds(&page);
    let writes = deeds.iter().filter(|d| matches!(d, Deed::Write(..))).count();
    assert_eq!((writes, deeds.len() - writes), (5, 3), "{deeds:?}");
    let newcomer = Newcomer::new("guide");
    // Two passes, then three.
    for some in [&deeds[..4], &deeds[4..]] {
        newcomer.follow(some);
        let checked = newcomer.run(&["check", "--deny-warnings", "graphs/pond.ron", "scenes/pond.ron"]);
        assert!(checked.status.success(), "{}", String::from_utf8_lossy(&checked.stderr));
    }
    let planned = newcomer.run(&["plan", "graphs/pond.ron"]);
    let plan = String::from_utf8(planned.stdout).unwrap();
    for pass in ["balls", "smooth[0..7]", "shade"] {
        assert!(plan.contains(pass), "{pass} is not in\n{plan}");
    }
}

#[test]
fn the_mistake_says_what_the_page_says() {
    let page = page();
    let newcomer = Newcomer::new("guide_mistake");
    newcomer.edit("shaders/pond/discs.wgsl", "    disc_m: f32", "    disk_m: f32");
    newcomer.edit("shaders/pond/discs.wgsl", "settings.disc_m", "settings.disk_m");
    let checked = newcomer.run(&["check", "graphs/pond.ron"]);
    let said = String::from_utf8(checked.stderr).unwrap() + &String::from_utf8(checked.stdout).unwrap();
    let shown = blocks(&page).into_iter().find(|b| b.language == "text").unwrap();
    assert!(said.contains(shown.text), "the page shows\n{}\nand `check` says\n{said}", shown.text);
}
