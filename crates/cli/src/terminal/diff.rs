//! What changed in a text, as `diff -u` and `git` show it.

use std::fmt::Write;
use std::ops::Range;
use std::path::Path;

/// Lines around a change.
const AROUND: usize = 3;

/// Texts that differ in more lines are shown as replaced from the first change to the last.
const MOST_CHANGES: usize = 2000;

/// Lines that change with three around them; nothing if none do.
pub fn difference(path: &Path, old: &str, new: &str) -> String {
    let old: Vec<&str> = old.split_inclusive('\n').collect();
    let new: Vec<&str> = new.split_inclusive('\n').collect();
    let changes = changes(&old, &new);
    if changes.is_empty() {
        return String::new();
    }
    let path = path.display();
    let mut said = format!("--- {path}\n+++ {path}\n");
    // Changes whose surroundings touch share a hunk.
    for hunk in changes.chunk_by(|one, next| next.0.start - one.0.end <= 2 * AROUND) {
        say_hunk(&mut said, hunk, &old, &new);
    }
    said
}

/// Lines of the old text that are replaced by lines of the new one.
type Change = (Range<usize>, Range<usize>);

fn say_hunk(said: &mut String, hunk: &[Change], old: &[&str], new: &[&str]) {
    let (first, last) = (&hunk[0], &hunk[hunk.len() - 1]);
    let before = first.0.start.min(AROUND);
    let after = (old.len() - last.0.end).min(AROUND);
    let span = |start: usize, end: usize| match end - start {
        1 => format!("{}", start + 1),
        // Nothing stands behind the line before.
        0 => format!("{start},0"),
        count => format!("{},{count}", start + 1),
    };
    let of_old = span(first.0.start - before, last.0.end + after);
    let of_new = span(first.1.start - before, last.1.end + after);
    // Writing to a text does not fail.
    let _ = writeln!(said, "@@ -{of_old} +{of_new} @@");
    let mut say = |sign: char, lines: &[&str]| {
        for line in lines {
            let end = if line.ends_with('\n') { "" } else { "\n\\ No newline at end of file\n" };
            let _ = write!(said, "{sign}{line}{end}");
        }
    };
    let mut at = first.0.start - before;
    for (gone, come) in hunk {
        say(' ', &old[at..gone.start]);
        say('-', &old[gone.clone()]);
        say('+', &new[come.clone()]);
        at = gone.end;
    }
    say(' ', &old[at..last.0.end + after]);
}

/// What changes, in order; between two changes the texts agree.
fn changes(old: &[&str], new: &[&str]) -> Vec<Change> {
    let start = old.iter().zip(new).take_while(|(a, b)| a == b).count();
    let (a, b) = (&old[start..], &new[start..]);
    let end = a.iter().rev().zip(b.iter().rev()).take_while(|(a, b)| a == b).count();
    let (a, b) = (&a[..a.len() - end], &b[..b.len() - end]);
    let (mut changes, mut at) = (Vec::new(), (0, 0));
    let kept = kept(a, b).unwrap_or_default();
    for (x, y) in kept.into_iter().chain([(a.len(), b.len())]) {
        if at != (x, y) {
            changes.push((start + at.0..start + x, start + at.1..start + y));
        }
        at = (x + 1, y + 1);
    }
    changes
}

/// Pairs of lines that stay, with the fewest changes between them; `None` where there are too many.
///
/// E. W. Myers, An O(ND) Difference Algorithm and Its Variations, Algorithmica 1 (1986): `reach[k]` is how far into `a` one
/// gets with `changes` lines taken or put in, `k` more of those taken.
fn kept(a: &[&str], b: &[&str]) -> Option<Vec<(usize, usize)>> {
    let (n, m) = (a.len() as isize, b.len() as isize);
    let most = (a.len() + b.len()).min(MOST_CHANGES) as isize;
    let at = |k: isize| (k + most + 1) as usize;
    let mut reach = vec![0_isize; 2 * at(0) + 1];
    // What was reached with fewer changes, for the way back.
    let mut history: Vec<Vec<isize>> = Vec::new();
    for changes in 0..=most {
        history.push(reach[at(-changes)..=at(changes)].to_vec());
        for k in (-changes..=changes).step_by(2) {
            let put_in = puts_in(|k| reach[at(k)], k, changes);
            let mut x = if put_in { reach[at(k + 1)] } else { reach[at(k - 1)] + 1 };
            while x < n && x - k < m && a[x as usize] == b[(x - k) as usize] {
                x += 1;
            }
            reach[at(k)] = x;
            if x >= n && x - k >= m {
                return Some(way_back(&history, (n, m)));
            }
        }
    }
    None
}

/// Whether the change that leads to `k` puts a line in.
fn puts_in(reach: impl Fn(isize) -> isize, k: isize, changes: isize) -> bool {
    k == -changes || (k != changes && reach(k - 1) < reach(k + 1))
}

fn way_back(history: &[Vec<isize>], end: (isize, isize)) -> Vec<(usize, usize)> {
    let ((mut x, mut y), mut kept) = (end, Vec::new());
    for changes in (0..history.len() as isize).rev() {
        let reach = |k: isize| history[changes as usize][(k + changes) as usize];
        let k = x - y;
        let from = match changes {
            0 => (0, 0),
            _ if puts_in(reach, k, changes) => (reach(k + 1), reach(k + 1) - k - 1),
            _ => (reach(k - 1), reach(k - 1) - k + 1),
        };
        while x > from.0 && y > from.1 {
            (x, y) = (x - 1, y - 1);
            kept.push((x as usize, y as usize));
        }
        (x, y) = from;
    }
    kept.reverse();
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    fn said(old: &str, new: &str) -> String {
        difference(Path::new("a.ron"), old, new)
    }

    #[test]
    fn lines_that_change_stand_with_those_around_them() {
        let head = "--- a.ron\n+++ a.ron\n";
        let five = said("1\n2\n3\n4\n5\n", "1\n2\n3\n4\nfive\n");
        assert_eq!(five, format!("{head}@@ -2,4 +2,4 @@\n 2\n 3\n 4\n-5\n+five\n"));
        assert_eq!(said("1\n", "1\n"), "");
        assert_eq!(said("", "1\n"), format!("{head}@@ -0,0 +1 @@\n+1\n"));
        assert_eq!(
            said("1\n2", ""),
            format!("{head}@@ -1,2 +0,0 @@\n-1\n-2\n\\ No newline at end of file\n")
        );
    }

    #[test]
    fn changes_far_apart_have_hunks_of_their_own() {
        let old: String = (1..=20).map(|n| format!("{n}\n")).collect();
        let near = old.replace("\n5\n", "\nfive\n").replace("\n12\n", "\ntwelve\n");
        assert_eq!(said(&old, &near).matches("@@ -").count(), 1);
        let far = old.replace("\n5\n", "\nfive\n").replace("\n13\n", "\nthirteen\n");
        assert_eq!(said(&old, &far).matches("@@ -").count(), 2);
    }

    /// Takes lines of a hunk for those of the new text: what comes out is the new text again.
    fn patched(old: &str, difference: &str) -> String {
        let (old, mut new, mut at): (Vec<&str>, _, _) =
            (old.split_inclusive('\n').collect(), String::new(), 0);
        for line in difference.split_inclusive('\n').skip(2) {
            if let Some(place) = line.strip_prefix("@@ -") {
                let numbers = place.split(' ').next().unwrap_or_default();
                let (start, count) = numbers.split_once(',').unwrap_or((numbers, "1"));
                let start: usize = start.parse().unwrap();
                let start = if count == "0" { start } else { start - 1 };
                new.extend(old[at..start].iter().copied());
                at = start;
            } else if let Some(text) = line.strip_prefix('+') {
                new.push_str(text);
            } else {
                assert_eq!(old[at], &line[1..]);
                new.push_str(if line.starts_with(' ') { old[at] } else { "" });
                at += 1;
            }
        }
        new.extend(old[at..].iter().copied());
        new
    }

    #[test]
    fn a_difference_makes_the_new_text_of_the_old_one() {
        let mut state = 7_u64;
        let mut below = |n: u64| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) % n
        };
        for round in 0..500 {
            let mut text = |most: u64| -> String {
                let count = below(most);
                (0..count).map(|_| format!("{}\n", below(1 + round % 7))).collect()
            };
            let (old, new) = (text(40), text(40));
            assert_eq!(patched(&old, &said(&old, &new)), new, "{old:?}");
        }
    }

    #[test]
    fn no_difference_has_fewer_lines() {
        // The example of the paper: five changes make CBABAC of ABCABBA.
        let lines = |text: &str| text.chars().map(|c| format!("{c}\n")).collect::<String>();
        let said = said(&lines("ABCABBA"), &lines("CBABAC"));
        let changed = said.lines().skip(3).filter(|line| line.starts_with(['+', '-'])).count();
        assert_eq!(changed, 5, "{said}");
    }

    #[test]
    fn texts_that_have_nothing_in_common_are_replaced_as_a_whole() {
        let lines = |sign: char| (0..3000).map(|n| format!("{sign}{n}\n")).collect::<String>();
        let said = said(&format!("same\n{}", lines('a')), &format!("same\n{}", lines('b')));
        assert!(said.starts_with("--- a.ron\n+++ a.ron\n@@ -1,3001 +1,3001 @@\n same\n-a0\n"));
        assert_eq!(said.lines().count(), 3 + 1 + 6000);
    }
}
