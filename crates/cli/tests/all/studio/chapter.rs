//! The tutorial about the studio, which is the chapter Operation of the manual: what its page has the reader do is done here, what it has
//! the reader see is looked for, and its pictures are taken (`UPDATE_PICTURES=1`).

use std::collections::BTreeSet;
use std::fs;
use std::time::Duration;

use super::{Page, Studio, shown};
use crate::support::pages::folder_of_project;
use crate::support::{program, root};

const MODEL: &str = "diagrams/irb2600/irb2600.ron";
/// All that can be read on the page, with names of fields and what buttons are for.
const WORDS: &str = "document.body.innerText + [...document.querySelectorAll('[aria-label], [title]')].map((one) => \
    `\n${one.getAttribute('aria-label') ?? ''}\n${one.title}`).join('') + [...document.querySelectorAll('option')].map((one) => `\n${one.textContent}`).join('')";

/// The reader, who has seen these words and these pictures so far.
struct Reader {
    page: Page,
    words: String,
    pictures: BTreeSet<String>,
}

impl Reader {
    /// Looks at the page; takes a picture for the tutorial if there is a name for it.
    fn look(&mut self, picture: &str) {
        self.page.drawn();
        let words = self.page.value(WORDS);
        self.words += words.as_str().expect("text");
        if picture.is_empty() {
            return;
        }
        let name = format!("studio-{picture}.webp");
        if std::env::var_os("UPDATE_PICTURES").is_some() {
            // Views in 3D are drawn coarsely until they stand still, and the page of a run is put together bit by bit.
            std::thread::sleep(Duration::from_secs(3));
            fs::write(root().join("docs/tutorials").join(&name), self.page.picture()).expect("a file");
        }
        self.pictures.insert(name);
    }

    /// Goes to a screen by its key.
    fn screen(&mut self, key: &str, name: &str) {
        self.page.value("document.activeElement.blur()");
        self.page.key(key);
        self.page.until(&format!("location.hash === '#{name}'"));
    }

    /// Types into fields.
    fn fill(&mut self, fields: &[(&str, &str)]) {
        for (name, value) in fields {
            self.page.value(&format!("document.querySelector('input[aria-label=\"{name}\"]').focus()"));
            self.page.replace(value);
        }
    }

    /// Runs the model to its end.
    fn run(&mut self) {
        self.page.value("document.activeElement.blur()");
        self.page.key("F5");
        self.page.until("location.hash === '#run' || R.Live.rows() >= 0");
        self.page.until("document.querySelector('.run-line').textContent.includes('s simulated in')");
    }
}

#[test]
fn the_tutorial_about_the_studio_can_be_followed() {
    let text = fs::read_to_string(root().join("docs/tutorials/studio.md")).expect("the tutorial");
    let folder = folder_of_project("studio");
    let mut command = program();
    command.args(["studio", MODEL, "--edit", "--no-open", "--port", "0"]);
    command.current_dir(&folder).env("BLOCKSIM_HOME", folder.join(".blocksim"));
    let studio = Studio::start(&mut command);
    let Some(page) = shown(&studio) else { return };
    let mut reader = Reader { page, words: String::new(), pictures: BTreeSet::new() };
    reader.page.size(1200, 780, 1);
    let model = || fs::read_to_string(folder.join(MODEL)).expect("the model");

    // Start: what is missing is built by the first run.
    reader.page.until("document.querySelector('#project-view .state.missing')");
    reader.look("");
    reader.run();
    reader.screen("1", "project");
    reader.page.until("document.querySelectorAll('#project-view .state.ready').length === 6");
    // Where the tests run is of no interest to readers.
    reader.page.value("setInterval(() => { const note = document.querySelector('#project-view .note'); if (note) note.textContent = '~/blocksim/diagrams/irb2600'; }, 20)");
    reader.look("project");

    // A joint move, with a mistake.
    reader.screen("4", "motion");
    reader.page.until("document.querySelectorAll('.axes tbody tr').length === 6 && window.__m.frames > 0");
    reader.fill(&[("A1 target", "60"), ("A2 target", "30"), ("A3 target", "80")]);
    reader
        .page
        .until("document.querySelectorAll('.axes .told')[2].textContent.includes('is above the limit 75')");
    reader.look("");
    reader.fill(&[("A3 target", "-20"), ("A4 target", "45"), ("A5 target", "60"), ("A6 target", "90")]);
    reader.page.until("R.Motion.found()?.passes");
    reader.look("joint");

    // A line of the tool, kept and used.
    reader.page.value("[...document.querySelectorAll('#motion input[type=radio]')].find((one) => one.value === 'linear').click()");
    reader.page.until("document.querySelector('input[aria-label=\"target x\"]')");
    reader.fill(&[("target x", "1200"), ("target y", "-300"), ("target z", "900")]);
    reader.page.until("R.Motion.typed().kind === 'linear' && R.Motion.found()?.passes");
    reader.look("line");
    reader.fill(&[("Name of the move", "weld")]);
    reader.page.value("[...document.querySelectorAll('.keep button')].find((one) => one.textContent === 'Use in the model').click()");
    reader.page.until("document.getElementById('status').textContent.includes('File(')");
    reader.look("");
    assert!(model().contains("\"move\": File(\"moves/weld.ron\")"), "{}", model());

    // The stop time follows the move.
    let duration = reader.page.value("R.Motion.found().duration").as_f64().expect("a duration");
    reader.page.until(&format!("Math.abs(R.Project.known().until - {duration} - 1) < 2e-3"));
    reader.screen("1", "project");
    reader.page.until("document.querySelector('#project-view').textContent.includes('moves/weld.ron')");

    // The control structure of a joint, and its drive.
    reader.screen("2", "diagram");
    reader.page.until("R.Diagram.has()");
    reader.page.value("R.Diagram.show('control/joint1', 'controller')");
    reader.page.until("document.querySelector('#diagram').textContent.includes('joint1')");
    reader.look("control");
    reader.page.value("(() => { const chip = document.querySelector('select[aria-label^=\"drive\"]'); chip.value = 'dc'; chip.dispatchEvent(new Event('change')); })()");
    reader.page.until("document.getElementById('status').textContent.includes('dc')");
    reader.look("");
    assert!(model().contains("default: \"dc\""), "{}", model());
    reader.page.value("document.activeElement.blur()");
    reader.page.key("t");
    reader.page.until("document.querySelector('textarea')?.value.includes('solver: RosW3')");
    reader.look("");
    reader.page.key("Escape");

    // Run, with scopes that fill.
    reader.page.value("R.Desk.ask('run', { speed: 0.2 }).then(() => null)");
    reader.screen("5", "run");
    reader.page.until("R.Live.rows() < 900");
    reader.page.until("R.Live.rows() > 900");
    reader.page.key(" ");
    reader.page.until("document.querySelector('.run-line').textContent.includes('paused')");
    reader.look("run");
    reader.page.key(" ");
    reader.page.until("document.querySelector('.run-line').textContent.includes('s simulated in')");
    reader.look("");

    // Results, and two runs side by side.
    reader.screen("6", "runs");
    reader.page.until("document.querySelectorAll('#runs-view tbody tr').length === 2");
    reader.look("");
    reader.page.value("document.querySelectorAll('#runs-view button')[0].click()");
    reader.page.until("document.querySelectorAll('#runs-view button')[1].textContent === 'Compare with it'");
    reader.look("");
    reader.page.value("document.querySelectorAll('#runs-view button')[1].click()");
    reader.page.until("location.hash.includes('~') && document.querySelector('iframe.run-page')");
    reader.page.value("location.hash = '#runs'");
    reader.page.until("document.querySelector('#runs-view tbody a')");
    reader.page.value("document.querySelector('#runs-view tbody a').click()");
    reader.page.until("document.querySelector('iframe.run-page')");
    reader.page.size(1200, 1100, 1);
    reader.look("results");
    reader.page.size(1200, 780, 1);

    // A parameter.
    reader.screen("3", "values");
    reader.page.until("document.querySelectorAll('#values-view tbody tr').length > 20");
    reader.page.value("[...document.querySelectorAll('#values button')].find((one) => one.textContent.startsWith('(7)')).click()");
    reader.page.until("document.querySelector('#values-view tbody').textContent.includes('motor')");
    reader.look("parameters");
    // That pictures are drawn without a graphics card, and taken, is no fault of the page.
    reader.page.complaints.retain(|complaint| !complaint.contains("\"source\":\"rendering\""));
    assert_eq!(reader.page.complaints, Vec::<String>::new());

    // What the tutorial shows is on the page.
    let bold: Vec<&str> = text.split("**").skip(1).step_by(2).collect();
    let unseen: Vec<&&str> = bold.iter().filter(|label| !reader.words.contains(**label)).collect();
    assert!(bold.len() > 10 && unseen.is_empty(), "the page does not show {unseen:?} of {}", bold.len());
    let pictures = text.split("](").skip(1).filter_map(|rest| rest.split(')').next());
    let named: BTreeSet<String> =
        pictures.filter(|name| name.ends_with(".webp")).map(str::to_owned).collect();
    assert_eq!(named, reader.pictures);
    for name in &named {
        assert!(root().join("docs/tutorials").join(name).is_file(), "{name} is missing: UPDATE_PICTURES=1");
    }
    drop(studio);
    fs::remove_dir_all(&folder).expect("to tidy up");
}
