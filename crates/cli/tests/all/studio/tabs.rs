//! Many tabs of one browser, which open six connections to a server at most.

use std::fs;

use super::{Page, SERVO, Studio};
use crate::desk::Desk;

/// A tab that hears nothing of the others while `deaf` is true, as one that sleeps.
const DEAF: &str = "window.deaf = false; const Real = BroadcastChannel; window.BroadcastChannel = class extends Real {
    addEventListener(kind, does) { super.addEventListener(kind, (event) => { if (!window.deaf) does(event); }); }
};";
/// Times of all rows that the program has kept, and of those that the page shows.
const KEPT: &str = "R.Desk.ask('live').then(({ rows }) => JSON.stringify(rows.flatMap((row) => \
    [...new Float64Array(Uint8Array.from(atob(row.t), (sign) => sign.charCodeAt(0)).buffer)])))";
const SHOWN: &str = "JSON.stringify([...R.data.panels[0].time])";

/// Opens the project in this tab.
fn open(page: &mut Page, studio: &Studio) {
    page.before(DEAF);
    page.open(&studio.address);
    page.until("document.documentElement.dataset.ready === 'true'");
}

/// Which tabs listen to the program.
fn leaders(page: &mut Page) -> Vec<usize> {
    let count = page.tabs();
    let leads = |tab: &usize| {
        page.turn_to(*tab);
        page.value("R.Stream.leads()") == true
    };
    (0..count).filter(leads).collect()
}

#[test]
fn eight_tabs_hear_the_news_by_one_connection_and_another_listens_when_its_tab_is_closed() {
    let text = SERVO.replace("\"2 s\"", "\"60 s\", solver: Ode4(step: \"10 ms\")");
    let desk = Desk::with(&[("servo.ron", &text)]);
    let studio = Studio::of(&desk, &[]);
    let Some(mut page) = Page::new() else { return };
    open(&mut page, &studio);
    for _ in 1..8 {
        page.tab();
        open(&mut page, &studio);
    }
    assert_eq!(leaders(&mut page), [0]);
    fs::write(desk.0.join("servo.ron"), text.replace("title: \"Servo\"", "title: \"Drive\""))
        .expect("a file");
    for tab in 0..8 {
        page.turn_to(tab);
        page.until("document.title === 'Drive – blocksim'");
    }
    // While a run goes on the one that listens is closed: the others miss nothing.
    page.value("R.Desk.ask('run', { speed: 1 }).then(() => null)");
    page.until("R.Live.rows() > 5");
    page.close(0);
    page.until("R.Live.rows() > 40");
    page.value("R.Desk.ask('control', { do: 'stop' }).then(() => null)");
    page.until("document.querySelector('.run-line').textContent.includes('ended at')");
    let kept = page.value(KEPT);
    for tab in 0..7 {
        page.turn_to(tab);
        page.until("document.querySelector('.run-line').textContent.includes('ended at')");
        page.until(&format!("{SHOWN} === {kept}"));
        assert_eq!(page.value("document.getElementById('lost').hidden"), true);
    }
    // One that does not answer is relieved of it.
    let [asleep] = leaders(&mut page)[..] else { panic!("one listens") };
    page.turn_to(asleep);
    page.value("window.deaf = true");
    page.turn_to(usize::from(asleep == 0));
    page.until("R.Stream.leads()");
    page.turn_to(asleep);
    page.until("!R.Stream.leads()");
    page.value("window.deaf = false");
    fs::write(desk.0.join("servo.ron"), &text).expect("a file");
    for tab in 0..7 {
        page.turn_to(tab);
        page.until("document.title === 'Servo – blocksim'");
    }
    assert_eq!(leaders(&mut page).len(), 1);
    assert_eq!(page.complaints, Vec::<String>::new());
}

#[test]
fn a_tab_that_missed_news_asks_for_what_there_is() {
    let text = SERVO.replace("\"2 s\"", "\"60 s\", solver: Ode4(step: \"10 ms\")");
    let desk = Desk::with(&[("servo.ron", &text)]);
    let studio = Studio::of(&desk, &[]);
    let Some(mut page) = Page::new() else { return };
    open(&mut page, &studio);
    page.tab();
    open(&mut page, &studio);
    page.value("R.Desk.ask('run', { speed: 1 }).then(() => null)");
    page.until("R.Live.rows() > 5");
    page.value("R.Futures.note(0.01, 'marked'); window.deaf = true");
    let had = page.value("R.Live.rows()");
    page.turn_to(0);
    page.until(&format!("R.Live.rows() > {had} + 10"));
    page.turn_to(1);
    page.value("window.deaf = false");
    page.until(&format!("R.Live.rows() > {had} + 12"));
    page.value("R.Desk.ask('control', { do: 'stop' }).then(() => null)");
    page.until("document.querySelector('.run-line').textContent.includes('ended at')");
    let kept = page.value(KEPT);
    page.until(&format!("{SHOWN} === {kept}"));
    assert_eq!(page.value("R.Futures.instants().length"), 1, "what was marked stays");
    // A page that is opened behind the end of a run has its rows as well.
    page.tab();
    open(&mut page, &studio);
    page.value("location.hash = '#run'");
    page.until(&format!("{SHOWN} === {kept}"));
    assert_eq!(page.complaints, Vec::<String>::new());
}
