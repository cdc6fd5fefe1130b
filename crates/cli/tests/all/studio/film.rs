//! Films of the 3D view.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use super::{Studio, planner, with_scara};

/// Identities of EBML (RFC 8794) and of Matroska (RFC 9559).
const HEADER: u64 = 0x1A45_DFA3;
const SEGMENT: u64 = 0x1853_8067;
const CLUSTER: u64 = 0x1F43_B675;
const SIMPLE_BLOCK: u64 = 0xA3;
const BLOCK_GROUP: u64 = 0xA0;

/// A number of variable length and its bytes; with its mark if `is_identity`.
fn number(bytes: &[u8], is_identity: bool) -> Option<(u64, usize)> {
    let first = *bytes.first()?;
    let length = first.leading_zeros() as usize + 1;
    if length > 8 || bytes.len() < length {
        return None;
    }
    let start = if is_identity { u64::from(first) } else { u64::from(first) & ((1_u64 << (8 - length)) - 1) };
    Some((bytes[1..length].iter().fold(start, |all, byte| all << 8 | u64::from(*byte)), length))
}

/// Pictures of a film: blocks in its clusters.
fn pictures(mut bytes: &[u8]) -> usize {
    let mut count = 0;
    while let Some((identity, length)) = number(bytes, true) {
        let rest = &bytes[length..];
        let Some((size, length)) = number(rest, false) else { break };
        let rest = &rest[length..];
        // What contains others is gone into; a size of ones is one that was not known yet.
        if identity == SEGMENT || identity == CLUSTER {
            bytes = rest;
            continue;
        }
        count += usize::from(identity == SIMPLE_BLOCK || identity == BLOCK_GROUP);
        bytes = rest.get(size as usize..).unwrap_or_default();
    }
    count
}

#[test]
fn the_3d_view_is_recorded_as_a_film() {
    let desk = with_scara();
    let studio = Studio::of(&desk, &["scara.ron"]);
    let Some(mut page) = planner(&studio) else { return };
    page.value("document.querySelector('input[aria-label=\"A1 target\"]').focus()");
    page.replace("60");
    page.until("R.Motion.found()?.duration > 0.3");
    page.value("[...document.querySelectorAll('.space-bar button')].find((one) => one.textContent === 'Film').click()");
    let told = "document.querySelector('.film .note').textContent";
    let field = |name: &str| format!("document.querySelector('input[aria-label=\"{name}\"]').focus()");
    let record = "document.querySelector('.film button').click()";
    // What cannot be meant is explained, and stays.
    for (to, reason) in [
        ("soon", "soon is not a time in s"),
        ("99", "99 s is not between 0 s and"),
        ("0", "before it begins"),
    ] {
        page.value(&field("Film to, s"));
        page.replace(to);
        page.value(record);
        assert!(page.value(told).as_str().is_some_and(|told| told.contains(reason)), "{}", page.value(told));
        assert_eq!(page.value("document.activeElement.value"), to);
    }
    page.replace("0,3");
    // Slowly, as there is no graphics card that draws and codes pictures.
    page.value(
        "(() => { document.querySelector('select[aria-label=\"Speed of the film\"]').value = '0.25'; })()",
    );
    page.value(record);
    page.until(&format!("{told}.startsWith('Saved as ')"));
    assert!(
        page.value(told).as_str().is_some_and(|told| told.contains("_0s_to_0.3s.webm (")),
        "{}",
        page.value(told)
    );
    let film = page.value(
        "new Promise((done) => { const reader = new FileReader(); reader.onload = () => done(reader.result.split(',')[1]); reader.readAsDataURL(window.__m.film); })",
    );
    let film = STANDARD.decode(film.as_str().expect("text")).expect("base64");
    assert_eq!(number(&film, true).map(|(identity, _)| identity), Some(HEADER));
    let frames = page.value("window.__m.film_frames").as_u64().expect("a count") as usize;
    let found = pictures(&film);
    assert!(found >= 2 && frames >= 2, "{found} pictures of {frames}");
    // A browser that cannot.
    page.value("delete window.MediaRecorder");
    page.value(record);
    assert!(
        page.value(told).as_str().is_some_and(|told| told.contains("cannot record films")),
        "{}",
        page.value(told)
    );
}
