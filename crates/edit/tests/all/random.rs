//! Whatever is done to a diagram, its texts stay diagrams with all of their comments, and can be taken back.

use std::path::Path;

use blocksim_block::problem::Severity;
use blocksim_diagram::{Content, Model, PortKind, Reader, Sources, model};
use blocksim_edit::{Change, NewBlock, Refusal, add, connect, delete, disconnect_end, rename, wrap};
use blocksim_syntax::{TokenKind, Tokens, format, read};

use crate::{Random, Texts, models};

/// Comments on lines of their own, sorted.
fn comments(text: &str) -> Vec<&str> {
    let mut all: Vec<&str> = text.lines().map(str::trim).filter(|line| line.starts_with("//")).collect();
    all.sort_unstable();
    all
}

/// All comments, sorted.
fn all_comments(text: &str) -> Vec<String> {
    let tokens = Tokens::new(text).filter(|token| token.kind == TokenKind::LineComment);
    let mut all: Vec<String> = tokens.map(|token| token.of(text).trim().to_owned()).collect();
    all.sort_unstable();
    all
}

/// Something that is done.
#[derive(Debug, Clone, PartialEq, Eq)]
enum Deed {
    Rename(String, String),
    Delete(Vec<String>),
    Connect(String, String),
    Disconnect(String),
    Add(&'static str, Vec<String>),
    Wrap(Vec<String>),
}

/// All diagrams of a model with their blocks.
fn levels(model: &Model) -> Vec<&Model> {
    let (mut all, mut next) = (vec![model], 0);
    while next < all.len() {
        for block in &all[next].blocks {
            if let Content::Diagram(inside) = &block.content {
                all.push(inside);
            }
        }
        next += 1;
    }
    all
}

fn deed(top: &Model, random: &mut Random) -> Option<Deed> {
    let levels = levels(top);
    let level = levels[random.below(levels.len())];
    if level.blocks.is_empty() {
        return None;
    }
    let mut block = || &level.blocks[random.below(level.blocks.len())];
    let (one, other) = (block(), block());
    let some = |random: &mut Random| -> Vec<String> {
        let most = 1 + random.below(4);
        let chosen = level.blocks.iter().filter(|_| random.below(3) == 0).map(|block| block.path.clone());
        chosen.take(most).collect()
    };
    let port = |block: &blocksim_diagram::ModelBlock, random: &mut Random| {
        let mut all = block.inputs();
        all.extend(block.outputs());
        all.extend(block.ports());
        (!all.is_empty()).then(|| format!("{}.{}", block.path, all[random.below(all.len())]))
    };
    Some(match random.below(7) {
        0 => Deed::Rename(one.path.clone(), ["x", "zz_top", "a1", "error"][random.below(4)].to_owned()),
        1 => Deed::Delete(some(random)),
        2 => Deed::Connect(port(one, random)?, port(other, random)?),
        3 => Deed::Disconnect(port(one, random)?),
        4 => {
            let kind = ["Gain", "Sum", "Scope", "Resistor", "Inertia", "Terminator"][random.below(6)];
            let driver = port(one, random)?;
            let relative = driver.rsplit('/').next().unwrap_or_default().to_owned();
            let fits = !matches!(one.port(relative.split('.').nth(1)?), Some(PortKind::Input));
            Deed::Add(kind, if fits { vec![relative] } else { Vec::new() })
        }
        _ => Deed::Wrap(some(random)),
    })
}

fn done(texts: &Texts, path: &Path, level: &str, deed: &Deed) -> Result<Change, Refusal> {
    texts.edit(path, true, |project| match deed {
        Deed::Rename(block, new) => rename(project, block, new),
        Deed::Delete(blocks) => delete(project, blocks),
        Deed::Connect(a, b) => connect(project, a, b),
        Deed::Disconnect(port) => disconnect_end(project, port),
        Deed::Add(kind, into) => add(project, &NewBlock { level, kind, into, ..NewBlock::default() }),
        Deed::Wrap(blocks) => wrap(project, blocks, ""),
    })
}

/// What a change may never do.
fn check(path: &Path, texts: &Texts, deed: &Deed, change: &Change) {
    let name = || format!("{}: {deed:?}", path.display());
    let mut kept: Vec<String> = Vec::new();
    let mut before: Vec<String> = Vec::new();
    for text in &change.texts {
        assert!(read(&text.new).is_ok(), "{}\n{}", name(), text.new);
        let old = text.old.as_deref().unwrap_or_default();
        assert_ne!(old, text.new, "{}: a text that does not change", name());
        if text.old.is_none() || format(old).as_deref() == Ok(old) {
            assert_eq!(format(&text.new).as_deref(), Ok(text.new.as_str()), "{}: laid out otherwise", name());
        }
        let lines = |text: &str| comments(text).into_iter().map(str::to_owned).collect::<Vec<_>>();
        kept.extend(if matches!(deed, Deed::Delete(_) | Deed::Disconnect(_)) {
            lines(&text.new)
        } else {
            all_comments(&text.new)
        });
        before.extend(if matches!(deed, Deed::Delete(_) | Deed::Disconnect(_)) {
            lines(old)
        } else {
            all_comments(old)
        });
    }
    // A block that moves takes the comments on its line along; where comments show how to set something they follow a new name.
    if !matches!(deed, Deed::Rename(..) | Deed::Wrap(_))
        || change.texts.iter().all(|text| !text.new.contains("--set"))
    {
        kept.sort();
        before.sort();
        assert_eq!(kept, before, "{}", name());
    }
    let new = texts.with(change);
    let sources = Sources::new(&new);
    let (_, problems) = model(&sources, path, &[]);
    let syntax = problems.iter().find(|problem| {
        problem.severity == Severity::Error
            && ["syntax", "duplicate_name", "bad_name", "missing_file"].contains(&problem.code)
    });
    assert!(syntax.is_none(), "{}: {syntax:?}", name());
    // What was there before is there to be taken back to.
    for text in &change.texts {
        assert_eq!(texts.read(&text.path).ok(), text.old, "{}", name());
    }
}

#[test]
fn random_changes_of_shipped_diagrams_leave_diagrams_with_their_comments() {
    let mut random = Random(7);
    let (mut made, mut refused) = ([0; 6], 0);
    let files = models("diagrams").into_iter().chain(models("docs/blocks"));
    for path in files {
        let mut texts = Texts::default();
        for _ in 0..4 {
            let sources = Sources::new(&texts);
            let (top, _) = model(&sources, &path, &[]);
            let top = top.expect("a model");
            let Some(deed) = deed(&top, &mut random) else { continue };
            match done(&texts, &path, "", &deed) {
                Ok(change) => {
                    check(&path, &texts, &deed, &change);
                    made[match deed {
                        Deed::Rename(..) => 0,
                        Deed::Delete(..) => 1,
                        Deed::Connect(..) => 2,
                        Deed::Disconnect(..) => 3,
                        Deed::Add(..) => 4,
                        Deed::Wrap(..) => 5,
                    }] += 1;
                    texts = texts.with(&change);
                }
                Err(refusal) => {
                    assert!(!refusal.message.is_empty(), "{deed:?}");
                    refused += 1;
                }
            }
        }
    }
    assert!(made.iter().all(|count| *count > 10), "{made:?}, {refused} refused");
}

#[test]
fn whatever_is_typed_is_answered() {
    let texts = Texts::default();
    let path = crate::root().join("diagrams/servo.ron");
    let words = [
        "",
        ".",
        "/",
        "pid",
        "pid.",
        ".e",
        "pid.e.x",
        "a/b/c",
        "pid/e",
        "in.",
        "out.x",
        "π.y",
        "\"",
        "pid.e -> x",
        "\0",
        "..",
        "//",
        " pid.e ",
    ];
    for a in words {
        for b in words {
            for what in 0..5 {
                let answer = texts.edit(&path, false, |project| match what {
                    0 => rename(project, a, b),
                    1 => delete(project, &[a.to_owned(), b.to_owned()]),
                    2 => connect(project, a, b),
                    3 => wrap(project, &[a.to_owned()], b),
                    _ => add(project, &NewBlock { level: a, kind: "Gain", name: b, ..NewBlock::default() }),
                });
                if let Err(refusal) = answer {
                    assert!(!refusal.message.is_empty(), "{a:?} {b:?}");
                }
            }
        }
    }
    for typed in [
        "",
        "(",
        "\"",
        "\\",
        "1,5",
        "1 +",
        "[1, 2",
        "f(",
        "NaN",
        "inf",
        "1e999",
        "π",
        "k: 2",
        "2), \"x\": Gain(k: 3",
    ] {
        let parameters = [("k".to_owned(), typed.to_owned())];
        let new = NewBlock { kind: "Gain", parameters: &parameters, ..NewBlock::default() };
        if let Ok(change) = texts.edit(&path, false, |project| add(project, &new)) {
            assert!(read(&change.texts[0].new).is_ok(), "{typed}");
        }
    }
}
